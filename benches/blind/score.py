#!/usr/bin/env python3
"""Joins verdicts and truth: a line a case, a table by circuit, all failures.

usage: score.py OUT
"""

import json
import os
import sys
from collections import defaultdict
from statistics import median


def ports(spots):
    """All names by which places of a verdict go."""
    found = set()
    for spot in spots:
        found.update(spot["node"])
        for part in spot["place"].replace("->", "|").split("|"):
            found.add(part.strip())
        found.add(spot["place"])
    return found


def at_place(truth, spots):
    """Whether places of a verdict touch every group of ports of the truth, or are one of its parameters."""
    found = ports(spots)
    if found & set(truth["parameters"]):
        return True
    return touches(found, truth["groups"]) or any(touches(found, groups) for _, groups in truth.get("also", []))


def touches(found, groups):
    """Whether names of places hold one of each group."""
    return bool(groups) and all(found & set(group) for group in groups)


def family_right(truth, claim):
    if claim["family"] == "parameter":
        return bool(ports(claim["places"]) & set(truth["parameters"]))
    also = any(claim["family"] == f and touches(ports(claim["places"]), groups) for f, groups in truth.get("also", []))
    return also or claim["family"] in truth["families"]


def right(truth, claim):
    return family_right(truth, claim) and at_place(truth, claim["places"])


def covered(drift, parameters):
    """Whether the true value of a parameter lies in its 95 % interval."""
    return abs(drift["value"] - parameters[drift["parameter"]]) <= 1.96 * drift["std"]


# What a diagnosis says that ended without a verdict.
NOTHING = dict(effects=[], places=[], drifts=[], closed=None, seconds=0.0, verdict="none")


class Score:
    """What one verdict is worth."""

    def __init__(self, truth, verdict):
        self.truths = [t for t in truth["effects"] if not t["outside"]]
        self.outside = [t for t in truth["effects"] if t["outside"]]
        claims = verdict["effects"]
        self.claims = claims
        options = lambda c: [c] + c["indistinguishable"]
        self.first = [bool(claims) and family_right(t, claims[0]) if len(self.truths) == 1 else any(family_right(t, c) for c in claims) for t in self.truths]
        self.within = [any(family_right(t, a) for c in claims for a in options(c)) for t in self.truths]
        self.placed = [any(right(t, a) for c in claims for a in options(c)) for t in self.truths]
        self.false = [c for c in claims if not any(family_right(t, a) for t in self.truths for a in options(c))]
        self.located = [bool(verdict["places"]) and any(at_place(t, [p]) for p in verdict["places"][: len(truth["effects"])]) for t in truth["effects"]]
        self.sizes = [1 + len(c["indistinguishable"]) for c in claims]
        self.alarm = verdict["verdict"] == "outside_library"
        self.covered = [covered(d, truth["parameters"]) for d in verdict["drifts"] if d["parameter"] in truth["parameters"]]
        closing = truth.get("closing")
        # what the true model closes of the held gap; None where there is no gap to speak of
        self.possible = 1 - closing["true"] / closing["nominal"] if closing and closing["nominal"] > 2e-3 else None
        self.closed, self.seconds, self.verdict = verdict["closed"], verdict["seconds"], verdict["verdict"]


def load(out):
    for name in sorted(os.listdir(os.path.join(out, "truth"))):
        truth = json.load(open(os.path.join(out, "truth", name, "truth.json")))
        path = os.path.join(out, "verdicts", name)
        if not os.path.exists(path + ".log"):
            continue
        log = open(path + ".log").read()
        good = log.startswith("exit 0") and os.path.exists(path + ".json")
        yield name, truth, json.load(open(path + ".json")) if good else None, log


def described(truth):
    mark = lambda e: f"{e['name']} {max(e['visible'].values()):.1f}s {e['nats']:.0f}n{' small' if e['small'] else ''}"
    return " + ".join(mark(e) for e in truth["effects"]) or "nothing"


def claimed(score):
    return ", ".join(f"{c['family']}@{c['places'][0]['place']}({c['evidence']:.0f})" for c in score.claims) or "-"


