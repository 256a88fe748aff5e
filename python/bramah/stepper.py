"""Runs that are taken from step to step."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NoReturn

from . import _bramah, _given
from ._bramah import State
from .errors import Error

if TYPE_CHECKING:
    from .model import Model


class Stepper:
    """A run under the control of the caller: made by `Model.stepper`.

    >>> s = model.stepper()
    >>> while s.time < 10:
    ...     s.step(1e-3, u=controller(s["w"]))
    """

    def __init__(self, begin: Callable[[], _bramah.Stepper], model: Model) -> None:
        self._begin, self._model = begin, model
        self._core = begin()

    def reset(self) -> Stepper:
        """Goes back to where the stepper began; inputs have their first values again."""
        self._core = self._begin()
        return self

    @property
    def time(self) -> float:
        """Seconds."""
        return self._core.time

    @property
    def terminated(self) -> str | None:
        """The message of the model's `terminate`, once it has ended the run; then nothing moves any more."""
        return self._core.terminated()

    @property
    def state(self) -> State:
        """Everything needed to go on from here, with `simulate` or `stepper(from_state=...)`."""
        return self._core.state()

    def step(self, seconds: float, inputs: Mapping[str, float] | None = None, /, **more: float) -> Stepper:
        """Sets inputs, in their unit, and goes on by so many seconds. Inputs keep their values until they are set again.

        Raises:
            Error: there is no such input (E023, E903), or the run cannot go on.
        """
        given = [(name, _given.number(f"the input {name!r}", v)) for name, v in {**(inputs or {}), **more}.items()]
        seconds = _given.number("the step", seconds)
        if seconds < 0:
            raise ValueError(f"a step of {seconds:g} s would go back in time")
        try:
            self._core.step(seconds, given)
        except Error as error:
            raise self._model._meant(error, [name for name, _ in given]) from None
        return self

    def __getitem__(self, name: str) -> float:
        """The value of a variable where the run stands, in its unit."""
        if not isinstance(name, str):
            raise TypeError(f"a variable is named by a text, not a {type(name).__name__}")
        try:
            return self._core.get(name)
        except Error as error:
            raise self._model._meant(error, [name]) from None

    def observe(self, *names: str) -> dict[str, float]:
        """Values of several variables, each in its unit."""
        return {name: self[name] for name in names}

    def __reduce__(self) -> NoReturn:
        raise TypeError("a stepper cannot be pickled: its model can, and makes another one on the other side")

    def __repr__(self) -> str:
        return f"<bramah.Stepper {self._model.name} at {self.time:g} s>"
