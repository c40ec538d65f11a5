"""The project's figures and tables, one file each.

A file holds a record `Study`, and is found by that. `python -m studies [NAME ...]` writes each one's SVG, PNG
and CSV into `figures/`, and from all of them the page `figures/report.html`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from studies.study import Study

__all__ = ["PAGE", "SITE", "every_study"]

#: The name of the page that is made of all studies' files.
PAGE = "report"
#: The name of the documentation site, which is written when it is asked for by name.
SITE = "site"


@cache
def every_study() -> Mapping[str, Study]:
    """Return every study by its name, in the order of their files."""
    found: dict[str, Study] = {}
    for file in iter_modules(__path__):
        if file.ispkg or file.name == "__main__":
            continue
        for value in vars(import_module(f"{__name__}.{file.name}")).values():
            if isinstance(value, Study) and found.setdefault(value.name, value) is not value:
                raise ValueError(f"name must be that of one study, got {value.name!r} twice")
    return found
