"""Simulate electro-hydraulic machines written in Modelica, and diagnose the gap between model and machine.

>>> import bramah as br
>>> model = br.load("ServoPump.DeadZone")          # or a file, a folder, Modelica text
>>> result = model.simulate(outputs=["N", "p_A"])
>>> result["p_A"][-1]                              # a numpy array, in result.units["p_A"]

- `load` compiles a `Model`; `Model.simulate`, `sweep`, `linearize`, `steady`, `sensitivity`, `stepper` run it.
- `identify` finds parameters from recordings, `gap` says what the model lacks; `Study` takes data frames.
- What is wrong is an `Error`, with code, place and help as on the command line.
"""

from ._bramah import State, __version__
from .errors import Error
from .model import Linear, Model, Parameter, Variable, load
from .result import Picture, Result
from .stepper import Stepper
from .study import Identified, Study, Verdict, gap, identify

__all__ = [
    "Error",
    "Identified",
    "Linear",
    "Model",
    "Parameter",
    "Picture",
    "Result",
    "State",
    "Stepper",
    "Study",
    "Variable",
    "Verdict",
    "__version__",
    "gap",
    "identify",
    "load",
]
