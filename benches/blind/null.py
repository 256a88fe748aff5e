#!/usr/bin/env python3
"""How often something is claimed of plants that lack nothing, with the 95 % interval of that rate (Clopper and Pearson).

usage: null.py OUT
"""

import json
import math
import os
import sys
from collections import defaultdict


def binomial(k, n, p):
    """Probability of at most k of n."""
    return sum(math.comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(k + 1))


def bisected(rises, low=0.0, high=1.0):
    """Where a function that is false at first becomes true."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rises(middle) else (middle, high)
    return high


def interval(k, n):
    least = 0.0 if k == 0 else bisected(lambda p: 1 - binomial(k - 1, n, p) >= 0.025)
    most = 1.0 if k == n else bisected(lambda p: binomial(k, n, p) <= 0.025)
    return least, most


def claims(verdict):
    """What a verdict says is missing or wrong."""
    effects = [f"{e['family']} at {e['places'][0]['place']} ({e['evidence']:.1f} nats)" for e in verdict["effects"]]
    recording = [f"{r['error']} of {r['signal']}" for r in verdict["recording"]]
    outside = ["an effect outside the library"] if verdict["verdict"] == "outside_library" else []
    return effects + recording + outside


def main():
    out = sys.argv[1]
    folder = os.path.join(out, "verdicts")
    by_circuit = defaultdict(list)
    for name in sorted(n.removesuffix(".log") for n in os.listdir(folder) if n.endswith(".log")):
        path = os.path.join(folder, name + ".json")
        if not os.path.exists(path):
            print(f"{name:30} no verdict: it does not count")
            continue
        found = claims(json.load(open(path)))
        by_circuit[name.split("_", 1)[1]].append(bool(found))
        if found:
            print(f"{name:30} {'; '.join(found)}")
    for circuit, claimed in sorted(by_circuit.items()):
        print(f"{circuit:30} {sum(claimed)} of {len(claimed)}")
    claimed = [c for all_of in by_circuit.values() for c in all_of]
    least, most = interval(sum(claimed), len(claimed))
    print(f"claims: {sum(claimed)} of {len(claimed)} plants that lack nothing, 95 % interval {100 * least:.1f} to {100 * most:.1f} %")


if __name__ == "__main__":
    main()
