"""What is drawn for one case: plant, sensors, recordings with their disturbances and noise."""

import math

import effects as library
import shake
from plant import disturbance_names

FILES = ["train_1", "train_2", "train_3", "held_1", "held_2"]


class Case:
    """Everything that is drawn for one case but the sizes of its effects."""

    def __init__(self, rng, circuit, visible=None, null=False):
        self.circuit = circuit
        self.null = null
        if null:
            self.effects = []
        else:
            self.effects = library.draw(rng, circuit) if visible is None else [library.known(rng, circuit)]
        self.parameters = {k: v * math.exp(clipped(rng) * sigma) for k, (v, sigma) in circuit.known().items()}
        level = rng.choice([0.002, 0.005, 0.01])
        self.sigma = {s.name: s.range * level * rng.uniform(0.6, 1.5) for s in circuit.signals}
        self.quantum = {s: v * math.exp(rng.uniform(math.log(0.05), math.log(0.6))) for s, v in self.sigma.items()}
        self.tolerance = rng.choice([1e-7, 1e-8])
        self.closed = circuit.loop is not None and rng.random() < 0.6
        drawn = [math.exp(rng.uniform(math.log(1.5), math.log(25))) for _ in self.effects]
        self.aims = drawn if visible is None else [visible]
        self.sizes = [e.size for e in self.effects]
        self.recordings = {f: Recording(rng, circuit, f, self) for f in FILES}


class Recording:
    """Commands, disturbances and noise of one recording; the first `skip` samples are not recorded."""

    def __init__(self, rng, circuit, name, case):
        dt = circuit.step
        self.skip = rng.choice([0, int(rng.uniform(0, circuit.settle) / dt)])
        n = self.n = circuit.samples + self.skip
        self.commands = {i.name: i.trajectory(rng, n, dt, name) for i in circuit.inputs}
        slow = circuit.samples * dt / 10
        kinds = shake.NULL_KINDS if case.null else shake.KINDS
        self.disturbances = {
            d: shake.disturbance(rng, n, dt, node.through, slow, kinds)
            for d, node in zip(disturbance_names(circuit), circuit.nodes)
        }
        if case.closed:
            loop = circuit.loop
            self.reference = loop.trajectory(rng, n, dt, name)
            self.noise = [rng.gauss(0, case.sigma[loop.signal]) for _ in range(n)]
        self.seed = rng.random()
        self.hum = shake.hum(rng, n, dt, slow) if case.null and rng.random() < 0.5 else [0.0] * n


def clipped(rng):
    """A deviation in tolerances, up to two."""
    while True:
        x = rng.gauss(0, 1)
        if abs(x) <= 2:
            return x
