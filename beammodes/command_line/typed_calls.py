"""Words with numbers as the user types them, such as "arc(angle=1.57)"; no text of them is evaluated."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from typing import Any

from beammodes.checks import choice, shown

__all__ = ["typed_call"]

_LONGEST = 200


def typed_call(
    flag: str, text: str, makers: Mapping[str, Callable[..., Any]], without: tuple[str, ...] = ()
) -> tuple[str, dict[str, float]]:
    """Return the word and the numbers of what was typed for a flag.

    Parameters
    ----------
    flag : str
    text : str
    makers : mapping from words to functions
        What takes the numbers, by their names.
    without : tuple of str
        Arguments of theirs that are given otherwise.

    Raises
    ------
    ValueError
        If the word or a number's name is unknown, or one is missing, given twice or none.

    Examples
    --------
    >>> from beammodes.problem.sections import SECTIONS
    >>> typed_call("--section", "rectangle(width=0.06, height=0.02)", SECTIONS)
    ('rectangle', {'width': 0.06, 'height': 0.02})
    """
    match = re.fullmatch(r"\s*([a-z_]+)\s*(?:\(([^()]*)\))?\s*", text[:_LONGEST].lower())
    word = choice(flag, match[1] if match else text, makers)
    parameters = inspect.signature(makers[word]).parameters.values()
    able = {
        each.name: each for each in parameters if each.name not in without and each.kind != each.VAR_KEYWORD
    }
    wanted = f"{flag} must be {word}({', '.join(f'{name}=...' for name in able)})"
    numbers: dict[str, float] = {}
    for part in (match[2] or "").split(",") if match and match[2] else []:
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals:
            raise ValueError(f"{wanted}, got {shown(text)}")
        choice(f"number of {word}", name, able)
        if name in numbers:
            raise ValueError(f"{name} of {flag} must be given once, got {shown(text)}")
        try:
            numbers[name] = float(value)
        except ValueError:
            raise ValueError(f"{name} of {flag} must be a number, got {shown(value)}") from None
    lost = [name for name, each in able.items() if each.default is each.empty and name not in numbers]
    if lost:
        raise ValueError(f"{wanted}, got {shown(text)} without {' and '.join(lost)}")
    return word, numbers
