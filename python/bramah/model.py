"""Models: compiled once, run many times."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _bramah, _given
from ._bramah import State
from .result import Result, listed
from .stepper import Stepper


@dataclass(frozen=True)
class Variable:
    """A variable or input of a model.

    Attributes:
        name: full name, as in "pump.b.p".
        unit: of its values; "" where it has none.
        display_unit: the unit for people, or "".
        description: as the model says it, or "".
        kind: "Real", "Integer", "Boolean" or "enumeration".
        literals: the words of an enumeration; its values are 1, 2, ...
    """

    name: str
    unit: str
    display_unit: str
    description: str
    kind: str
    literals: tuple[str, ...] = ()


@dataclass(frozen=True)
class Parameter(Variable):
    """A parameter that may be given from outside.

    Attributes:
        value: in `unit`; Booleans are 0 or 1.
        min, max: limits in `unit`, or None.
        structural: a new value needs a new compilation (some milliseconds).
        root: no other parameter decides it.
    """

    value: float = 0.0
    min: float | None = None
    max: float | None = None
    structural: bool = False
    root: bool = True


class Named(dict):
    """A dict whose missing keys name the nearest one; in a notebook a table."""

    def __missing__(self, key: str) -> Any:
        raise KeyError(f"there is no {key!r}{_given.nearest(key, self)}")

    def _repr_html_(self) -> str:
        return listed(self.values())


def load(
    source: str | os.PathLike[str],
    model: str | None = None,
    *,
    libraries: Sequence[str | os.PathLike[str]] = (),
    set: Mapping[str, Any] | None = None,
) -> Model:
    """Compiles a model.

    Args:
        source: a .mo file, a folder that is a package, the name of a class that ships with bramah
            ("ServoPump.DeadZone"), or Modelica text.
        model: the class to use, where the source has several.
        libraries: folders with further packages.
        set: values of parameters, as in `Model.simulate`.

    Raises:
        Error: the model is wrong; the message says where and what to do.
    """
    text, where = None, os.fspath(source)
    if "\n" in where or ";" in where:
        text, where = where, ""
    overrides = [(n, v if isinstance(v, str) else _override(v)) for n, v in _given.values(set or {})]
    return Model(_bramah.Model(text, where, model, [os.fspath(folder) for folder in libraries], overrides))


def _override(value: bool | float) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


class Model:
    """A compiled model. Never changes: values given to a call count for that call; `with_values` makes another model.

    May be used from several threads at once: runs do not hold the interpreter's lock. Can be pickled: the other side
    compiles it again.
    """

    def __init__(self, core: _bramah.Model) -> None:
        self._core = core

    @property
    def name(self) -> str:
        """The full name of the class."""
        return self._core.class_name

    @property
    def messages(self) -> str:
        """Warnings and notes of the compilation, or ""."""
        return self._core.messages

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Parameters that may be given, by name, in the order of their declaration."""
        all = self._core.parameters()
        return Named((q[0], Parameter(*q[:5], tuple(q[5]), *rest)) for q, *rest in all)

    @property
    def inputs(self) -> dict[str, Variable]:
        """Inputs, by name: `simulate(inputs=...)` gives them values over time."""
        return Named((q[0], Variable(*q[:5], tuple(q[5]))) for q in self._core.inputs())

    @property
    def variables(self) -> dict[str, Variable]:
        """Variables that change during a run, by name."""
        return Named((q[0], Variable(*q[:5], tuple(q[5]))) for q in self._core.variables())

    @property
    def start_time(self) -> float:
        """Seconds, as the model's `experiment` annotation says."""
        return self._core.experiment[0]

    @property
    def stop_time(self) -> float:
        """Seconds, as the model's `experiment` annotation says."""
        return self._core.experiment[1]

    def with_values(self, values: Mapping[str, Any] | None = None, /, **more: Any) -> Model:
        """The same model with other values of its parameters.

        Values are numbers in the parameter's unit or texts with a unit ("6 l/min"); names with dots go into the mapping.
        """
        return Model(self._core.with_values(_given.values({**(values or {}), **more})))

    def simulate(
        self,
        stop: float | None = None,
        *,
        start: float | None = None,
        interval: float | None = None,
        tolerance: float | None = None,
        outputs: str | Iterable[str] | None = None,
        inputs: Mapping[str, Any] | None = None,
        set: Mapping[str, Any] | None = None,
        event_rows: bool | None = None,
        from_state: State | None = None,
        progress: bool | Callable[[float], None] = False,
        **values: Any,
    ) -> Result:
        """Runs the model.

        Args:
            stop, start: seconds; as the model says where left out.
            interval: seconds between rows (500 rows where left out and `stop` is given).
            tolerance: relative, 1e-6 where neither model nor call say another.
            outputs: names or patterns ("pump.*") of what is recorded; all variables that change where left out.
            inputs: for each input a number, a pair (times, values) that holds each value until the next, or a triple
                (times, values, "linear") joined by straight lines. Times in seconds, values in the input's unit.
            set, **values: values of parameters and constant inputs: numbers in their unit or texts with a unit:
                `simulate(set={"pump.V": "12 ml"})`, or `simulate(**{"pump.V": "12 ml"})`.
            event_rows: rows at events too (yes where left out).
            from_state: go on from here (`Result.state`) instead of the start.
            progress: True for a bar (tqdm), or a function that gets the time in seconds.

        Returns:
            The result. After Ctrl-C it holds what there is, and `result.end` is "interrupted".

        Raises:
            Error: a name, value or unit is wrong (E012, E023, E215), or the run did not reach its end.
        """
        plan = self._plan(stop, start, interval, tolerance, outputs, inputs, event_rows)
        given = _given.values({**(set or {}), **self._constants(inputs), **values})
        with _Bar(progress, self, stop) as show:
            return Result(self._core.run(given, plan, from_state, show), self.name)

    def sweep(
        self,
        grid: Mapping[str, Sequence[Any]] | Iterable[Mapping[str, Any]],
        stop: float | None = None,
        *,
        outputs: str | Iterable[str] | None = None,
        inputs: Mapping[str, Any] | None = None,
        interval: float | None = None,
        tolerance: float | None = None,
        reduce: Callable[[Result], Any] | None = None,
    ) -> Any:
        """Many runs, on all cores.

        Args:
            grid: for each parameter its values (all combinations are run), or a list of mappings, one for each run.
            reduce: makes of each result what is kept, such as `lambda r: r["p"].max()`; a dict becomes columns. Where
                left out, the column `result` holds the results.
            others: as in `simulate`.

        Returns:
            A pandas frame with a row for each run (a list of dicts without pandas). Runs that failed have their `Error`
            in the column `error`.
        """
        if isinstance(grid, Mapping):
            axes = [[(name, v) for v in values] for name, values in grid.items()]
            points = [dict(point) for point in itertools.product(*axes)]
        else:
            points = [dict(point) for point in grid]
        plan = self._plan(stop, None, interval, tolerance, outputs, inputs, None)
        fixed = self._constants(inputs)
        ran = self._core.sweep([_given.values({**fixed, **point}) for point in points], plan)
        rows = [self._row(point, run, reduce) for point, run in zip(points, ran)]
        try:
            import pandas
        except ImportError:
            return rows
        return pandas.DataFrame(rows)

    def _row(self, point: dict[str, Any], run: Any, reduce: Callable[[Result], Any] | None) -> dict[str, Any]:
        if isinstance(run, Exception):
            return {**point, "error": run}
        result = Result(run, self.name)
        if reduce is None:
            return {**point, "result": result}
        kept = reduce(result)
        return {**point, **(kept if isinstance(kept, Mapping) else {"value": kept})}

    def steady(self, at: float | None = None, *, set: Mapping[str, Any] | None = None, **values: Any) -> dict[str, float]:
        """Values of all variables at the steady state reached from a time of a run (its start where left out).

        Raises:
            Error: the search comes to no rest (E501).
        """
        return Named(self._core.steady(_given.values({**(set or {}), **values}), at))

    def linearize(
        self,
        at: float | None = None,
        *,
        steady: bool = False,
        inputs: str | Iterable[str] | None = None,
        outputs: str | Iterable[str] | None = None,
        set: Mapping[str, Any] | None = None,
        **values: Any,
    ) -> Linear:
        """The linear model x' = A x + B u, y = C x + D u around a point, in deviations from it.

        Args:
            at: time of a run in seconds (its start where left out).
            steady: the steady state reached from there instead.
            inputs: inputs or parameters; all inputs where left out.
            outputs: any variables; the model's outputs, or else its states, where left out.
        """
        found = self._core.linearize(
            _given.values({**(set or {}), **values}), at, steady, _given.names(inputs), _given.names(outputs)
        )
        points = {key: {name: value for name, _, value in found[key]} for key in ("states", "inputs", "outputs")}
        units = {name: unit for key in ("states", "inputs", "outputs") for name, unit, _ in found[key]}
        poles = np.array([complex(re, im) for re, im in found["poles"]])
        return Linear(found["A"], found["B"], found["C"], found["D"], poles=poles, units=units, time=found["time"], **points)

    def sensitivity(
        self,
        parameters: str | Iterable[str],
        stop: float | None = None,
        *,
        outputs: str | Iterable[str] | None = None,
        set: Mapping[str, Any] | None = None,
        **values: Any,
    ) -> dict[str, dict[str, np.ndarray]]:
        """How trajectories move with parameters.

        Returns:
            For each parameter the derivative of each output: an array over time, in the output's unit per the
            parameter's; and "time" in seconds.
        """
        plan = self._plan(stop, None, None, None, outputs, None, False)
        given = _given.values({**(set or {}), **values})
        return Named(self._core.sensitivity(given, plan, _given.names(parameters)))

    def stepper(self, *, set: Mapping[str, Any] | None = None, from_state: State | None = None, **values: Any) -> Stepper:
        """A run that is taken from step to step, with inputs set from outside: for controllers and training."""
        return Stepper(self._core.stepper(_given.values({**(set or {}), **values}), from_state), self)

    def network(self) -> str:
        """The network as a picture: SVG text."""
        return self._core.network()

    def _plan(self, stop, start, interval, tolerance, outputs, inputs, event_rows) -> dict[str, Any]:
        return {
            "start": None if start is None else float(start),
            "stop": None if stop is None else float(stop),
            "interval": None if interval is None else float(interval),
            "tolerance": None if tolerance is None else float(tolerance),
            "event_rows": event_rows,
            "outputs": _given.names(outputs),
            "inputs": self._trajectories(inputs),
        }

    def _constants(self, inputs: Mapping[str, Any] | None) -> dict[str, Any]:
        return {n: v for n, v in (inputs or {}).items() if not isinstance(v, (tuple, list))}

    def _trajectories(self, inputs: Mapping[str, Any] | None) -> list[tuple[str, list[float], list[float], bool]]:
        found = []
        for name, given in (inputs or {}).items():
            if not isinstance(given, (tuple, list)):
                continue
            if len(given) not in (2, 3) or (len(given) == 3 and given[2] not in ("hold", "linear")):
                raise ValueError(f'the input {name!r} takes (times, values) or (times, values, "linear" or "hold")')
            times, values = _given.column(f"the times of {name!r}", given[0]), _given.column(f"the values of {name!r}", given[1])
            found.append((name, times, values, len(given) == 2 or given[2] == "hold"))
        return found

    def __reduce__(self):
        return (_again, self._core.recipe())

    def __repr__(self) -> str:
        return f"<bramah.Model {self.name}: {len(self.parameters)} parameters, {len(self.inputs)} inputs>"

    def _repr_html_(self) -> str:
        return f"<div style='overflow-x:auto;background:#fff'>{self.network()}</div>"


