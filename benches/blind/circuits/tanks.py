"""Two coupled tanks: pump, two free levels joined by a pipe, outlets to a reservoir."""

from excitation import mixed
from spec import Bridge, Circuit, Input, Node, Signal, nominal

LEFT = ["feed.port", "left.port", "pipe.port_a", "outlet_1.port_a"]
RIGHT = ["right.port", "pipe.port_b", "outlet_2.port_a"]


def circuit():
    return Circuit(
        name="tanks",
        model="Tanks",
        text=nominal("Tanks"),
        step=2.0,
        samples=900,
        inputs=[Input("u", "V", mixed(1.0, 7.0, 150))],
        signals=[Signal("h_1", "h_1", "m", 1.0), Signal("h_2", "h_2", "m", 1.0)],
        parameters={
            "k_p": (3e-5, 0.04), "a_1": (1.2e-5, 0.05), "a_12": (4e-5, 0.06), "a_2": (3e-5, 0.05),
            "A_1": (1e-2, 0.01), "A_2": (1e-2, 0.01),
        },
        nodes=[
            Node("left", "hydraulic", "left.port", LEFT, through=1e-4, rate=100, way=5e3, middle=1.06e5, back="101325",
                 parameters={"external_leak": ["a_1"], "extra_compliance": ["A_1"]},
                 forms=["external_leak", "overflow", "outside"]),
            Node("right", "hydraulic", "right.port", RIGHT, through=1e-4, rate=100, way=4e3, middle=1.04e5, back="101325",
                 parameters={"external_leak": ["a_2"], "extra_compliance": ["A_2"]},
                 forms=["external_leak", "overflow", "outside"]),
        ],
        bridges=[
            Bridge("pipe", "pipe.port_a", "pipe.port_b", LEFT, RIGHT, through=1e-4, way=1.5e3,
                   parameters={"internal_leak": ["a_12"]}),
        ],
        settle=600,
    )
