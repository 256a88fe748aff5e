"""What users hand in, checked and made plain."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np


def values(given: Mapping[str, Any] | None) -> list[tuple[str, bool | float | str]]:
    """Values of parameters: numbers in the parameter's unit, or texts with a unit."""
    return [(name, value(name, v)) for name, v in mapping("values", given).items()]


def mapping(what: str, given: Mapping[str, Any] | None) -> Mapping[str, Any]:
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise TypeError(f"{what} are a mapping from names, not a {type(given).__name__}")
    for name in given:
        if not isinstance(name, str):
            raise TypeError(f"{what} are named by texts, not by {name!r}")
    return given


def value(name: str, given: Any) -> bool | float | str:
    if isinstance(given, (bool, np.bool_)):
        return bool(given)
    if isinstance(given, (int, float, np.integer, np.floating)):
        return number(f"the value of {name!r}", given)
    if isinstance(given, str):
        return given
    if isinstance(given, np.ndarray) and given.ndim == 0:
        return value(name, given.item())
    if isinstance(given, (list, tuple, np.ndarray)):
        try:
            array = np.asarray(given)
        except ValueError:
            raise ValueError(f"the value of {name!r} has rows of unequal length") from None
        if array.dtype.kind not in "biuf":
            raise TypeError(f"the value of {name!r} is an array that does not hold numbers")
        if not np.isfinite(array).all():
            raise ValueError(f"the value of {name!r} has an element that is not finite")
        return literal(array)
    kind = type(given).__name__
    raise TypeError(f"the value of {name!r} is of type {kind}; give a number, a text such as '6 l/min', or an array")


def number(what: str, given: Any) -> float:
    """A finite number."""
    if isinstance(given, np.ndarray) and given.ndim == 0:
        given = given.item()
    if isinstance(given, (bool, np.bool_)):
        return float(given)
    if not isinstance(given, (int, float, np.integer, np.floating)):
        raise TypeError(f"{what} is of type {type(given).__name__}; a number is expected")
    if not math.isfinite(given):
        raise ValueError(f"{what} is {float(given):g}; a finite number is expected")
    return float(given)


def override(given: bool | float | str) -> str:
    """A value as the compiler reads it."""
    if isinstance(given, bool):
        return str(given).lower()
    if isinstance(given, float):
        return str(int(given)) if given.is_integer() and abs(given) < 1e15 else repr(given)
    return given


def literal(array: np.ndarray[Any, Any]) -> str:
    """An array as Modelica writes it."""
    cells = map(literal, array) if array.ndim > 1 else (override(v if isinstance(v, bool) else float(v)) for v in array.tolist())
    return "{" + ", ".join(cells) + "}"


def names(given: str | Iterable[str] | None) -> list[str]:
    if given is None:
        return []
    if isinstance(given, str):
        return [given]
    found: list[str] = list(given) if isinstance(given, Iterable) else [given]
    for name in found:
        if not isinstance(name, str):
            raise TypeError(f"a variable is named by a text, not a {type(name).__name__}")
    return found


def column(what: str, given: Any) -> list[float]:
    """A column of numbers from a list, an array or a series; spans of time become seconds, dates seconds since the first."""
    try:
        array = np.asarray(given)
        if array.dtype == object and hasattr(given, "to_numpy") and getattr(given.dtype, "tz", None) is not None:
            array = given.to_numpy(dtype="datetime64[ns]")
        if array.dtype.kind == "M":
            array = array - (array[0] if array.ndim == 1 and len(array) else 0)
        if array.dtype.kind == "m":
            array = array / np.timedelta64(1, "s")
        array = array.astype(float)
    except (TypeError, ValueError) as why:
        raise TypeError(f"{what} does not hold numbers: {why}") from None
    if array.ndim != 1:
        raise ValueError(f"{what} has the shape {array.shape}; one column is expected")
    found: list[float] = array.tolist()
    return found


def samples(name: str, times: Any, values: Any) -> tuple[list[float], list[float]]:
    """Times and values of an input: as many of both, finite, times that grow."""
    t, v = column(f"the times of {name!r}", times), column(f"the values of {name!r}", values)
    if len(t) != len(v):
        raise ValueError(f"the input {name!r} has {len(t)} times and {len(v)} values")
    if not t:
        raise ValueError(f"the input {name!r} has no samples")
    for what, all in (("time", t), ("value", v)):
        bad = [i for i, x in enumerate(all) if not math.isfinite(x)]
        if bad:
            raise ValueError(f"the input {name!r} has a {what} that is not finite: sample {bad[0]}, {len(bad)} of {len(all)}")
    late = next((i for i in range(1, len(t)) if t[i] <= t[i - 1]), None)
    if late is not None:
        raise ValueError(f"the times of the input {name!r} do not grow: {t[late]:g} s after {t[late - 1]:g} s (sample {late})")
    return t, v


def nearest(name: object, known: Iterable[str]) -> str:
    """`; did you mean 'x'?`, where something resembles the name."""
    found = difflib.get_close_matches(str(name), list(known), n=1)
    return f"; did you mean {found[0]!r}?" if found else ""


def frame_columns(frame: Any, needed: Iterable[str] = ()) -> dict[str, list[float]]:
    """Columns of numbers of a pandas or polars frame or of a mapping of arrays, the index of a pandas frame among them.

    Columns of other kinds are left out, unless they are needed.
    """
    raw: dict[str, Any] = {}
    if isinstance(frame, Mapping):
        raw = {str(n): v for n, v in frame.items()}
    elif not hasattr(frame, "columns"):
        raise TypeError(f"a recording is a data frame or a mapping of columns, not a {type(frame).__name__}")
    else:
        index = getattr(frame, "index", None)
        if index is not None:
            name = getattr(index, "name", None)
            if name is None and getattr(getattr(index, "dtype", None), "kind", "O") in "fmM":
                name = "time"
            if name is not None and str(name) not in frame.columns:
                raw[str(name)] = index
        for name in frame.columns:
            if str(name) in raw:
                raise ValueError(f"a recording has two columns {str(name)!r}")
            raw[str(name)] = frame[name]
    wanted, found = set(needed), {}
    for name, cells in raw.items():
        try:
            found[name] = column(f"the column {name!r}", cells)
        except TypeError:
            if name in wanted:
                raise
    lengths = {name: len(cells) for name, cells in found.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"the columns of a recording have unequal lengths: {lengths}")
    return found
