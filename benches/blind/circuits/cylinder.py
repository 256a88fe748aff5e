"""P1's servo pump with its cylinder in a position loop (Fig. 1), reference and load force recorded."""

from excitation import mixed
from spec import Bridge, Circuit, Cut, Input, Node, Signal, nominal

LOW = ["accumulator.port", "lowPressure.port", "relief_A.port_b", "relief_B.port_b", "check_A.port_a", "check_B.port_a"]
SIDE_A = ["pump.port_a", "cylinder.port_1", "highPressure_A.port", "relief_A.port_a", "check_A.port_b", "check_B.port_x"]
SIDE_B = ["pump.port_b", "cylinder.port_2", "highPressure_B.port", "relief_B.port_a", "check_B.port_b", "check_A.port_x"]
SHAFT = ["drive.flange", "rotor.flange_a", "rotor.flange_b", "pump.flange"]
ROD = ["cylinder.flange", "positionSensor.flange", "load.flange_a", "load.flange_b", "force.flange"]


def side(name, port, names):
    return Node(name, "hydraulic", port, names, through=2e-5, rate=2e7, way=3e6, middle=3e6, back="accumulator.p",
                low=(LOW[0], LOW), position="cylinder.s")


def circuit():
    return Circuit(
        name="cylinder",
        model="PumpAxis",
        text=nominal("PumpAxis"),
        step=0.004,
        samples=1500,
        inputs=[
            Input("r", "m", mixed(0.046, 0.062, 1.0, slew=4e-3), hold=False, acts=False),
            Input("F", "N", mixed(-2.2e4, 2.2e4, 1.2, slew=3e4), hold=False, acts=False),
        ],
        signals=[
            Signal("x", "x", "m", 0.02), Signal("N", "N", "rev/min", 3000), Signal("p_A", "p_A", "Pa", 1e7),
            Signal("p_B", "p_B", "Pa", 1e7), Signal("p_L", "p_L", "Pa", 1e6), Signal("T_e", "T_e", "N.m", 5),
        ],
        parameters={
            "m_load": (490, 0.03), "V_A": (1e-4, 0.05), "V_B": (1e-4, 0.05), "rotor.J": (1.8e-4, 0.05),
            "pump.b": (1e-4, 0.2), "pump.k_p": (0.06, 0.1), "pump.T_c": (0.05, 0.2), "pump.G": (1.8422541966426858e-14, 0.1),
            "pump.V": (0.8e-6, 0.005), "accumulator.p_pre": (3e5, 0.03), "cylinder.C_i": (1e-13, 0.2),
        },
        nodes=[
            Node("shaft", "rotation", "rotor.flange_b", SHAFT, turns=True, inertia=0.00018, through=1, rate=120, way=60, pressure="p_A - p_B",
                 parameters={"viscous_friction": ["pump.b"], "extra_inertia": ["rotor.J"], "dry_friction": ["pump.T_c"],
                             "pressure_friction": ["pump.k_p"]}),
            Node("rod", "translation", "load.flange_b", ROD, inertia=490, through=2e4, rate=6e-3, way=8e-3, middle=0.054,
                 pressure="p_A + p_B", parameters={"extra_inertia": ["m_load"]}),
            side("side A", "pump.port_a", SIDE_A),
            side("side B", "pump.port_b", SIDE_B),
        ],
        bridges=[
            Bridge("pump", "pump.port_a", "pump.port_b", SIDE_A, SIDE_B, through=2e-5, way=4e6, speed="pump.w", rate=120,
                   turn="rotor.phi", position="cylinder.s", middle=0.054, span=8e-3,
                   parameters={"internal_leak": ["pump.G", "cylinder.C_i"], "speed_loss": ["pump.V"]}),
        ],
        cuts=[
            Cut("rod", "translation", "cylinder.flange", "load.flange_a", ROD, through=2e4, way=8e-3, stiffness=3e8),
        ],
        settle=0.5,
    )
