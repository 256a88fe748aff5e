"""What a circuit of the blind bench is: the nominal model, its study, and where something may be missing."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Optional


@dataclass
class Input:
    """A recorded command. `trajectory(rng, n, dt, role)` gives its samples; `acts`: effects of commands may sit on it."""

    name: str
    unit: str
    trajectory: Callable
    hold: bool = True
    acts: bool = True


@dataclass
class Signal:
    """A measured variable, its unit and the sensor's range."""

    name: str
    variable: str
    unit: str
    range: float


@dataclass
class Node:
    """A place of the network.

    `port` is what an element is connected to, `names` are ports by which a diagnosis may call the place. `through`,
    `rate` and `way` are usual sizes there: force, speed and position; torque, rad/s and rad; flow, Pa/s and Pa.
    `middle` is a usual position or pressure, `back` the pressure (an expression) to which a leakage flows.
    `parameters` lists by family the nominal parameters that mean the same as an effect here.
    """

    name: str
    domain: str  # "translation", "rotation", "hydraulic"
    port: str
    names: list
    through: float
    rate: float
    way: float
    middle: float = 0.0
    back: str = "1e5"
    inertia: float = 0.0  # usual mass or inertia there
    turns: bool = False  # a shaft that turns on and on
    low: tuple = ()  # port and names of the low side, where a leak flows into another node instead of away
    pressure: str = ""  # expression of the pressure that loads a friction here
    position: str = ""  # expression of a position on which a flow may depend
    parameters: dict = field(default_factory=dict)
    forms: Optional[list] = None  # only these families; None: all that fit


@dataclass
class Bridge:
    """Two hydraulic ports of one component. `speed` is an expression of the shaft's speed, `turn` of its angle.

    Where the second port lies at a constant pressure, `names_b` is empty: a leak across is then a leak to the outside.
    """

    name: str
    port_a: str
    port_b: str
    names_a: list
    names_b: list
    through: float
    way: float
    speed: str = ""
    rate: float = 1.0
    turn: str = ""
    position: str = ""
    middle: float = 0.0
    span: float = 1.0
    parameters: dict = field(default_factory=dict)


@dataclass
class Cut:
    """A connection between two mechanical ports that may have play or be elastic."""

    name: str
    domain: str
    port_a: str
    port_b: str
    names: list
    through: float
    way: float
    stiffness: float
    families: tuple = ("backlash", "shaft_compliance")
    as_written: str = ""  # the connection in the model's words, where it is not `connect(port_a, port_b)`


@dataclass
class Loop:
    """A controller outside the model: it makes the input `drives` from a reference and the measured `signal`."""

    drives: str
    signal: str
    law: str  # of r (reference) and y (measured), Modelica
    trajectory: Callable


@dataclass
class Circuit:
    """One of the bench's circuits."""

    name: str
    model: str  # class
    step: float
    samples: int
    inputs: list
    signals: list
    parameters: dict  # name: (value, sigma as part of it), or "exact"
    nodes: list
    bridges: list = field(default_factory=list)
    cuts: list = field(default_factory=list)
    loop: Optional[Loop] = None
    text: Optional[Callable] = None  # () -> text of the nominal model, None: it ships with bramah; "" : not there
    probes: str = ""  # Modelica of the probes, where the circuit has connectors of its own
    more: Optional[Callable] = None  # rng -> further effects that only this circuit has
    settle: float = 0.0  # longest time that passes before a recording begins

    def known(self):
        """Parameters that have a tolerance."""
        return {k: v for k, v in self.parameters.items() if v != "exact"}


def nominal(name):
    """Reads a nominal model that stands beside the generator."""
    return (Path(__file__).parent / "nominal" / f"{name}.mo").read_text


def study(circuit, files):
    """The study file of a circuit: what its user would write."""
    lines = ["version = 1"]
    if circuit.text:
        lines.append('model = "nominal.mo"')
    lines += [f'class = "{circuit.model}"', "", "[inputs]"]
    for i in circuit.inputs:
        hold = "true" if i.hold else "false"
        lines.append(f'{i.name} = {{ column = "{i.name}", unit = "{i.unit}", hold = {hold} }}')
    lines += ["", "[signals]"]
    for s in circuit.signals:
        lines.append(
            f'{s.name} = {{ variable = "{s.variable}", column = "{s.name}", unit = "{s.unit}", '
            f'full_scale = "{s.range:g} {s.unit}" }}'
        )
    for file in files:
        role = file.split("_")[0]
        lines += ["", "[[recordings]]", f'file = "{file}"', f'role = "{role}"', 'time = "time"']
    lines += ["", "[parameters]"]
    for name, known in circuit.parameters.items():
        what = '"exact"' if known == "exact" else f'{{ sigma = "{100 * known[1]:g} %" }}'
        lines.append(f'"{name}" = {what}')
    return "\n".join(lines) + "\n"
