"""P1's dead-zone rig (Fig. 8): a pump at very low speed builds pressure against a closed port."""

from excitation import mixed
from spec import Bridge, Circuit, Input, Node, Signal, nominal

LOW = ["accumulator.port", "check_A.port_a", "check_B.port_a"]
SIDE_A = ["pump.port_a", "volume_A.port", "gauge.port", "flowSensor.port_a", "check_A.port_b"]
SIDE_B = ["pump.port_b", "volume_B.port", "check_B.port_b"]


def circuit():
    return Circuit(
        name="dead_zone",
        model="DeadZoneRig",
        text=nominal("DeadZoneRig"),
        step=0.1,
        samples=1000,
        inputs=[Input("w_ref", "rad/s", mixed(0.3, 3.8, 9, slew=1.0))],
        signals=[
            Signal("p_A", "p_A", "Pa", 25e6), Signal("p_B", "p_B", "Pa", 5e6), Signal("T_sh", "T_sh", "N.m", 3),
        ],
        parameters={
            "V_A": (50e-6, 0.05), "pump.sigma": (3.178e-8, 0.1), "pump.G": (1.8422541966426858e-14, 0.1),
            "pump.Q_0": (1.383532901678657e-7, 0.1), "pump.T_c": (0.05, 0.2), "pump.k_p": (0.06, 0.1),
            "pump.V": (0.8e-6, 0.005),
        },
        nodes=[
            Node("side A", "hydraulic", "volume_A.port", SIDE_A, through=3e-7, rate=4e6, way=1e7, middle=1e7,
                 back="accumulator.p", low=(LOW[0], LOW), parameters={"extra_compliance": ["V_A"]}),
        ],
        bridges=[
            Bridge("pump", "pump.port_a", "pump.port_b", SIDE_A, SIDE_B, through=3e-7, way=1e7, speed="pump.w", rate=3,
                   turn="motor.phi", parameters={"internal_leak": ["pump.G"], "speed_loss": ["pump.sigma", "pump.V"]}),
        ],
        settle=10,
    )
