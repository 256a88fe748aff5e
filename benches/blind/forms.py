"""True forms of what a plant has more than its nominal model: Modelica expressions of other shape than the library's.

A form is drawn with random shape at a place and gives the through variable there as an expression of what a probe
sees: `{v}` rate, `{x}` position, `{p}` pressure, `{dp}` pressure difference, `{z}` `{y}` own states, `{A}` the size.
Sizes are fractions of the usual through variable of the place, so `{A}` = 0.05 is a twentieth of it.
"""

from dataclasses import dataclass, field
from math import pi


@dataclass
class Form:
    """A drawn form: its acceptable families (none: in no library), expression, states and their equations."""

    name: str
    families: list
    flow: str
    states: list = field(default_factory=list)  # (name, start, nominal)
    equations: list = field(default_factory=list)
    size: tuple = (0.01, 0.4)
    share: str = ""  # family under which a nominal parameter means the same


def number(value):
    return f"({value:.8g})"


SIGN = "tanh({v}/%s)"
ARC = "2/3.14159265358979*atan({v}/%s)"


def order(rng, orders, speed, step):
    """A number of periods a turn that the sampling still resolves, or none."""
    seen = [n for n in orders if n * speed * step < 1.0]
    return rng.choice(seen) if seen else None


def mechanical(rng, place, step):
    """Forms for a shaft or rod."""
    F, V, X = number(place.through), place.rate, place.way
    v_c, v_s = V * 10 ** rng.uniform(-2.3, -1.5), V * 10 ** rng.uniform(-1.2, -0.3)
    a, b = rng.uniform(-0.2, 0.2), rng.uniform(0.2, 1.0)
    skew = f"(1 + {number(a)}*tanh({{v}}/{number(0.1 * V)}))"
    drop = f"(1 + {number(b)}/(1 + ({{v}}/{number(v_s)})^2))"
    arc = ARC % number(v_c)
    delta = X * 10 ** rng.uniform(-3.5, -2.5)
    mag = f"sqrt({{v}}^2 + {number((1e-5 * V) ** 2)})"
    bristle = Form(
        "lugre friction", ["dry_friction", "hysteresis"],
        f"{F}*{{A}}*({{z}} + {number(0.3 * delta / V)}*der({{z}})/(1 + ({{v}}/{number(v_c)})^2))",
        [("z", 0, 1)],
        [f"der({{z}}) = ({{v}} - {mag}*{{z}}/(1 + {number(b)}*exp(-({{v}}/{number(v_s)})^2)))/{number(delta)}"],
    )
    turn = X * 10 ** rng.uniform(-2, -1)
    wen = Form(
        "bouc-wen hysteresis", ["hysteresis", "dry_friction"], f"{F}*{{A}}*{{z}}", [("z", 0, 1)],
        [f"der({{z}}) = ({{v}} - 0.6*{mag}*{{z}}*sqrt({{z}}^2 + 1e-6) - 0.4*{{v}}*{{z}}^2)/{number(turn)}"],
    )
    forms = [
        bristle, bristle,
        Form("arctan friction", ["dry_friction"], f"{F}*{{A}}*{arc}*{skew}*{drop}"),
        Form("viscous friction", ["viscous_friction"],
             f"{F}*{{A}}*{{v}}/{number(V)}*{skew}/(1 + 0.2*({{v}}/{number(V)})^2)", share="viscous_friction"),
        Form("drag", ["quadratic_drag"], f"{F}*{{A}}*{{v}}/{number(V)}*({{v}}^2/{number(V * V)} + 1e-6)^0.4*{skew}"),
        Form("constant load", ["constant_force"], f"{F}*{{A}}*{rng.choice([-1, 1])}"),
        Form("further inertia", ["extra_inertia"], f"{number(5 * place.inertia)}*{{A}}*der({{v}})", size=(0.01, 0.3),
             share="extra_inertia"),
        wen,
    ]
    n, phase = order(rng, [1, 2, 3, 4, 6, 7, 9, 12], V, step), rng.uniform(0, 2 * pi)
    if place.domain == "rotation" and n:
        forms.append(Form("ripple with harmonic", ["torque_ripple"],
                          f"{F}*{{A}}*(sin({n}*{{x}} + {phase:.4f}) + 0.25*sin({2 * n}*{{x}} + 1))"))
    if place.pressure:
        load = f"abs({place.pressure})/{number(2e6)}"
        forms.append(Form("pressure friction", ["pressure_friction"], f"{F}*{{A}}*({load} + 1e-3)^0.85*{arc}"))
    return forms


