"""Answers of the command line for scripts: one JSON object, whose shape has a version."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

__all__ = ["SCHEMA_VERSION", "as_json"]

#: Raised where a name or a meaning of an answer changes; what is only added keeps it.
SCHEMA_VERSION = 1


def as_json(answer: Mapping[str, Any], told: str = "") -> str:
    """Return an answer as strict JSON, with null for what is no finite number.

    Examples
    --------
    >>> as_json({"time_step": math.inf, "modes": [1.5, math.nan]})
    '{"schema_version": 1, "time_step": null, "modes": [1.5, null]}'
    """
    whole = {"schema_version": SCHEMA_VERSION, **answer} | ({"beam": told} if told else {})
    return json.dumps(_finite(whole), allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
