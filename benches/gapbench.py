#!/usr/bin/env python3
"""Runs `bramah gap` over labelled cases and compares the verdicts with their labels.

usage: gapbench.py BRAMAH STUDY CASES_DIR SCORES.json [CASE ...]

Truth is read here, after the diagnosis has ended; the diagnosis sees the recordings only.
"""

import json
import os
import subprocess
import sys
import tempfile

# Families that are right for a label of the bench.
FAMILIES = {
    "cyl_friction": ["dry_friction", "hysteresis"],
    "leak_12": ["internal_leak", "parameter"],
    "leak_case": ["external_leak", "parameter"],
    "pump_shear": ["speed_loss"],
    "air": ["entrained_air"],
    "relief_early": ["valve_early_opening"],
    "par_M": ["parameter", "extra_inertia"],
    "par_J": ["parameter", "extra_inertia"],
    "backlash": ["backlash"],
    "dead_time": ["dead_time"],
    "temp_visc": ["viscosity_temperature"],
    "ripple": ["torque_ripple"],
    "posfric": [],
    "xleak": [],
}
SENSORS = {"bias": ["sensor_offset"], "scale": ["sensor_gain"], "delay": ["sensor_delay"]}


def right(label, effect):
    """Whether a family found fits a label; of sensors also the signal."""
    if label in FAMILIES:
        return effect["family"] in FAMILIES[label]
    kind, _, signal = label.partition("_")
    return effect["family"] in SENSORS.get(kind, []) and any(p["place"] == signal for p in effect["places"])


def run(binary, study, folder, *more):
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        command = [binary, "gap", study, "--data", folder, "--output", out.name, *more]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            return None, done.stderr.strip().splitlines()[:1]
        return json.load(open(out.name)), []


def score(labels, verdict):
    known = [l for l in labels if FAMILIES.get(l, [l])]
    first = sum(any(right(l, e) for e in verdict["effects"]) for l in known)
    alternatives = lambda e: [e] + e["indistinguishable"]
    within = sum(any(right(l, a) for e in verdict["effects"] for a in alternatives(e)) for l in known)
    false = sum(not any(right(l, a) for l in known for a in alternatives(e)) for e in verdict["effects"])
    return len(known), first, within, false


def main():
    binary, study, cases, scores = sys.argv[1:5]
    names = sys.argv[5:] or sorted(os.listdir(cases))
    total = [0, 0, 0, 0]
    all_scores = []
    print(f"{'case':10} {'labels':26} {'verdict':16} {'found':44} {'first':>5} {'set':>4} {'false':>5} {'closed':>7} {'s':>4}")
    for name in names:
        folder = os.path.join(cases, name)
        verdict, trouble = run(binary, study, folder)
        labels = json.load(open(os.path.join(folder, "truth.json")))["labels"]
        if verdict is None:
            print(f"{name:10} {','.join(labels):26} failed: {trouble}")
            continue
        found = score(labels, verdict)
        total = [a + b for a, b in zip(total, found)]
        effects = ",".join(e["family"] for e in verdict["effects"])
        known, first, within, false = found
        all_scores.append({
            "case": name, "labels": labels, "known": known, "first": first, "within": within, "false": false,
            "verdict": verdict["verdict"], "found": [e["family"] for e in verdict["effects"]],
            "closed": verdict["closed"], "seconds": verdict["seconds"],
        })
        json.dump(all_scores, open(scores, "w"), indent=1)
        closed = "-" if verdict["closed"] is None else f"{verdict['closed']:.2f}"
        print(
            f"{name:10} {','.join(labels):26} {verdict['verdict']:16} {effects[:44]:44} {found[1]:5} {found[2]:4} "
            f"{found[3]:5} {closed:>7} {verdict['seconds']:4.0f}",
            flush=True,
        )
    print(f"effects {total[0]}: first {total[1]}, in the set {total[2]}; false claims {total[3]}")


if __name__ == "__main__":
    main()