def _again(text, source, model, libraries, overrides) -> Model:
    """The other side of pickling."""
    return Model(_bramah.Model(text, source, model, libraries, overrides))


@dataclass(frozen=True, eq=False)
class Linear:
    """A linear model in deviations from a point.

    Attributes:
        A, B, C, D: arrays of shape (states, states), (states, inputs), (outputs, states), (outputs, inputs).
        states, inputs, outputs: names with the values at the point, in the order of the matrices.
        poles: eigenvalues of A in 1/s.
        units: by name.
        time: of the point in seconds.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: dict[str, float]
    inputs: dict[str, float]
    outputs: dict[str, float]
    poles: np.ndarray
    units: dict[str, str]
    time: float

    def __repr__(self) -> str:
        return f"<bramah.Linear: {len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs>"


class _Bar:
    """A bar over simulated time, where one is asked for and tqdm is there."""

    def __init__(self, asked: bool | Callable[[float], None], model: Model, stop: float | None) -> None:
        self._show, self._bar = (asked if callable(asked) else None), None
        if asked is True:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            self._bar = tqdm(total=stop if stop is not None else model.stop_time, unit="s", leave=False)
            self._show = self._move

    def _move(self, time: float) -> None:
        self._bar.update(time - self._bar.n)

    def __enter__(self):
        return self._show

    def __exit__(self, *_: Any) -> None:
        if self._bar is not None:
            self._bar.close()
