"""P1's load rig (Fig. 10): the servo pump against a throttle."""

from excitation import mixed
from spec import Bridge, Circuit, Input, Node, Signal, nominal

LOW = ["accumulator.port", "leak.port_b", "relief.port_b", "throttle.port_b", "check_A.port_a", "check_B.port_a"]
SIDE_A = ["volume_A.port", "pump.port_a", "leak.port_a", "relief.port_a", "throttle.port_a", "check_A.port_b"]
SIDE_B = ["volume_B.port", "pump.port_b", "check_B.port_b"]
SHAFT = ["drive.flange", "rotor.flange_a", "rotor.flange_b", "bearing.flange_a", "pump.flange"]


def circuit():
    return Circuit(
        name="load_rig",
        model="LoadRig",
        text=nominal("LoadRig"),
        step=0.005,
        samples=1500,
        inputs=[
            Input("w_ref", "rad/s", mixed(40, 150, 0.8, slew=600)),
            Input("opening", "1", mixed(0.2, 0.7, 1.0, slew=2)),
        ],
        signals=[
            Signal("w", "w", "rad/s", 200), Signal("p_A", "p_A", "Pa", 2e7), Signal("Q_A", "Q_A", "m3/s", 3e-5),
            Signal("T_e", "T_e", "N.m", 5),
        ],
        parameters={
            "rotor.J": (1.8e-4, 0.05), "bearing.d": (4e-4, 0.2), "volume_A.V": (200e-6, 0.05), "pump.G": (1.8422541966426858e-14, 0.1),
            "pump.sigma": (3.178e-8, 0.1), "pump.Q_0": (1.383532901678657e-7, 0.1), "pump.T_c": (0.05, 0.2),
            "pump.k_p": (0.06, 0.1), "pump.V": (0.8e-6, 0.005), "throttle.A_max": (4e-7, 0.02), "G_A": (1e-14, 0.2),
        },
        nodes=[
            Node("shaft", "rotation", "rotor.flange_b", SHAFT, turns=True, inertia=0.00018, through=1, rate=50, way=50, pressure="p_A",
                 parameters={"viscous_friction": ["bearing.d"], "extra_inertia": ["rotor.J"], "dry_friction": ["pump.T_c"],
                             "pressure_friction": ["pump.k_p"], "constant_force": ["pump.T_c"]}),
            Node("side A", "hydraulic", "volume_A.port", SIDE_A, through=1.2e-5, rate=2e7, way=5e6, middle=6e6,
                 back="accumulator.p", low=(LOW[0], LOW), parameters={"extra_compliance": ["volume_A.V"], "external_leak": ["G_A"]}),
        ],
        bridges=[
            Bridge("pump", "pump.port_a", "pump.port_b", SIDE_A, SIDE_B, through=1.2e-5, way=5e6, speed="pump.w", rate=100,
                   turn="rotor.phi",
                   parameters={"internal_leak": ["pump.G"], "speed_loss": ["pump.V", "pump.sigma"]}),
        ],
        settle=0.5,
    )
