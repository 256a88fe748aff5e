#!/usr/bin/env python3
"""Says for every labelled case where the true effect was lost, and whether its fit found the optimum.

usage: reach.py BRAMAH OUT.json SHARED [CASE ...]

Cases are the studies of SHARED/realbench with an effect, and those of SHARED/gapbench/papers. Of each the diagnosis runs
twice: once as a user runs it, once for the true effect alone (`--explain-rejected`), which is then fitted from all its starts
whatever the time. `reach` is the left-out gap of the true effect in the search over that of the fit alone: 1 where the search
found the optimum. Labels are read here, after the diagnosis has ended; the diagnosis sees recordings only.
"""

import json
import os
import sys

from gapbench import run

# Part by which the search may leave more than the fit alone.
NEAR = 1.02


def realbench(shared):
    folder = os.path.join(shared, "realbench")
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name, "expect.json")
        if not os.path.exists(path):
            continue
        expected = json.load(open(path))
        for study, said in expected["studies"].items():
            if said["kind"] == "effect":
                yield {
                    "name": f"{name}/{study}",
                    "study": os.path.join(folder, name, study),
                    "data": os.path.join(folder, name, "data"),
                    "families": said["steps"][0]["families"],
                }


def papers(shared):
    folder = os.path.join(shared, "gapbench", "papers")
    for name in sorted(os.listdir(folder)):
        here = os.path.join(folder, name)
        if os.path.exists(os.path.join(here, "truth.json")):
            truth = json.load(open(os.path.join(here, "truth.json")))
            if truth["right"]:
                study = os.path.join(here, "study.toml")
                yield {"name": name, "study": study, "data": here, "families": truth["right"][0]["families"]}


def lost(case, found):
    """Where the true effect was lost, and the entry of the first step that stands for it."""
    true = [w for w in found["weighed"] if w["step"] == 1 and w["family"] in case["families"]]
    weighed = sorted((w for w in true if w["gap"] is not None), key=lambda w: w["gap"])
    taken = [w for w in weighed if w["refused"] is None]
    effects = found["effects"]
    if found["recording"]:
        where = f"a recording error is named: {found['recording']}"
    elif effects and effects[0]["family"] in case["families"]:
        where = "named"
    elif effects and any(e["family"] in case["families"] for e in effects[0]["indistinguishable"]):
        where = "in the set"
    elif not true:
        where = "not among the hypotheses"
    elif not weighed:
        where = "not weighed: the time was over"
    else:
        where = (taken or weighed)[0]["refused"] or "taken, and dropped later"
    return where, (taken or weighed or true or [None])[0]


def entry(binary, case):
    found, trouble = run(binary, case["study"], case["data"])
    if found is None:
        return {"case": case["name"], "where": f"no verdict: {trouble}"}
    where, true = lost(case, found)
    result = {"case": case["name"], "where": where, "seconds": round(found["seconds"], 1)}
    if true is None:
        return result
    place = true["places"][0]["place"]
    alone, _ = run(binary, case["study"], case["data"], "--explain-rejected", f"{true['effect']}@{place}")
    best = alone and next((w["gap"] for w in alone["weighed"] if w["gap"] is not None), None)
    result |= {"effect": true["effect"], "place": place, "gap": true["gap"], "gap alone": best}
    if best and true["gap"]:
        result["reach"] = round(true["gap"] / best, 3)
    return result


def main():
    binary, out, shared = sys.argv[1:4]
    cases = [c for c in [*realbench(shared), *papers(shared)] if not sys.argv[4:] or c["name"] in sys.argv[4:]]
    results = []
    for case in cases:
        results.append(entry(binary, case))
        last = results[-1]
        print(f"{last['case']:34} {last.get('seconds', ''):>6} s  reach {last.get('reach', '-'):>6}  {last['where']}", flush=True)
    reached = sum(r.get("reach", float("inf")) <= NEAR for r in results)
    print(f"the search reached the optimum of the true effect in {reached} of {len(results)} cases")
    with open(out, "w") as file:
        json.dump(results, file, indent=1)


if __name__ == "__main__":
    main()
