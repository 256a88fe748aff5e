"""Results of runs."""

from __future__ import annotations

import html
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from . import _bramah, _given
from ._bramah import State


class Result(Mapping):
    """What a run recorded: a mapping from names to numpy arrays, all over `time`.

    The arrays are those of the solver, not copies; values are in `units`.
    """

    def __init__(self, run: _bramah.Run, name: str) -> None:
        self._run, self.name = run, name
        self._signals = {s[0]: s for s in run.signals()}
        self._columns = dict(zip(self._signals, run.columns()))

    @property
    def time(self) -> np.ndarray:
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
        """The work done: steps, events, evaluations, seconds."""
        return self._run.statistics()

    def __getitem__(self, name: str) -> np.ndarray:
        try:
            return self._columns[name]
        except KeyError:
            near = _given.nearest(name, self._columns)
            raise KeyError(f"the result has no {name!r}{near}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def at(self, time: float) -> dict[str, float]:
        """Values at a time in seconds, between rows by straight lines (Real) or held."""
        row = int(np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 1))
        def value(name: str, column: np.ndarray) -> float:
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
        """CSV text, or a file; with `units` its head reads `name [unit]`."""
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
            units: "engineering" for bar, l/min, rev/min, mm, degC; "given" for those of the columns.
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

    def _repr_html_(self) -> str:
        return self.plot()._repr_html_()


class Picture:
    """A picture: `svg` and `html` are its texts; a notebook shows the one with zoom and hover."""

    def __init__(self, svg: str, page: str) -> None:
        self.svg, self.html = svg, page

    def save(self, path: str) -> None:
        """Writes .svg or .html."""
        text = self.html if str(path).endswith((".html", ".htm")) else self.svg
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def _repr_svg_(self) -> str:
        return self.svg

    def _repr_html_(self) -> str:
        return framed(self.html)


def framed(page: str, height: int = 640) -> str:
    """A complete page inside a notebook's cell."""
    return f'<iframe srcdoc="{html.escape(page)}" style="width:100%;height:{height}px;border:0" sandbox="allow-scripts"></iframe>'


def listed(variables: Iterable[Any]) -> str:
    """A table of variables or values for a notebook."""
    rows = []
    for v in variables:
        if not hasattr(v, "unit"):
            return ""
        value = f"{v.value:g}" if hasattr(v, "value") else ""
        cells = (v.name, value, v.unit, v.description)
        rows.append("<tr>" + "".join(f"<td style='text-align:left'>{html.escape(c)}</td>" for c in cells) + "</tr>")
    return "<table>" + "".join(rows) + "</table>"
