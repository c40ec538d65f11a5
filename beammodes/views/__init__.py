"""Data made visible: axes, text tables, films. Nothing here computes."""
