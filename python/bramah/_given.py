"""What users hand in, checked and made plain."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np


def values(given: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Values of parameters: numbers in the parameter's unit, or texts with a unit."""
    return [(name, value(name, v)) for name, v in given.items()]


def value(name: str, given: Any) -> bool | float | str:
    if isinstance(given, (bool, np.bool_)):
        return bool(given)
    if isinstance(given, (int, float, np.integer, np.floating)):
        if np.isnan(given):
            raise ValueError(f"the value of {name!r} is not a number")
        return float(given)
    if isinstance(given, str):
        return given
    if isinstance(given, np.ndarray) and given.ndim == 0:
        return value(name, given.item())
    if isinstance(given, (list, tuple, np.ndarray)):
        return literal(np.asarray(given, dtype=float))
    kind = type(given).__name__
    raise TypeError(f"the value of {name!r} is a {kind}; give a number, a text such as '6 l/min', or an array")


def literal(array: np.ndarray) -> str:
    """An array as Modelica writes it."""
    if array.ndim == 1:
        return "{" + ", ".join(repr(float(v)) for v in array) + "}"
    return "{" + ", ".join(literal(row) for row in array) + "}"


def names(given: str | Iterable[str] | None) -> list[str]:
    if given is None:
        return []
    return [given] if isinstance(given, str) else [str(n) for n in given]


def column(what: str, given: Any) -> list[float]:
    """A column of numbers from a list, an array or a series."""
    try:
        array = np.asarray(given, dtype=float)
    except (TypeError, ValueError) as why:
        raise TypeError(f"{what} does not hold numbers: {why}") from None
    if array.ndim != 1:
        raise ValueError(f"{what} has the shape {array.shape}; one column is expected")
    return array.tolist()


def nearest(name: str, known: Iterable[str]) -> str:
    """`; did you mean 'x'?`, where something resembles the name."""
    found = difflib.get_close_matches(name, list(known), n=1)
    return f"; did you mean {found[0]!r}?" if found else ""


def frame_columns(frame: Any) -> dict[str, list[float]]:
    """Columns of a pandas or polars frame, or of a mapping of arrays, the index of a pandas frame with a name among them."""
    if isinstance(frame, Mapping):
        return {str(n): column(f"the column {n!r}", v) for n, v in frame.items()}
    if not hasattr(frame, "columns"):
        raise TypeError(f"a recording is a data frame or a mapping of columns, not a {type(frame).__name__}")
    found: dict[str, list[float]] = {}
    index = getattr(frame, "index", None)
    if index is not None and getattr(index, "name", None):
        found[str(index.name)] = column(f"the index {index.name!r}", index)
    for name in frame.columns:
        found[str(name)] = column(f"the column {name!r}", frame[name])
    return found
