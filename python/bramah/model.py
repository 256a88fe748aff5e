"""Models: compiled once, run many times."""

from __future__ import annotations

import itertools
import os
import threading
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from . import _bramah, _given
from ._bramah import State
from .errors import Error
from .result import Array, Result, listed
from .stepper import Stepper

T = TypeVar("T")


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


class Named(dict[str, T]):
    """A dict whose missing keys name the nearest one; in a notebook a table."""

    def __missing__(self, key: str) -> T:
        raise KeyError(f"there is no {key!r}{_given.nearest(key, self)}")

    def _repr_html_(self) -> str | None:
        return listed(self)


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
        libraries: folders that hold further packages.
        set: values of parameters, as in `Model.simulate`.

    Raises:
        Error: the model is wrong, or there is none; the message says where and what to do.
    """
    text, where = None, os.fspath(source)
    if "\n" in where or ";" in where:
        text, where = where, ""
    overrides = [(n, _given.override(v)) for n, v in _given.values(set)]
    folders = [libraries] if isinstance(libraries, (str, os.PathLike)) else libraries
    return Model(_bramah.Model(text, where, model, [os.fspath(folder) for folder in folders], overrides))


class Model:
    """A compiled model, made by `load`. Never changes: values given to a call count for that call; `with_values` makes
    another model.

    May be used from several threads at once: runs do not hold the interpreter's lock. Can be pickled: the other side
    compiles it again.
    """

    def __init__(self, core: _bramah.Model) -> None:
        self._core = core
        self._experiment = core.experiment

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
        return Named({q[0]: Parameter(*q[:5], tuple(q[5]), v, low, high, s, root) for q, v, low, high, s, root in all})

    @property
    def inputs(self) -> dict[str, Variable]:
        """Inputs, by name: `simulate(inputs=...)` gives them values over time."""
        return Named({q[0]: Variable(*q[:5], tuple(q[5])) for q in self._core.inputs()})

    @property
    def variables(self) -> dict[str, Variable]:
        """Variables that change during a run, by name."""
        return Named({q[0]: Variable(*q[:5], tuple(q[5])) for q in self._core.variables()})

    @property
    def start_time(self) -> float:
        """Seconds, as the model's `experiment` annotation says."""
        return self._experiment[0]

    @property
    def stop_time(self) -> float:
        """Seconds, as the model's `experiment` annotation says."""
        return self._experiment[1]

    def with_values(self, values: Mapping[str, Any] | None = None, /, **more: Any) -> Model:
        """The same model with other values of its parameters.

        Values are numbers in the parameter's unit or texts with a unit ("6 l/min"); names with dots go into the mapping.
        """
        given = self._given(values, more)
        return self._called(given, (), lambda: Model(self._core.with_values(given)))

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
            interval: seconds between rows; 500 intervals where it is left out and `stop` is given.
            tolerance: relative, 1e-6 where neither model nor call say another.
            outputs: names or patterns ("pump.*") of what is recorded; all variables that change where left out.
            inputs: for each input a number, a pair (times, values) that holds each value until the next, or a triple
                (times, values, "linear") joined by straight lines. Times in seconds, values in the input's unit.
            set, **values: values of parameters and constant inputs: numbers in their unit or texts with a unit:
                `simulate(set={"pump.V": "12 ml"})`, or `simulate(**{"pump.V": "12 ml"})`.
            event_rows: rows at events too, one before and one after each (yes where left out).
            from_state: go on from here (`Result.state`, `Stepper.state`) instead of the start.
            progress: True for a bar (tqdm), or a function that gets the time in seconds.

        Returns:
            The result: columns of shape (rows,). After Ctrl-C it holds what there is, and `result.end` is "interrupted".

        Raises:
            Error: a name, value or unit is wrong (E012, E023, E215), or the run did not reach its end.
            TypeError, ValueError: an argument is of the wrong kind or shape, or not finite.
        """
        plan = self._plan(stop, start, interval, tolerance, outputs, inputs, event_rows, from_state)
        given = self._given(set, self._constants(inputs), values)
        with _Bar(progress, plan["stop"] if stop is not None else self.stop_time) as show:
            run = self._called(given, plan["outputs"], lambda: self._core.run(given, plan, from_state, show), plan["inputs"])
        return Result(run, self.name)

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
        progress: bool | Callable[[int, int], None] = False,
    ) -> Any:
        """Many runs, on all cores.

        Args:
            grid: for each parameter its values (all combinations are run), or a list of mappings, one for each run.
            reduce: makes of each result what is kept, such as `lambda r: r["p"].max()`; a dict becomes columns. Where
                left out, the column `result` holds the results.
            progress: True for a bar (tqdm), or a function that gets how many runs are done, and how many there are.
            stop, outputs, inputs, interval, tolerance: as in `simulate`.

        Returns:
            A pandas frame with a row for each run (a list of dicts without pandas). Runs that failed have their `Error`
            in the column `error`. After Ctrl-C it has the runs that were done, and `frame.attrs["end"]` is
            "interrupted", else "reached".
        """
        points = _points(grid)
        plan = self._plan(stop, None, interval, tolerance, outputs, inputs, None, None)
        fixed = self._constants(inputs)
        given = [self._given(fixed, point) for point in points]
        halt = threading.Event()

        def look(_: float) -> None:
            if halt.is_set():
                raise _Halted

        def one(values: list[tuple[str, bool | float | str]]) -> Result | Error:
            try:
                run = self._called(values, plan["outputs"], lambda: self._core.run(values, plan, None, look), plan["inputs"])
            except Error as error:
                return error
            return Result(run, self.name)

        # threads of Python, not of the core: Ctrl-C is heard, and a process that was forked has none that are missing
        rows, end = [], "reached"
        with _Count(progress, len(points)) as show, ThreadPoolExecutor(max(1, min(_cores(), len(points)))) as pool:
            runs = [pool.submit(one, values) for values in given]
            try:
                for point, run in zip(points, runs):
                    rows.append(self._row(point, run.result(), reduce))
                    show(len(rows), len(points))
            except KeyboardInterrupt:
                end = "interrupted"
            finally:
                halt.set()
                pool.shutdown(cancel_futures=True)
        if end == "interrupted":
            rest = [(p, r) for p, r in zip(points[len(rows) :], runs[len(rows) :]) if r.done() and not r.cancelled()]
            rows += [self._row(p, r.result(), reduce) for p, r in rest if r.exception() is None]
            warnings.warn(f"the sweep was interrupted: {len(rows)} of {len(points)} runs are there", stacklevel=2)
        try:
            import pandas
        except ImportError:
            return rows
        frame = pandas.DataFrame(rows)
        frame.attrs["end"] = end
        return frame

    def _row(self, point: dict[str, Any], run: Result | Error, reduce: Callable[[Result], Any] | None) -> dict[str, Any]:
        if isinstance(run, Error):
            return {**point, "error": run}
        if reduce is None:
            return {**point, "result": run}
        kept = reduce(run)
        return {**point, **(kept if isinstance(kept, Mapping) and not isinstance(kept, Result) else {"value": kept})}

    def steady(self, at: float | None = None, *, set: Mapping[str, Any] | None = None, **values: Any) -> dict[str, float]:
        """Values of all variables, each in its unit, at the steady state reached from a time of a run.

        Args:
            at: time of the run in seconds; its start where left out.
            set, **values: values of parameters and inputs, as in `simulate`.

        Raises:
            Error: the search comes to no rest (E501).
        """
        given, at = self._given(set, values), self._time(at)
        return Named(self._called(given, (), lambda: self._core.steady(given, at)))

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
            set, **values: values of parameters and inputs, as in `simulate`.
        """
        given, at, us, ys = self._given(set, values), self._time(at), _given.names(inputs), _given.names(outputs)
        found = self._called(given, us + ys, lambda: self._core.linearize(given, at, steady, us, ys))
        points = {key: {name: value for name, _, value in found[key]} for key in ("states", "inputs", "outputs")}
        units = {name: unit for key in ("states", "inputs", "outputs") for name, unit, _ in found[key]}
        # of two that are conjugate the core names one
        poles = np.array([complex(re, s * im) for re, im in found["poles"] for s in ((1, -1) if im else (1,))])
        return Linear(found["A"], found["B"], found["C"], found["D"], poles=poles, units=units, time=found["time"], **points)

    def sensitivity(
        self,
        parameters: str | Iterable[str],
        stop: float | None = None,
        *,
        outputs: str | Iterable[str] | None = None,
        set: Mapping[str, Any] | None = None,
        **values: Any,
    ) -> dict[str, Any]:
        """How trajectories move with parameters.

        Args:
            parameters: their names; Real parameters that need no new compilation.
            stop, outputs, set, **values: as in `simulate`.

        Returns:
            For each parameter the derivative of each output: an array of shape (rows,) over time, in the output's unit
            per the parameter's; and "time", the times of the rows in seconds.
        """
        plan = self._plan(stop, None, None, None, outputs, None, False, None)
        given, asked = self._given(set, values), _given.names(parameters)
        names = [*plan["outputs"], *asked]
        return Named(self._called(given, names, lambda: self._core.sensitivity(given, plan, asked)))

    def stepper(self, *, set: Mapping[str, Any] | None = None, from_state: State | None = None, **values: Any) -> Stepper:
        """A run that is taken from step to step, with inputs set from outside: for controllers and training.

        Args:
            set, **values: values of parameters and first values of inputs, as in `simulate`.
            from_state: go on from here (`Result.state`, `Stepper.state`) instead of the start.
        """
        given = self._given(set, values)
        return self._called(given, (), lambda: Stepper(lambda: self._core.stepper(given, from_state), self))

    def network(self) -> str:
        """The network as a picture: SVG text."""
        return self._core.network()

    def _given(self, *given: Mapping[str, Any] | None) -> list[tuple[str, bool | float | str]]:
        """Values of parameters; of two for the same the later counts."""
        if len(given) == 1:
            return _given.values(given[0])
        return _given.values({name: v for some in given for name, v in _given.mapping("values", some).items()})

    def _called(
        self,
        given: Iterable[tuple[str, Any]],
        names: Iterable[str],
        call: Callable[[], T],
        inputs: Iterable[tuple[str, Any, Any, bool]] = (),
    ) -> T:
        """What a call gives; its error names what may have been meant."""
        try:
            return call()
        except Error as error:
            raise self._meant(error, [*(g[0] for g in given), *(i[0] for i in inputs), *names]) from None

    def _meant(self, error: Error, names: Iterable[str]) -> Error:
        if "did you mean" in str(error):
            return error
        free, variables = {*self.parameters, *self.inputs}, self.variables
        for name in names:
            said = f"`{name}`" in str(error) or f"`{name.rpartition('.')[2]}`" in str(error)
            if error.code in ("E012", "E023", "E901", "E903") and said and name not in {*free, *variables}:
                near = _given.nearest(name, [*free, *variables])
                return error.meant(near[2:].replace("'", "`")) if near else error
            if error.code == "E201" and name in variables and name not in free:
                return error.meant(f"`{name}` was given a value, and equations decide it: give parameters and inputs only")
        return error

    def _time(self, at: float | None) -> float | None:
        return None if at is None else _given.number("the time", at)

    def _plan(
        self,
        stop: float | None,
        start: float | None,
        interval: float | None,
        tolerance: float | None,
        outputs: str | Iterable[str] | None,
        inputs: Mapping[str, Any] | None,
        event_rows: bool | None,
        from_state: State | None,
    ) -> _bramah.Plan:
        start = None if start is None else _given.number("the start", start)
        stop = None if stop is None else _given.number("the stop", stop)
        interval = None if interval is None else _given.number("the interval", interval)
        tolerance = None if tolerance is None else _given.number("the tolerance", tolerance)
        if interval is not None and interval <= 0:
            raise ValueError(f"the interval is {interval:g} s; it must be greater than 0")
        if tolerance is not None and not 0 < tolerance < 1:
            raise ValueError(f"the tolerance is {tolerance:g}; it must lie between 0 and 1")
        if from_state is not None and not isinstance(from_state, State):
            raise TypeError(f"from_state is of type {type(from_state).__name__}; give `Result.state` or `Stepper.state`")
        if from_state is not None:
            begin = from_state.time
        else:
            begin = self.start_time if start is None else start
        end = self.stop_time if stop is None else stop
        if end < begin or (stop is None and end == begin and from_state is not None):
            raise ValueError(f"the run would begin at {begin:g} s and stop at {end:g} s: give a later stop")
        if from_state is not None and stop is not None and interval is None and end > begin:
            interval = (end - begin) / 500
        return {
            "start": start,
            "stop": stop,
            "interval": interval,
            "tolerance": tolerance,
            "event_rows": event_rows,
            "outputs": _given.names(outputs),
            "inputs": self._trajectories(inputs),
        }

    def _constants(self, inputs: Mapping[str, Any] | None) -> dict[str, Any]:
        return {n: v for n, v in _given.mapping("inputs", inputs).items() if not isinstance(v, (tuple, list))}

    def _trajectories(self, inputs: Mapping[str, Any] | None) -> list[tuple[str, list[float], list[float], bool]]:
        found = []
        for name, given in _given.mapping("inputs", inputs).items():
            if isinstance(given, np.ndarray) and given.ndim > 0 or callable(given):
                raise TypeError(f"the input {name!r} takes a number, or (times, values)")
            if not isinstance(given, (tuple, list)):
                continue
            if len(given) not in (2, 3) or (len(given) == 3 and given[2] not in ("hold", "linear")):
                raise ValueError(f'the input {name!r} takes (times, values) or (times, values, "linear" or "hold")')
            found.append((name, *_given.samples(name, given[0], given[1]), len(given) == 2 or given[2] == "hold"))
        return found

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, self._core.recipe())

    def __repr__(self) -> str:
        return f"<bramah.Model {self.name}: {len(self.parameters)} parameters, {len(self.inputs)} inputs>"

    def _repr_html_(self) -> str:
        return f"<div style='overflow-x:auto;background:#fff'>{self.network()}</div>"


