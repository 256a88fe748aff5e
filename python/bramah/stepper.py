"""Runs that are taken from step to step."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from . import _bramah
from ._bramah import State

if TYPE_CHECKING:
    from .model import Model


class Stepper:
    """A run under the control of the caller.

    >>> s = model.stepper()
    >>> while s.time < 10:
    ...     s.step(1e-3, u=controller(s["w"]))
    """

    def __init__(self, core: _bramah.Stepper, model: Model) -> None:
        self._core, self._model = core, model

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
            Error: there is no such input (E903), or the run cannot go on.
        """
        given = [(name, float(value)) for name, value in {**(inputs or {}), **more}.items()]
        self._core.step(float(seconds), given)
        return self

    def __getitem__(self, name: str) -> float:
        """The value of a variable where the run stands, in its unit."""
        return self._core.get(name)

    def observe(self, *names: str) -> dict[str, float]:
        """Values of several variables."""
        return {name: self[name] for name in names}

    def __repr__(self) -> str:
        return f"<bramah.Stepper {self._model.name} at {self.time:g} s>"