def mechanical_outside(rng, place):
    """Forms for a shaft or rod that no library holds."""
    F, V, X, M = number(place.through), place.rate, place.way, place.middle
    v_c = V * 10 ** rng.uniform(-2, -1.3)
    arc = ARC % number(v_c)
    x_c, w = M + X * rng.uniform(-0.4, 0.4), X * rng.uniform(0.15, 0.35)
    omega = V / X * 10 ** rng.uniform(0.7, 1.5)
    fall, period = X / V * rng.uniform(1, 4), X / V * rng.uniform(0.3, 2)
    v_t = V * rng.uniform(0.3, 0.7)
    bump = f"exp(-(({{x}} - {number(x_c)})/{number(w)})^2)"
    if place.turns:
        bump = f"exp(4*(cos({{x}} - {number(x_c)}) - 1))"
    found = [
        Form("friction at one position", [], f"{F}*{{A}}*{arc}*{bump}"),
        Form("hidden resonance", [], f"{F}*{{A}}*({{x}} - {{z}} + {number(0.1 / omega)}*({{v}} - {{y}}))/{number(0.1 * X)}",
             [("z", "{x}", X), ("y", 0, V)],
             ["der({z}) = {y}", f"der({{y}}) = {number(omega**2)}*({{x}} - {{z}}) + {number(0.1 * omega)}*({{v}} - {{y}})"]),
        Form("friction above a speed", [], f"{F}*{{A}}*{arc}*0.5*(1 + tanh((abs({{v}}) - {number(v_t)})/{number(0.03 * V)}))"),
        Form("creep", [], f"{F}*{{A}}*({{x}} - {{z}})/{number(0.3 * X)}", [("z", "{x}", X)],
             [f"der({{z}}) = ({{x}} - {{z}})/{number(fall)}"]),
        Form("exogenous periodic load", [],
             f"{F}*{{A}}*sin({number(2 * pi / period)}*time + {rng.uniform(0, 6):.3f})"),
    ]
    # on a shaft that turns on, creep is no more than friction
    return [f for f in found if not (place.turns and f.name == "creep")]


def root(dp, rounding):
    return f"{dp}/(({dp})^2 + {number(rounding**2)})^0.25"


def hydraulic(rng, place):
    """Forms for a node with a volume."""
    Q, P = number(place.through), place.way
    b = 0.5 * rng.uniform(0.5, 1.5)
    limit = place.middle + P * rng.uniform(0.1, 0.7)
    n = rng.uniform(1.0, 1.4)
    capacity = place.through / place.rate
    return [
        Form("turbulent leak", ["external_leak"], f"{Q}*{{A}}*{root('{dp}', 0.02 * P)}/{number(P**0.5)}", share="external_leak"),
        Form("gap leak that grows", ["external_leak"], f"{Q}*{{A}}*{{dp}}/{number(P)}*(1 + {number(0.3 * b)}*{{dp}}/{number(P)})",
             share="external_leak"),
        Form("dissolving air", ["entrained_air"],
             f"{number(capacity)}*{{A}}*10*({number(0.5 * place.middle)}/max({{p}}, 2e4))^{number(1 / n + 1)}"
             f"/(1 + ({{p}}/{number(4 * place.middle)})^2)*der({{p}})"),
        Form("stiffening hose", ["extra_compliance"],
             f"{number(capacity)}*{{A}}*10/(1 + 0.3*{{p}}/{number(2 * place.middle)})*der({{p}})", share="extra_compliance"),
        Form("early valve", ["valve_early_opening"],
             f"{Q}*{{A}}*{{z}}", [("z", 0, 1)],
             [f"der({{z}}) = (5*(max(0, {{p}} - {number(limit)})/{number(P)})^1.5 - {{z}})/{number(3e-3 * place.way / place.rate)}"]),
        Form("weir", ["overflow"], f"{Q}*{{A}}*60*(max(0, {{p}} - {number(limit)})/{number(P)})^1.5"),
    ]


