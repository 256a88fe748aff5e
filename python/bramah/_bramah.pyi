"""The compiled core. The classes of `bramah` hold these; users meet only `State`."""

from collections.abc import Callable
from typing import Literal, TypeAlias, TypedDict, final

import numpy as np
import numpy.typing as npt

__version__: str

_Array: TypeAlias = npt.NDArray[np.float64]
_Value: TypeAlias = bool | float | str
_Values: TypeAlias = list[tuple[str, _Value]]
# name, unit, unit for people, description, kind, words of an enumeration
_Quantity: TypeAlias = tuple[str, str, str, str, str, list[str]]
# quantity, value, min, max, structural, root
_Parameter: TypeAlias = tuple[_Quantity, float, float | None, float | None, bool, bool]

class Plan(TypedDict):
    """How a run is to go: not a class of the core, a dict that it reads."""

    start: float | None
    stop: float | None
    interval: float | None
    tolerance: float | None
    event_rows: bool | None
    outputs: list[str]
    # name, times, values, held until the next sample
    inputs: list[tuple[str, list[float], list[float], bool]]

class _Linear(TypedDict):
    A: _Array
    B: _Array
    C: _Array
    D: _Array
    # name, unit, value at the point
    states: list[tuple[str, str, float]]
    inputs: list[tuple[str, str, float]]
    outputs: list[tuple[str, str, float]]
    # real and imaginary part
    poles: list[tuple[float, float]]
    time: float

@final
class State:
    """Where a run ended, to go on from."""

    def __new__(cls, names: list[str], bytes: bytes) -> State: ...
    def __getnewargs__(self) -> tuple[list[str], bytes]: ...

    @property
    def time(self) -> float:
        """Seconds."""

    def values(self) -> list[tuple[str, float]]:
        """The value of every variable, in its unit."""

@final
class Run:
    """A result."""

    @property
    def time(self) -> _Array: ...
    @property
    def end(self) -> Literal["reached", "terminated", "interrupted"]: ...
    @property
    def ending(self) -> str | None: ...
    @property
    def messages(self) -> str: ...
    @property
    def state(self) -> State: ...
    def signals(self) -> list[_Quantity]: ...
    def columns(self) -> list[_Array]: ...
    def statistics(self) -> dict[str, float]: ...
    def draw(self, variables: list[str], engineering: bool, format: str, title: str) -> str: ...
    def csv(self, units: bool) -> str: ...

@final
class Stepper:
    """A run that is taken from step to step."""

    @property
    def time(self) -> float: ...
    def step(self, seconds: float, inputs: list[tuple[str, float]]) -> None: ...
    def get(self, name: str) -> float: ...
    def state(self) -> State: ...
    def terminated(self) -> str | None: ...

@final
class Model:
    """A compiled model, with the values that were set."""

    def __new__(
        cls,
        text: str | None,
        source: str,
        model: str | None,
        libraries: list[str],
        overrides: list[tuple[str, str]],
    ) -> Model: ...
    @property
    def class_name(self) -> str: ...
    @property
    def messages(self) -> str: ...
    @property
    def experiment(self) -> tuple[float, float, float, float]: ...
    def recipe(self) -> tuple[str | None, str, str | None, list[str], list[tuple[str, str]]]: ...
    def parameters(self) -> list[_Parameter]: ...
    def inputs(self) -> list[_Quantity]: ...
    def variables(self) -> list[_Quantity]: ...
    def network(self) -> str: ...
    def with_values(self, values: _Values) -> Model: ...
    def run(
        self, values: _Values, plan: Plan, from_state: State | None, progress: Callable[[float], object] | None
    ) -> Run: ...
    def linearize(
        self, values: _Values, at: float | None, steady: bool, inputs: list[str], outputs: list[str]
    ) -> _Linear: ...
    def steady(self, values: _Values, at: float | None) -> list[tuple[str, float]]: ...
    def sensitivity(self, values: _Values, plan: Plan, parameters: list[str]) -> dict[str, object]: ...
    def stepper(self, values: _Values, from_state: State | None) -> Stepper: ...

def identify(
    files: list[tuple[str, str]], study: str, data: str | None, method: str, starts: int, seed: int
) -> tuple[str, str, str]: ...
def diagnose(
    files: list[tuple[str, str]],
    study: str,
    data: str | None,
    effect: str | None,
    budget: float | None,
    progress: Callable[[str], object] | None,
) -> tuple[str, str, str, str | None, str]: ...
