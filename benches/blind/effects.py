"""Draws what a plant has more than its nominal model, at a place of a circuit, with what a right answer is."""

from dataclasses import dataclass, field

import forms
import shake


@dataclass
class Effect:
    """An effect: right families and places (lists of ports, of which any counts), and how it enters the plant.

    `groups` of ports: an answer is right at a place that touches each group (one for a node, two for a bridge).
    """

    name: str
    families: list
    groups: list
    parameters: list = field(default_factory=list)  # nominal parameters that mean the same
    also: list = field(default_factory=list)  # (family, groups) that mean the same at other places
    size: float = 0.05
    least: float = 1e-4
    largest: float = 1.0
    probes: list = field(default_factory=list)  # (kind, port_a, port_b or None, form)
    cut: str = ""  # connection taken out
    back: str = "0"
    sensor: tuple = ()  # (signal, function)
    command: tuple = ()  # (input, function)
    drift: str = ""
    falling: bool = False  # a smaller size does more
    whole: bool = False  # has no size

    def outside(self):
        return not self.families


def shunt(node, form):
    families, parameters = list(form.families), []
    if form.share and node.parameters.get(form.share):
        parameters = node.parameters[form.share]
    probe, also = (node.domain, node.port, None, form), []
    if node.low and families == ["external_leak"]:
        port, names = node.low
        probe, also = ("bridge", node.port, port, form), [("internal_leak", [node.names, names])]
    return Effect(
        form.name, families, [node.names], parameters, also, probes=[probe], back=node.back,
        largest=0.3 if form.share == "extra_inertia" else 1.0,
    )


def across(bridge, form):
    parameters = bridge.parameters.get(form.share, []) if form.share else []
    families, groups = list(form.families), [g for g in (bridge.names_a, bridge.names_b) if g]
    if len(groups) == 1 and families == ["internal_leak"]:
        families.append("external_leak")
    return Effect(
        form.name, families, groups, parameters,
        probes=[("bridge", bridge.port_a, bridge.port_b, form)], largest=1.0,
    )


def series(cut, form):
    least, largest = form.size
    return Effect(
        form.name, list(form.families), [cut.names], probes=[(cut.domain + " cut", cut.port_a, cut.port_b, form)],
        cut=cut.as_written or f"connect({cut.port_a}, {cut.port_b})", size=(least * largest) ** 0.5, least=least,
        largest=largest,
    )


def sensor(rng, circuit):
    s = rng.choice(circuit.signals)
    kind = rng.choice(["offset", "gain", "delay", "lag", "drift", "saturation"])
    sizes = {
        "offset": (0.02, 1e-3, 0.3), "gain": (0.04, 2e-3, 0.4), "delay": (3, 0.3, 30), "lag": (4, 0.5, 60),
        "drift": (0.03, 1e-3, 0.4), "saturation": (0.8, 0.25, 0.98),
    }
    size, least, largest = sizes[kind]
    if kind in ("offset", "gain", "drift"):
        size *= rng.choice([-1, 1])
    return Effect(
        f"{kind} of sensor {s.name}", [f"sensor_{kind}"], [[s.name]], size=size, least=least, largest=largest,
        sensor=(s.name, getattr(shake, kind)), falling=kind == "saturation",
    )


def command(rng, circuit):
    acting = [i for i in circuit.inputs if i.acts]
    if not acting:
        return None
    i = rng.choice(acting)
    kind = rng.choice(["gain", "dead_zone", "saturation", "dead_time", "lag"])
    sizes = {
        "gain": (0.05, 3e-3, 0.4), "dead_zone": (0.03, 2e-3, 0.3), "saturation": (0.8, 0.3, 0.98),
        "dead_time": (3, 1, 30), "lag": (5, 2, 80),
    }
    size, least, largest = sizes[kind]
    return Effect(
        f"{kind} of command {i.name}", ["command_gain" if kind == "gain" else kind], [[i.name]], size=size, least=least,
        largest=largest, command=(i.name, getattr(shake, f"command_{kind}")), falling=kind == "saturation",
    )