def hydraulic_outside(rng, place):
    """Forms for a node that no library holds."""
    Q, P, T = number(place.through), place.way, place.way / place.rate
    omega = 10 ** rng.uniform(0, 0.7) / T
    period = T * 10 ** rng.uniform(0.5, 1.5)
    high = place.middle + P * rng.uniform(0, 0.4)
    forms = [
        Form("side branch that resonates", [], f"{Q}*{{A}}*{{z}}", [("z", 0, 1), ("y", "{p}", P)],
             [f"der({{z}}) = {number(omega / P)}*({{p}} - {{y}}) - {number(0.2 * omega)}*{{z}}",
              f"der({{y}}) = {number(omega * P)}*{{z}}"]),
        Form("leak that latches", [], f"{Q}*{{A}}*{{z}}*{{dp}}/{number(P)}", [("z", 0, 1)],
             [f"der({{z}}) = (0.5*(1 + tanh(({{p}} - {number(high)} + {number(0.4 * P)}*{{z}})/{number(0.05 * P)})) - {{z}})/{number(T)}"]),
        Form("exogenous periodic flow", [], f"{Q}*{{A}}*sin({number(2 * pi / period)}*time + {rng.uniform(0, 6):.3f})"),
    ]
    return forms


def bridge(rng, place, step):
    """Forms for a component between two nodes, and for a pump also those of its shaft."""
    Q, P, a = number(place.through), place.way, rng.uniform(-0.2, 0.2)
    skew = f"(1 + {number(a)}*tanh({{dp}}/{number(0.2 * P)}))"
    forms = [
        Form("turbulent leak across", ["internal_leak"], f"{Q}*{{A}}*{root('{dp}', 0.02 * P)}/{number(P**0.5)}*{skew}", share="internal_leak"),
        Form("leak across, half turbulent", ["internal_leak"],
             f"{Q}*{{A}}*{{dp}}/{number(P)}/sqrt(1 + abs({{dp}})/{number(P)})*{skew}", share="internal_leak"),
    ]
    if place.speed:
        W, w = number(place.rate), place.speed
        forms += [
            Form("shear leak", ["speed_loss"], f"{Q}*{{A}}*({w})/{W}*(1 + 0.15*({w})/{W})", share="speed_loss"),
            Form("compression loss", ["compression_loss"], f"{Q}*{{A}}*sqrt(({w})^2 + 0.1)/{W}*{{dp}}/{number(P)}*(1 - 0.1*tanh({{dp}}/{number(P)}))"),
        ]
    n, angle = order(rng, [1, 5, 7, 9, 11], place.rate, step), place.turn
    if place.turn and n:
        forms.append(Form("flow ripple with harmonic", ["flow_ripple"],
                          f"{Q}*{{A}}*({place.speed})/{number(place.rate)}*(sin({n}*({angle})) + 0.3*sin({2 * n}*({angle}) + 1))*2"))
    return forms


def bridge_outside(rng, place):
    """Forms for a component between two nodes that no library holds."""
    Q, P = number(place.through), place.way
    d = P * rng.uniform(0.4, 0.9)
    forms = [Form("leak that opens with a jump", [], f"{Q}*{{A}}*{{dp}}/{number(P)}*0.5*(1 + tanh((abs({{dp}}) - {number(d)})/{number(0.02 * P)}))")]
    if place.position:
        c, w = place.middle + place.span * rng.uniform(-0.4, 0.4), place.span * rng.uniform(0.15, 0.35)
        forms.append(Form("leak at one position", [], f"{Q}*{{A}}*{{dp}}/{number(P)}*exp(-((({place.position}) - {number(c)})/{number(w)})^2)"))
    return forms


def cut(rng, place):
    """Forms inside a mechanical connection; `{A}` is a way as part of the usual one."""
    c, X = number(place.stiffness), number(place.way)
    d = number(place.stiffness * 10 ** rng.uniform(-3.3, -2.7))
    round_ = number(0.003)
    soft = lambda s: f"0.5*({s} + sqrt(({s})^2 + ({round_}*{{A}}*{X})^2))"
    play = f"({soft(f'{{x}} - 0.5*{{A}}*{X}')} - {soft(f'-{{x}} - 0.5*{{A}}*{X}')})"
    give = f"{number(place.through)}*{{x}}/({{A}}*{X})"
    forms = [
        Form("play with elastic stops", ["backlash"], f"{c}*{play} + {d}*{{v}}", size=(1e-3, 0.15)),
        Form("stiffening coupling", ["shaft_compliance"],
             f"{give}*(1 + 0.3*({{x}}/({{A}}*{X}))^2) + {d}*{{v}}", size=(1e-4, 0.1)),
    ]
    return [f for f in forms if f.families[0] in place.families]
