"""Modules that are imported when they are first used: annotations may name their types without their cost."""

from __future__ import annotations

from importlib import import_module
from typing import Any

__all__ = ["Deferred"]


class Deferred:
    """A module by its name, imported when something of it is asked for.

    Where a type is needed for annotations only, `import xarray` stands under `TYPE_CHECKING`, and
    `xarray = Deferred("xarray")` beside it, so that `typing.get_type_hints` can resolve them, too.

    Examples
    --------
    >>> Deferred("fractions").Fraction(1, 3)
    Fraction(1, 3)
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        if attribute.startswith("__"):
            # What doctest and inspect ask of any object.
            raise AttributeError(attribute)
        module = import_module(self._name)
        if not hasattr(module, attribute):
            # A module inside a package that nobody has imported yet.
            import_module(f"{self._name}.{attribute}")
        return getattr(module, attribute)