def drift(rng, circuit):
    """A parameter far beyond its tolerance, and what means the same at its place."""
    name = rng.choice(sorted(circuit.known()))
    _, sigma = circuit.parameters[name]
    families, groups = ["parameter"], []
    for place in circuit.nodes + circuit.bridges:
        for family, names in place.parameters.items():
            if name in names:
                families.append(family)
                groups = [place.names] if hasattr(place, "names") else [g for g in (place.names_a, place.names_b) if g]
    size = 6 * sigma * rng.choice([-1, 1, 1])
    return Effect(f"drift of {name}", families, groups, [name], size=size, least=4 * sigma, largest=25 * sigma, drift=name)


def warm(rng, circuit):
    """What only this circuit has."""
    if circuit.more is None:
        return None
    extra = circuit.more(rng)
    probes = [(domain, a, b, forms.Form(extra["name"], extra["families"], flow)) for domain, a, b, flow in extra["lines"]]
    return Effect(extra["name"], extra["families"], [sum(extra["nodes"], [])], extra["parameters"], probes=probes,
                  size=extra["size"], least=extra["least"], largest=extra["largest"], cut=extra.get("cut", ""))


def allowed(node, choice, outside):
    if node.forms is None:
        return [f for f in choice if node.domain != "hydraulic" or f.families != ["overflow"]]
    wanted = node.forms
    return [f for f in choice if (f.families and f.families[0] in wanted) or (outside and "outside" in wanted)]


def known(rng, circuit):
    """One effect that a library may hold: first its kind, then place and form."""
    while True:
        kind = rng.choice(["node"] * 5 + ["bridge"] * 2 + ["cut"] + ["sensor"] * 2 + ["command", "drift"] + ["more"])
        found = None
        if kind == "node" and circuit.nodes:
            node = rng.choice(circuit.nodes)
            choice = forms.hydraulic(rng, node) if node.domain == "hydraulic" else forms.mechanical(rng, node, circuit.step)
            choice = allowed(node, choice, False)
            found = shunt(node, rng.choice(choice)) if choice else None
        elif kind == "bridge" and circuit.bridges:
            place = rng.choice(circuit.bridges)
            found = across(place, rng.choice(forms.bridge(rng, place, circuit.step)))
        elif kind == "cut" and circuit.cuts:
            place = rng.choice(circuit.cuts)
            found = series(place, rng.choice(forms.cut(rng, place)))
        elif kind == "sensor":
            found = sensor(rng, circuit)
        elif kind == "command":
            found = command(rng, circuit)
        elif kind == "drift":
            found = drift(rng, circuit)
        elif kind == "more":
            found = warm(rng, circuit)
        if found is not None:
            return found


def unknown(rng, circuit):
    """One effect that no library holds."""
    places = circuit.nodes + circuit.bridges
    while True:
        place = rng.choice(places)
        if place in circuit.bridges:
            return across(place, rng.choice(forms.bridge_outside(rng, place)))
        outside = forms.hydraulic_outside if place.domain == "hydraulic" else forms.mechanical_outside
        choice = allowed(place, outside(rng, place), True)
        if choice:
            return shunt(place, rng.choice(choice))


def draw(rng, circuit):
    """What a case has: nothing, one, two, or one outside the library."""
    what = rng.choices(["nothing", "one", "two", "outside"], [0.2, 0.45, 0.15, 0.2])[0]
    if what == "nothing":
        return []
    if what == "outside":
        return [unknown(rng, circuit)]
    if what == "one":
        return [known(rng, circuit)]
    while True:
        pair = [known(rng, circuit), known(rng, circuit)]
        if pair[0].families != pair[1].families and not any(e.cut and f.cut or e.command and f.command for e, f in [pair]):
            return pair