def _again(
    text: str | None, source: str, model: str | None, libraries: list[str], overrides: list[tuple[str, str]]
) -> Model:
    """The other side of pickling."""
    return Model(_bramah.Model(text, source, model, libraries, overrides))


class _Halted(Exception):
    """A run of a sweep that was interrupted."""


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _points(grid: Mapping[str, Sequence[Any]] | Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    if not isinstance(grid, Mapping):
        return [dict(_given.mapping("the points of a grid", point)) for point in grid]
    axes = []
    for name, values in _given.mapping("grids", grid).items():
        one = isinstance(values, (str, bool, int, float)) or np.ndim(values) == 0
        axes.append([(name, v) for v in ([values] if one else values)])
    return [dict(point) for point in itertools.product(*axes)]


@dataclass(frozen=True, eq=False)
class Linear:
    """A linear model in deviations from a point.

    Attributes:
        A, B, C, D: arrays of shape (states, states), (states, inputs), (outputs, states), (outputs, inputs).
        states, inputs, outputs: names with the values at the point, in the order of the matrices.
        poles: eigenvalues of A in 1/s, shape (states,).
        units: by name.
        time: of the point in seconds.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: dict[str, float]
    inputs: dict[str, float]
    outputs: dict[str, float]
    poles: npt.NDArray[np.complex128]
    units: dict[str, str]
    time: float

    def __repr__(self) -> str:
        return f"<bramah.Linear: {len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs>"


def _tqdm(total: float, unit: str) -> Any:
    """A bar, where tqdm is there."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        warnings.warn('progress bars need tqdm: pip install "bramah[progress]"', stacklevel=4)
        return None
    return tqdm(total=total, unit=unit, leave=False)


class _Bar:
    """A bar over simulated time, or the function that was given instead."""

    def __init__(self, asked: bool | Callable[[float], None], stop: float | None) -> None:
        if not callable(asked) and not isinstance(asked, bool):
            raise TypeError(f"progress is True, False or a function, not of type {type(asked).__name__}")
        self._show: Callable[[float], None] | None = asked if callable(asked) else None
        self._bar: Any = _tqdm(stop or 0.0, "s") if asked is True else None
        if self._bar is not None:
            self._show = self._move

    def _move(self, time: float) -> None:
        self._bar.update(time - self._bar.n)

    def __enter__(self) -> Callable[[float], None] | None:
        return self._show

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()


class _Count:
    """The same over a number of runs."""

    def __init__(self, asked: bool | Callable[[int, int], None], total: int) -> None:
        if not callable(asked) and not isinstance(asked, bool):
            raise TypeError(f"progress is True, False or a function, not of type {type(asked).__name__}")
        self._asked = asked if callable(asked) else None
        self._bar = _tqdm(total, "run") if asked is True else None

    def _move(self, done: int, total: int) -> None:
        if self._asked is not None:
            self._asked(done, total)
        if self._bar is not None:
            self._bar.update(done - self._bar.n)

    def __enter__(self) -> Callable[[int, int], None]:
        return self._move

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
