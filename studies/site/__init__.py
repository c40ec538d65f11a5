"""The documentation site: the pages, the figures and the docstrings, put together by Sphinx."""
