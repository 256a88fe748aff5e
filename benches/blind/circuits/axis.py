"""The axis of the gap bench: speed-controlled pump, cylinder, spring load (GapAxis.Nominal, as it ships)."""

from math import pi

from excitation import level, mixed
from spec import Bridge, Circuit, Cut, Input, Loop, Node, Signal

SHAFT = ["drive.flange", "shaft.flange_a", "shaft.flange_b", "pump.flange", "shaftFriction.flange_a"]
ROD = ["chamber_1.flange", "chamber_2.flange", "load.flange_a", "load.flange_b", "cylinderFriction.flange_a", "spring.flange_a"]
NODE_1 = ["pump.port_a", "chamber_1.port", "leak_1.port_a", "relief_1.port_a", "check_1.port_b"]
NODE_2 = ["pump.port_b", "chamber_2.port", "leak_2.port_a", "relief_2.port_a", "check_2.port_b"]


def chamber(name, port, names, other):
    return Node(
        name, "hydraulic", port, names, through=5e-5, rate=5e7, way=1.5e6, middle=2.5e6, back="p0", position="x",
        parameters={"external_leak": ["Ce"], "extra_compliance": ["beta"]},
    )


def warm_oil(rng):
    """Oil that thins as it warms: every laminar leakage and the damping of shaft and cylinder follow."""
    k = rng.uniform(0.025, 0.045)
    # Walther-like: the fall slows down as the oil gets warmer
    thin = f"exp({k:.6g}*{{A}}*(T_oil - 40)*(1 - 0.006*(T_oil - 40)))"
    lines = [
        ("bridge", NODE_1[0], NODE_2[0], f"Cip*({thin} - 1)*{{dp}}"),
        ("bridge", NODE_1[0], "lowSide.port", f"Ce*({thin} - 1)*{{dp}}"),
        ("bridge", NODE_2[0], "lowSide.port", f"Ce*({thin} - 1)*{{dp}}"),
        ("rotation", SHAFT[2], None, f"dv*(1/({thin}) - 1)*{{v}}"),
        ("translation", ROD[3], None, f"b*(1/({thin}) - 1)*{{v}}"),
    ]
    return dict(
        name="warm oil", families=["viscosity_temperature"], lines=lines, nodes=[NODE_1, NODE_2, SHAFT, ROD],
        parameters=[], size=1.0, least=0.2, largest=1.6,
    )


def circuit():
    return Circuit(
        name="axis",
        model="GapAxis.Nominal",
        step=0.001,
        samples=4000,
        inputs=[
            Input("u", "rad/s", mixed(-60, 60, 0.4)),
            Input("T_oil", "degC", level(30, 50, 6), acts=False),
        ],
        signals=[
            Signal("w", "w", "rad/s", 100),
            Signal("i", "i", "A", 10),
            Signal("p1", "p1", "Pa", 5e6),
            Signal("p2", "p2", "Pa", 5e6),
            Signal("x", "x", "m", 0.05),
        ],
        parameters={
            "J": (0.004, 0.03), "Kt": (1.2, 0.02), "D": (10e-6 / (2 * pi), 0.01), "dv": (0.01, 0.2),
            "beta": (1.2e9, 0.1), "Cip": (1e-12, 0.2), "Ce": (2e-13, 0.2), "M": (120, 0.02), "b": (800, 0.2),
            "k": (1e5, 0.02), "p0": (1.5e6, 0.03),
            "A": "exact", "V1": "exact", "V2": "exact", "pset": "exact", "Grel": "exact", "Kchk": "exact",
            "tau_i": "exact", "Kp": "exact", "Ki": "exact", "imax": "exact",
        },
        nodes=[
            Node("shaft", "rotation", SHAFT[2], SHAFT, turns=True, inertia=0.004, through=3, rate=60, way=6,
                 pressure="p1 - p2", parameters={"viscous_friction": ["dv"], "extra_inertia": ["J"]}),
            Node("rod", "translation", ROD[3], ROD, inertia=120, through=2000, rate=0.08, way=0.03,
                 pressure="p1 + p2 - 2*p0", parameters={"viscous_friction": ["b"], "extra_inertia": ["M"]}),
            chamber("node 1", "chamber_1.port", NODE_1, 2),
            chamber("node 2", "chamber_2.port", NODE_2, 1),
        ],
        bridges=[
            Bridge("pump", "pump.port_a", "pump.port_b", NODE_1, NODE_2, through=8e-5, way=1.5e6, speed="w", rate=60,
                   turn="shaft.phi", position="x", span=0.03,
                   parameters={"internal_leak": ["Cip"], "speed_loss": ["D"], "flow_gain": ["D"]}),
        ],
        cuts=[
            Cut("load spring", "translation", "load.flange_b", "spring.flange_a", ROD + ["spring.flange_b"],
                through=2000, way=0.03, stiffness=2e7),
        ],
        loop=Loop("u", "x", "min(max(25000*(r - y), -220), 220)", mixed(-0.025, 0.025, 0.5, slew=0.2)),
        more=warm_oil,
        settle=0.5,
    )
