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
    >>> hasattr(Deferred("fractions"), "Fractoin"), hasattr(Deferred("xml"), "sax")
    (False, True)
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
            whole = f"{self._name}.{attribute}"
            try:
                import_module(whole)
            except ModuleNotFoundError as error:
                if error.name != whole and error.name != self._name:
                    raise
                # So that `hasattr` has its answer.
                raise AttributeError(f"module {self._name!r} has no attribute {attribute!r}") from None
        return getattr(module, attribute)
