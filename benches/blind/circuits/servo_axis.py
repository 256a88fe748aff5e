"""Electric positioning axis: DC motor under voltage, gear, elastic shaft, load, position loop in the model."""

from excitation import mixed
from forms import number
from spec import Circuit, Cut, Input, Node, Signal, nominal

MOTOR = ["motor.flange", "rotor.flange_a", "rotor.flange_b", "motorFriction.flange_a", "gear.flange_a"]
LOAD = ["shaft.flange_b", "load.flange_a", "load.flange_b", "loadFriction.flange_a"]
GEAR = ["gear.flange_b", "shaft.flange_a"]
SUPPLY = ["amplifier.p", "motor.p", "amplifier.n", "motor.n", "ground.p"]


def inverter(rng):
    """Voltage that the amplifier loses against the current."""
    i_s = rng.uniform(0.05, 0.6)
    drop = f"{{A}}*6*(2/3.14159265358979*atan({{x}}/{number(i_s)}) + 0.03*{{x}}/(1 + abs({{x}})/4))"
    return dict(
        name="inverter drop", families=["dead_zone"], lines=[("pin cut", "amplifier.p", "motor.p", drop)], nodes=[SUPPLY],
        parameters=[], size=0.2, least=5e-3, largest=1.5, cut="connect(amplifier.p, motor.p)",
    )


def circuit():
    return Circuit(
        name="servo_axis",
        model="ServoAxis",
        text=nominal("ServoAxis"),
        step=0.002,
        samples=1500,
        inputs=[Input("r", "rad", mixed(-1.5, 1.5, 0.5, slew=5), hold=False)],
        signals=[Signal("i", "i", "A", 20), Signal("w", "w", "rad/s", 60), Signal("phi", "phi", "rad", 2)],
        parameters={
            "R": (0.8, 0.05), "k": (0.25, 0.02), "J_m": (4e-4, 0.05), "J_L": (0.3, 0.03), "d_m": (1e-3, 0.2),
            "d_L": (1.0, 0.2), "c": (900, 0.05), "shaft.d": (2, 0.2),
            "control.k_x": "exact", "control.k_p": "exact", "control.k_i": "exact", "control.v_max": "exact",
        },
        nodes=[
            Node("motor", "rotation", "rotor.flange_b", MOTOR, inertia=0.0004, through=1, rate=30, way=12,
                 parameters={"viscous_friction": ["d_m"], "extra_inertia": ["J_m"]}),
            Node("load", "rotation", "load.flange_b", LOAD, inertia=0.3, through=8, rate=3, way=1.2,
                 parameters={"viscous_friction": ["d_L"], "extra_inertia": ["J_L"]}),
        ],
        cuts=[
            Cut("behind the gear", "rotation", "gear.flange_b", "shaft.flange_a", GEAR + LOAD, through=8, way=0.3,
                stiffness=1e5),
        ],
        more=inverter,
        settle=0.3,
    )
