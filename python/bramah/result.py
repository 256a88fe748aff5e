"""Results of runs."""

from __future__ import annotations

import html
import os
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NoReturn, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _bramah, _given
from ._bramah import State

Array: TypeAlias = npt.NDArray[np.float64]


class Result(Mapping[str, Array]):
    """What a run recorded: a mapping from names to numpy arrays of shape (rows,), all over `time`.

    The arrays are those of the solver, not copies; values are in `units`. Booleans are 0 or 1, enumerations 1, 2, ...

    Can be pickled; what arrives on the other side has the values, but not `state`, `plot` and `to_csv`.
    """

    def __init__(self, run: _bramah.Run | _Kept, name: str) -> None:
        self._run, self.name = run, name
        self._signals = {s[0]: s for s in run.signals()}
        self._columns: dict[str, Array] = dict(zip(self._signals, run.columns()))

    @property
    def time(self) -> Array:
        """Seconds, shape (rows,). At an event two rows share a time: values before and after."""
        return self._run.time

    @property
    def units(self) -> dict[str, str]:
        """The unit of each column; "" where it has none."""
        return {name: s[1] for name, s in self._signals.items()}

    @property
    def display_units(self) -> dict[str, str]:
        """The unit for people of each column; "" where it is the unit."""
        return {name: s[2] for name, s in self._signals.items()}

    @property
    def descriptions(self) -> dict[str, str]:
        """What the model says of each column."""
        return {name: s[3] for name, s in self._signals.items()}

    @property
    def end(self) -> str:
        """"reached", "terminated" (the model ended the run: see `ending`) or "interrupted" (Ctrl-C)."""
        return self._run.end

    @property
    def ending(self) -> str | None:
        """The message of the model's `terminate`, or None."""
        return self._run.ending

    @property
    def messages(self) -> str:
        """Warnings of the run, or ""."""
        return self._run.messages

    @property
    def state(self) -> State:
        """Where the run ended: `model.simulate(from_state=result.state)` goes on from there."""
        return self._run.state

    @property
    def statistics(self) -> dict[str, float]:
        """The work done: steps, events, evaluations, states, unknowns, seconds."""
        return self._run.statistics()

    def __getitem__(self, name: str) -> Array:
        """The values of a variable over `time`, in its unit: an array of shape (rows,), the same one each time."""
        try:
            return self._columns[name]
        except (KeyError, TypeError):
            near = _given.nearest(name, self._columns)
            raise KeyError(f"the result has no {name!r}{near}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    # arrays have no single answer to ==: a result equals itself alone
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def at(self, time: float) -> dict[str, float]:
        """Values at a time in seconds, between rows by straight lines (Real) or held."""
        time = _given.number("the time", time)
        row = int(np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 1))

        def value(name: str, column: Array) -> float:
            if self._signals[name][4] == "Real":
                return float(np.interp(time, self.time, column))
            return float(column[row])

        return {name: value(name, column) for name, column in self._columns.items()}

    def to_pandas(self) -> Any:
        """A pandas frame with the time in seconds as its index; `frame.attrs["units"]` has the units."""
        import pandas

        frame = pandas.DataFrame(self._columns, index=pandas.Index(self.time, name="time"))
        frame.attrs["units"] = self.units
        return frame

    def to_polars(self) -> Any:
        """A polars frame with a column `time` in seconds."""
        import polars

        return polars.DataFrame({"time": self.time, **self._columns})

    def to_xarray(self) -> Any:
        """An xarray dataset over `time`; units and descriptions are attributes."""
        import xarray

        attributes = {n: {"units": s[1], "long_name": s[3]} for n, s in self._signals.items()}
        columns = {n: ("time", c, attributes[n]) for n, c in self._columns.items()}
        return xarray.Dataset(columns, coords={"time": ("time", self.time, {"units": "s"})})

    def to_csv(self, path: Any = None, *, units: bool = False) -> str | None:
        """CSV text, or a file where a path is given; with `units` its head reads `name [unit]`."""
        text = self._run.csv(units)
        if path is None:
            return text
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        return None

    def plot(self, variables: str | Iterable[str] | None = None, *, units: str = "engineering", title: str | None = None) -> Picture:
        """A picture with zoom and hover: panels by unit, without constants and doubles.

        Args:
            variables: names or patterns; a choice of bramah's where left out.
            units: "engineering" for bar, l/min, rev/min, mm, degC; "given" for those of the model alone (its display
                units, else its units).
            title: the name of the model where left out.
        """
        if units not in ("engineering", "given"):
            raise ValueError(f'units is "engineering" or "given", not {units!r}')
        title = self.name if title is None else title
        asked = (_given.names(variables), units == "engineering")
        return Picture(self._run.draw(*asked, "svg", title), self._run.draw(*asked, "html", title))

    def __repr__(self) -> str:
        rows = len(self.time)
        last = f"{self.time[-1]:g} s" if rows else "nothing"
        return f"<bramah.Result {self.name}: {len(self)} variables, {rows} rows, {self.end} {last}>"

    def __reduce__(self) -> tuple[Any, ...]:
        run = self._run
        kept = (run.signals(), run.time, run.columns(), run.end, run.ending, run.messages, run.statistics())
        return (_arrived, (kept, self.name))

    def _repr_html_(self) -> str | None:
        try:
            return self.plot()._repr_html_()
        except ValueError:  # nothing that moves
            return None


