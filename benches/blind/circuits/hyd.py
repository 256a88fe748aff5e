"""Hyd.Circuit with connectors of its own, where its file is; its valve follows a recorded command."""

from pathlib import Path

from excitation import mixed
from plant import PROBES
from spec import Bridge, Circuit, Input, Loop, Node, Signal

FILE = Path(__file__).resolve().parents[3] / ".." / "shared" / "bench" / "Hyd.mo"

SUPPLY = ["vol2.a", "check.b", "relief.a", "valve.P"]
PUMP = ["pump.d", "vol1.a", "check.a"]
SIDE_A = ["valve.A", "cyl.A"]
SIDE_B = ["valve.B", "cyl.B"]
ROD = ["cyl.rod", "mass.a"]

OWN_PROBES = (
    PROBES.replace("Interfaces.TranslationalFlange", "Hyd.Flange")
    .replace("Interfaces.HydraulicPort", "Hyd.Port")
    .replace("Interfaces.RealInput", "input Real")
)


def text():
    """The library as it is, but for the command of the valve."""
    source = FILE.read_text()
    begin = source.index("    u = if time")
    source = source[:begin] + source[source.index("\n", begin) + 1 :]
    driven = """
model HydDriven
  extends Hyd.Circuit;
  input Real u(start = 0);
equation
  valve.u = u;
end HydDriven;
"""
    return source + driven


def side(name, port, names):
    return Node(name, "hydraulic", port, names, through=1.5e-4, rate=5e7, way=3e6, middle=4e6, back="1e5")


def circuit():
    if not FILE.exists():
        return None
    return Circuit(
        name="hyd",
        model="HydDriven",
        text=text,
        probes=OWN_PROBES,
        step=0.002,
        samples=1500,
        inputs=[Input("u", "1", mixed(-0.45, 0.5, 0.15))],
        signals=[
            Signal("p_S", "vol2.a.p", "Pa", 2e7), Signal("p_A", "cyl.A.p", "Pa", 1.5e7), Signal("p_B", "cyl.B.p", "Pa", 1.5e7),
            Signal("x", "mass.a.s", "m", 0.5), Signal("x_v", "valve.x", "1", 1),
        ],
        parameters={
            "vol2.V": (0.5e-3, 0.05), "pump.D": (28e-6 / (2 * 3.141592653589793), 0.01), "pump.Gl": (2e-12, 0.2),
            "relief.pset": (150e5, 0.02), "relief.G": (2e-10, 0.1), "valve.Amax": (8e-6, 0.03), "valve.wn": (300, 0.05),
            "cyl.K0": (1.6e9, 0.08), "cyl.Vd": (5e-5, 0.1), "cyl.Gl": (1e-13, 0.2), "cyl.Fc": (150, 0.2),
            "cyl.Bv": (200, 0.2), "mass.m": (200, 0.03), "mass.F": (-5000, 0.02),
        },
        nodes=[
            Node("rod", "translation", "mass.a", ROD, inertia=200, through=4000, rate=0.15, way=0.15, middle=0.25,
                 pressure="cyl.pA + cyl.pB",
                 parameters={"viscous_friction": ["cyl.Bv"], "dry_friction": ["cyl.Fc"], "extra_inertia": ["mass.m"],
                             "constant_force": ["mass.F"]}),
            Node("supply", "hydraulic", "vol2.a", SUPPLY, through=3e-4, rate=5e7, way=6e6, middle=1.2e7, back="1e5",
                 parameters={"extra_compliance": ["vol2.V"], "valve_early_opening": ["relief.pset"]}),
            side("side A", "cyl.A", SIDE_A),
            side("side B", "cyl.B", SIDE_B),
        ],
        bridges=[
            Bridge("piston", "cyl.A", "cyl.B", SIDE_A, SIDE_B, through=1.5e-4, way=4e6, position="cyl.x", middle=0.25,
                   span=0.15, parameters={"internal_leak": ["cyl.Gl"]}),
        ],
        loop=Loop("u", "x", "min(max(8*(r - y), -0.9), 0.9)", mixed(0.08, 0.32, 0.5, slew=0.4)),
        settle=0.3,
    )
