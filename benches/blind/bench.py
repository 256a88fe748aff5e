"""Runs the plant of a case: recordings, how visible its effects are, how much of the gap the true model closes."""

import math
import os

import shake
from case import FILES
from plant import Plant, simulate


class Bench:
    """Runs plants of one case, with any of its effects."""

    def __init__(self, binary, folder, case):
        self.binary, self.folder, self.case = binary, folder, case
        self.reached = {}  # by effect: the largest value of the first run, one limit for all recordings

    def run(self, name, chosen, quiet=False):
        """Noise-free signals of a recording with the effects numbered in `chosen`; makes its commands anew."""
        case, circuit, r = self.case, self.case.circuit, self.case.recordings[name]
        effects = [case.effects[k] for k in chosen]
        with open(os.path.join(self.folder, "plant.mo"), "w") as out:
            out.write(Plant(circuit, effects).text())
        sets = self.sets(chosen)
        shaken = {d: [0.0] * r.n if quiet else v for d, v in r.disturbances.items()}
        if case.closed and not quiet:
            r.commands[circuit.loop.drives] = self.drive(r, sets, shaken)
        table = {**self.acting(r, chosen), **shaken}
        fine = max(map(len, table.values())) // r.n
        linear = [i.name for i in circuit.inputs if not i.hold] + list(shaken)
        table = {c: v if len(v) == fine * r.n else shake.finer(v, c not in linear) for c, v in table.items()}
        variables = [s.variable for s in circuit.signals]
        found = simulate(self.binary, self.folder, "BlindPlant", table, circuit.step, variables, sets, linear,
                         case.tolerance, fine)
        signals = {s.name: found[s.variable] for s in circuit.signals}
        return {s: self.sensed(s, v, chosen) for s, v in signals.items()}

    def sets(self, chosen):
        """Parameters of the plant with sizes of effects, in the order of `chosen`."""
        case, sets = self.case, dict(self.case.parameters)
        for k, j in enumerate(chosen):
            effect, size = case.effects[j], case.sizes[j]
            if effect.probes:
                sets[f"size_{k}"] = size
            if effect.drift:
                sets[effect.drift] = case.circuit.parameters[effect.drift][0] * math.exp(size)
        return sets

    def acting(self, r, chosen):
        """Commands as they reach the plant."""
        commands = dict(r.commands)
        for j in chosen:
            if self.case.effects[j].command:
                name, change = self.case.effects[j].command
                reach = self.reach(j, commands[name])
                commands[name] = change(commands[name], self.case.circuit.step, self.case.sizes[j], reach)
        return commands

    def drive(self, r, sets, shaken):
        """The command that a loop around the plant makes."""
        circuit, loop = self.case.circuit, self.case.circuit.loop
        others = {i: v for i, v in r.commands.items() if i != loop.drives}
        table = {**others, **shaken, "r": r.reference, "noise": r.noise}
        held = {f"plant.{k}": v for k, v in sets.items()}
        found = simulate(self.binary, self.folder, "BlindLoop", table, circuit.step, [loop.drives], held,
                         list(shaken) + ["r"], 1e-6)
        return [float(f"{v:.6g}") for v in found[loop.drives]]

    def sensed(self, signal, values, chosen):
        """What a faulty sensor makes of it."""
        span = next(s.range for s in self.case.circuit.signals if s.name == signal)
        for j in chosen:
            if self.case.effects[j].sensor and self.case.effects[j].sensor[0] == signal:
                size = self.case.sizes[j]
                reach = self.reach(j, values) if self.case.effects[j].falling else span
                values = self.case.effects[j].sensor[1](values, self.case.circuit.step, size, reach, None)
        return values

    def reach(self, j, values):
        return self.reached.setdefault(j, max(abs(v) for v in values))

    def again(self, name, chosen, quiet=False):
        """A recording anew under the commands of its last run, also where a loop makes them."""
        closed, self.case.closed = self.case.closed, False
        try:
            return self.run(name, chosen, quiet)
        finally:
            self.case.closed = closed

    def visible(self, chosen):
        """Change of each signal by effects, in standard deviations of its noise."""
        return self.changes({n: (self.run(n, chosen), self.again(n, [])) for n in ("train_1", "train_2")})

    def shaken(self):
        """The same for all disturbances."""
        return self.changes({"train_1": (self.run("train_1", []), self.again("train_1", [], quiet=True))})

    def closing(self, recordings):
        """Held gaps, of full scale and without noise: of the nominal model, and of the true one without disturbances.

        What the true model leaves is the least that any diagnosis can leave.
        """
        case, chosen, kept = self.case, list(range(len(self.case.effects))), self.case.parameters
        held = [f for f in FILES if f.startswith("held")]
        true = {f: self.again(f, chosen, quiet=True) for f in held}
        case.parameters = {k: v for k, (v, _) in case.circuit.known().items()}
        nominal = {f: self.again(f, [], quiet=True) for f in held}
        case.parameters = kept
        return dict(nominal=self.gap(recordings, nominal), true=self.gap(recordings, true))

    def gap(self, recordings, others):
        """Root mean square over recordings, signals and samples, of full scale."""
        parts = []
        for f, signals in others.items():
            skip = self.case.recordings[f].skip
            for s in self.case.circuit.signals:
                a, b = recordings[f][s.name][skip:], signals[s.name][skip:]
                parts.append(sum((x - y) ** 2 for x, y in zip(a, b)) / len(a) / s.range**2)
        return math.sqrt(sum(parts) / len(parts))

    def changes(self, runs):
        total = {s: 0.0 for s in self.case.sigma}
        for a, b in runs.values():
            for s in total:
                total[s] += sum((x - y) ** 2 for x, y in zip(a[s], b[s])) / len(a[s]) / len(runs)
        return {s: math.sqrt(v) / self.case.sigma[s] for s, v in total.items()}

    def told_apart(self, j, names=("train_1", "train_2")):
        """Nats by which an effect beats parameters moved within their tolerances, for white noise and no disturbance.

        An upper bound of what any diagnosis can gain: least squares of the effect's change of the signals on the changes
        that the parameters make, each at the price of its tolerance.
        """
        case = self.case
        points = max(1, case.circuit.samples // 300)
        stack = lambda runs: [
            x / case.sigma[s] * math.sqrt(points) for r in runs for s in case.sigma for x in r[s][::points]
        ]
        full = stack([self.run(n, [j]) for n in names])
        bare = stack([self.again(n, []) for n in names])
        columns = []
        for name, (_, sigma) in case.circuit.known().items():
            kept = case.parameters[name]
            case.parameters[name] = kept * math.exp(0.5 * sigma)
            columns.append([2 * (x - y) for x, y in zip(stack([self.again(n, []) for n in names]), bare)])
            case.parameters[name] = kept
        return 0.5 * ridge(columns, [x - y for x, y in zip(full, bare)])

    def fit(self, j):
        """Turns the size of an effect until it is as visible as was drawn, as far as its limits allow."""
        case, effect = self.case, self.case.effects[j]
        for _ in range(5):
            ratio = max(max(self.visible([j]).values()) / case.aims[j], 1e-3)
            if 0.75 < ratio < 1.33:
                break
            factor = ratio**0.1 if effect.falling else min(max(1 / ratio, 0.15), 6)
            size = min(max(abs(case.sizes[j]) * factor, effect.least), effect.largest)
            if size == abs(case.sizes[j]):
                break
            case.sizes[j] = math.copysign(size, case.sizes[j])
        return self.visible([j])


def ridge(columns, data):
    """Least of |data - columns x|^2 + |x|^2: by orthogonalising the columns, with the unit matrix below, one by one."""
    n = len(columns)
    rows = [c + [1.0 if j == k else 0.0 for j in range(n)] for k, c in enumerate(columns)]
    left, done = data + [0.0] * n, []
    dot = lambda a, b: sum(x * y for x, y in zip(a, b))
    for row in rows:
        for d in done:
            f = dot(row, d)
            row = [x - f * y for x, y in zip(row, d)]
        length = math.sqrt(dot(row, row))
        done.append([x / length for x in row])
        f = dot(left, done[-1])
        left = [x - f * y for x, y in zip(left, done[-1])]
    return dot(left, left)
