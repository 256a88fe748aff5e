#!/usr/bin/env python3
"""Makes blind cases: recordings with study and nominal model into OUT/data, the truth into OUT/truth.

usage: generate.py BRAMAH OUT --seed S --cases N [--circuit NAME] [--visible SIGMAS | --null]

With --visible each case has one effect of a library's kind that changes some signal by so many standard deviations of its
noise, as far as the effect's limits allow. With --null no case has one: parameters within their tolerances, disturbances
that are coloured, resonant, drifting or jump, and in half of the recordings a hum that all sensors pick up.
"""

import argparse
import json
import math
import os
import random
import shutil
import tempfile

import shake
from bench import Bench
from case import FILES, Case
from circuits import circuits
from plant import Failed, write
from spec import study

TRIES = 8
# Below this gain over tolerances no diagnosis can be sure of an effect.
ENOUGH = 30


def make(binary, seed, index, circuit, out, visible=None, null=False):
    """One case; a plant that does not run is drawn again, which the truth says."""
    troubles = []
    for attempt in range(TRIES):
        case = Case(random.Random(f"{seed}/{index}/{circuit.name}/{attempt}"), circuit, visible, null)
        with tempfile.TemporaryDirectory() as folder:
            bench = Bench(binary, folder, case)
            try:
                seen = [dict(visible=bench.fit(j), nats=bench.told_apart(j)) for j in range(len(case.effects))]
                shaken = bench.shaken()
                recordings = {f: bench.run(f, list(range(len(case.effects)))) for f in FILES}
                closing = bench.closing(recordings)
            except Failed as trouble:
                troubles.append(dict(effects=[e.name for e in case.effects], why=str(trouble)))
                continue
            save(case, f"{index:03d}_{circuit.name}", out, recordings, truth_of(case, seen, shaken, closing, troubles, seed), os.path.join(folder, "plant.mo"))
            return case, seen
    raise SystemExit(f"case {index} ({circuit.name}): no plant runs: {troubles}")


def save(case, name, out, recordings, truth_told, plant):
    circuit = case.circuit
    data, truth = os.path.join(out, "data", name), os.path.join(out, "truth", name)
    os.makedirs(data, exist_ok=True)
    os.makedirs(truth, exist_ok=True)
    with open(os.path.join(data, "study.toml"), "w") as file:
        file.write(study(circuit, [f + ".csv" for f in FILES]))
    if circuit.text:
        with open(os.path.join(data, "nominal.mo"), "w") as file:
            file.write(circuit.text())
    for f, signals in recordings.items():
        r = case.recordings[f]
        rng = random.Random(r.seed)
        humming = {s: [v + case.sigma[s] * h for v, h in zip(values, r.hum)] for s, values in signals.items()}
        noisy = {s: shake.noisy(rng, v, case.sigma[s], case.quantum[s]) for s, v in humming.items()}
        columns = {**r.commands, **noisy}
        n = circuit.samples
        table = dict(time=[k * circuit.step for k in range(n)], **{c: v[r.skip :] for c, v in columns.items()})
        write(os.path.join(data, f + ".csv"), table)
    shutil.copy(plant, truth)
    with open(os.path.join(truth, "truth.json"), "w") as file:
        json.dump(truth_told, file, indent=1)


def truth_of(case, seen, shaken, closing, troubles, seed):
    """The truth file."""
    parameters = dict(case.parameters)
    for e, size in zip(case.effects, case.sizes):
        if e.drift:
            parameters[e.drift] = case.circuit.parameters[e.drift][0] * math.exp(size)
    effects = [
        dict(
            name=e.name, families=e.families, outside=e.outside(), groups=e.groups, parameters=e.parameters, also=e.also, size=size,
            visible=s["visible"], nats=s["nats"], small=max(s["visible"].values()) < 1 or s["nats"] < ENOUGH,
        )
        for e, size, s in zip(case.effects, case.sizes, seen)
    ]
    deviations = {k: math.log(v / case.circuit.parameters[k][0]) / case.circuit.parameters[k][1] for k, v in parameters.items()}
    return dict(
        circuit=case.circuit.name, seed=seed, effects=effects, closed_loop=case.closed, noise=case.sigma,
        quantum=case.quantum, parameters=parameters, shaken=shaken, closing=closing, deviations=deviations, redrawn=troubles,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("binary")
    parser.add_argument("out")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--cases", "--plants", type=int, default=8)
    parser.add_argument("--circuit")
    drawn = parser.add_mutually_exclusive_group()
    drawn.add_argument("--visible", type=float, metavar="SIGMAS")
    drawn.add_argument("--null", action="store_true")
    options = parser.parse_args()
    offered = circuits(options.circuit)
    for index in range(options.cases):
        circuit = offered[index % len(offered)]
        case, seen = make(options.binary, options.seed, index, circuit, options.out, options.visible, options.null)
        what = [f"{e.name} ({max(v['visible'].values()):.1f} sigma, {v['nats']:.0f} nats)" for e, v in zip(case.effects, seen)] or ["nothing"]
        if os.environ.get("BLIND_SHOW"):
            print(f"{index:03d}_{circuit.name}: {' and '.join(what)}", flush=True)
    print(f"{options.cases} cases in {options.out}")


if __name__ == "__main__":
    main()