class _Kept:
    """What is kept of a run in another process."""

    def __init__(self, signals: Any, time: Array, columns: list[Array], *more: Any) -> None:
        self._signals, self.time, self._columns = signals, time, columns
        self.end, self.ending, self.messages, self._statistics = more

    def signals(self) -> Any:
        return self._signals

    def columns(self) -> list[Array]:
        return self._columns

    def statistics(self) -> dict[str, float]:
        return dict(self._statistics)

    @property
    def state(self) -> NoReturn:
        raise ValueError("a result that was pickled has no state to go on from: run the model here")

    def draw(self, *_: Any) -> NoReturn:
        raise ValueError("a result that was pickled draws no pictures: run the model here, or plot `to_pandas()`")

    def csv(self, *_: Any) -> NoReturn:
        raise ValueError("a result that was pickled writes no files: run the model here, or write `to_pandas()`")


def _arrived(kept: tuple[Any, ...], name: str) -> Result:
    """The other side of pickling."""
    return Result(_Kept(*kept), name)


class Picture:
    """A picture, made by `Result.plot`: `svg` and `html` are its texts; a notebook shows the one with zoom and hover."""

    def __init__(self, svg: str, page: str) -> None:
        self.svg, self.html = svg, page

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes .svg or .html."""
        path = os.fspath(path)
        if not path.endswith((".svg", ".html", ".htm")):
            raise ValueError(f"a picture is written as .svg or .html, not as {os.path.basename(path)!r}")
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.svg if path.endswith(".svg") else self.html)

    def __repr__(self) -> str:
        return f"<bramah.Picture: {len(self.svg) // 1000} kB of SVG>"

    def _repr_svg_(self) -> str:
        return self.svg

    def _repr_html_(self) -> str:
        return framed(self.html)


def framed(page: str, height: int = 640) -> str:
    """A complete page inside a notebook's cell."""
    return f'<iframe srcdoc="{html.escape(page)}" style="width:100%;height:{height}px;border:0" sandbox="allow-scripts"></iframe>'


def listed(named: Mapping[str, Any]) -> str | None:
    """A table of variables or values for a notebook; None for others, which show as their text."""
    rows = []
    for name, v in named.items():
        if isinstance(v, float):
            cells = [name, f"{v:g}"]
        elif hasattr(v, "unit"):
            cells = [name, f"{v.value:g}" if hasattr(v, "value") else "", v.unit, v.description]
        else:
            return None
        rows.append("<tr>" + "".join(f"<td style='text-align:left'>{html.escape(c)}</td>" for c in cells) + "</tr>")
    return "<table>" + "".join(rows) + "</table>"