def troubles(truth, score):
    """What is wrong with a verdict, in words; effects under one sigma need not be found."""
    found = []
    for t, first, within, placed in zip(score.truths, score.first, score.within, score.placed):
        if t["small"] and not within:
            continue
        if not within:
            found.append("missed")
        elif not first:
            found.append("only in the set")
        if within and not placed:
            found.append("wrong place")
    for t, located in zip(truth["effects"], score.located):
        if t["outside"] and not located and not t["small"]:
            found.append("outside effect not located")
    if score.alarm and all(e["small"] for e in truth["effects"]):
        found.append("something outside the library where nothing is")
    if score.outside and not score.alarm and not score.claims and not all(t["small"] for t in score.outside):
        found.append(f"outside effect: {score.verdict}")
    if score.false:
        found.append("false claim: " + ", ".join(c["family"] for c in score.false))
    return found


def part(values):
    values = list(values)
    return f"{sum(values)}/{len(values)}" if values else "-"


def table(rows):
    """The table by circuit; `closing`: median of the held gap closed over what the true model closes, cases with effects."""
    by = defaultdict(list)
    for row in rows:
        by[row[1]["circuit"]].append(row)
        by["all"].append(row)
    order = [c for c in by if c != "all"] + ["all"]
    print(f"\n{'circuit':16}{'cases':>6}{'no verdict':>12}{'single first':>14}{'in set':>9}{'place':>9}{'two: both':>11}{'nothing: claimed':>18}{'alarm':>7}"
          f"{'outside: claimed':>18}{'located':>9}{'false':>7}{'in 95 %':>9}{'closing':>9}{'s':>7}")
    for circuit in order:
        print(line(circuit, by[circuit]))


def line(circuit, rows):
    failed = sum(s is None for _, _, s, _ in rows)
    # without a verdict nothing is found: such cases count
    good = [(t, s or Score(t, NOTHING)) for _, t, s, _ in rows]
    single = [(e, s) for t, s in good if len(t["effects"]) == 1 for e in s.truths if not e["small"]]
    two = [all(s.within) for t, s in good if len(t["effects"]) == 2]
    closed = [s.closed / s.possible for t, s in good if s.closed is not None and s.possible and s.possible > 0.1 and t["effects"]]
    outside = [s for _, s in good if s.outside]
    healthy = [s for t, s in good if not t["effects"]]
    covered_ = [c for _, s in good for c in s.covered]
    share = f"{100 * sum(covered_) / len(covered_):.0f} %" if covered_ else "-"
    return (
        f"{circuit:16}{len(rows):>6}{failed:>12}{part(s.first[0] for _, s in single):>14}{part(s.within[0] for _, s in single):>9}"
        f"{part(s.placed[0] for _, s in single):>9}{part(two):>11}"
        f"{part(bool(s.claims) for s in healthy):>18}{part(s.alarm for s in healthy):>7}{part(bool(s.claims) for s in outside):>18}"
        f"{part(s.located[0] for s in outside):>9}{sum(len(s.false) for _, s in good):>7}{share:>9}"
        f"{median(closed) if closed else float('nan'):>9.2f}{median([s.seconds for _, _, s, _ in rows if s is not None] or [0]):>7.1f}"
    )


def main():
    rows = [(n, t, Score(t, v) if v else None, log) for n, t, v, log in load(sys.argv[1])]
    print(f"{'case':20}{'truth':52}{'verdict':17}{'claimed':60}{'closed':>7}{'s':>7}")
    for name, truth, score, log in rows:
        if score is None:
            print(f"{name:20}{described(truth):52}failed: {log.splitlines()[0]}")
            continue
        closed = "-" if score.closed is None else f"{score.closed:.2f}"
        print(f"{name:20}{described(truth)[:51]:52}{score.verdict:17}{claimed(score)[:59]:60}{closed:>7}{score.seconds:>7.1f}")
    table(rows)
    print("\nfailures:")
    for name, truth, score, log in rows:
        found = ["no verdict: " + " ".join(log.split()[:60])] if score is None else troubles(truth, score)
        if found:
            print(f"  {name}: {described(truth)}: {'; '.join(found)}" + ("" if score is None else f" [{claimed(score)}]"))
    again = sum(len(t["redrawn"]) for _, t, _, _ in rows)
    if again:
        print(f"{again} plants did not run and were drawn again; OUT/truth says which")


if __name__ == "__main__":
    main()
