"""P2's closed circuit in its reduced form: induction motor on an inverter, pump, motor, load machine."""

from excitation import mixed
from spec import Bridge, Circuit, Input, Node, Signal, nominal

SHAFT_1 = ["electricMotor.flange", "shaft_1.flange_a", "shaft_1.flange_b", "bearing_1.flange_a", "pump.flange"]
SHAFT_2 = ["hydraulicMotor.flange", "shaft_2.flange_a", "shaft_2.flange_b", "load.flange"]
HIGH = ["pump.port_a", "highSide.port", "hydraulicMotor.port_b"]


def circuit():
    return Circuit(
        name="closed_circuit",
        model="LoopDrive",
        text=nominal("LoopDrive"),
        step=0.02,
        samples=1200,
        inputs=[
            Input("f_ref", "Hz", mixed(20, 40, 3, slew=4)),
            Input("u_load", "V", mixed(0.8, 3.8, 2.5, slew=3)),
        ],
        signals=[
            Signal("n_p", "n_p", "rev/min", 1500), Signal("n_m", "n_m", "rev/min", 1500), Signal("p", "p", "Pa", 2e7),
            Signal("T_e", "T_e", "N.m", 300),
        ],
        parameters={
            "J_L": (2, 0.05), "p_low": (2e6, 0.03), "V_line": (1.5e-3, 0.08), "bearing_1.d": (0.02, 0.2),
            "shaft_1.J": (0.37, 0.03), "electricMotor.R_r": (0.40, 0.05), "load.a_0": (8, 0.1), "load.a_1": (20, 0.03),
            "load.B": (0.1, 0.15), "load.a_2": (0.03, 0.1),
        },
        nodes=[
            Node("pump shaft", "rotation", "shaft_1.flange_b", SHAFT_1, turns=True, inertia=0.37, through=120, rate=40, way=40, pressure="p",
                 parameters={"viscous_friction": ["bearing_1.d"], "extra_inertia": ["shaft_1.J"]}),
            Node("load shaft", "rotation", "shaft_2.flange_b", SHAFT_2, turns=True, inertia=2, through=120, rate=40, way=40, pressure="p",
                 parameters={"viscous_friction": ["load.B", "load.a_2"], "extra_inertia": ["J_L"],
                             "constant_force": ["load.a_0"], "dry_friction": ["load.a_0"]}),
            Node("high side", "hydraulic", "highSide.port", HIGH, through=1e-3, rate=2e7, way=8e6, middle=1e7, back="p_low",
                 parameters={"extra_compliance": ["V_line"]}),
        ],
        bridges=[
            Bridge("pump", "pump.port_a", "pump.port_b", HIGH, [], through=1e-3, way=8e6, speed="shaft_1.w", rate=80,
                   turn="shaft_1.phi"),
            Bridge("hydraulic motor", "hydraulicMotor.port_b", "hydraulicMotor.port_a", HIGH, [], through=1e-3, way=8e6,
                   speed="shaft_2.w", rate=80, turn="shaft_2.phi"),
        ],
        settle=2,
    )
