#!/usr/bin/env python3
"""Writes docs/validation/gap.md from what `./x realbench` and `./x gapbench` measured.

usage: figures.py REALBENCH_SCORES.json GAPBENCH_SCORES.json PAGE.md
"""

import json
import os
import subprocess
import sys


def read(path):
    return json.load(open(path)) if os.path.exists(path) else []


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"


def share(value):
    return "" if value is None else f"{100 * value:.0f} %"


def count(studies, key):
    return f"{sum(bool(s.get(key)) for s in studies)} of {len(studies)}"


def machines(studies):
    effects = [s for s in studies if s["kind"] == "effect" and not s.get("hard")]
    others = [("complete models: nothing claimed over 10 % of the gap", ["complete"]),
              ("recording errors and short runs", ["recording_error", "ambiguous"])]
    rows = [
        ("first effect of the right family", count(effects, "first")),
        ("right one first or in its set", count(effects, "in_set")),
        ("place right", count(effects, "place")),
        ("all right: first, place, gap closed as far as the complete model closes it", count(effects, "ok")),
    ]
    rows += [(name, count([s for s in studies if s["kind"] in kinds], "ok")) for name, kinds in others]
    rows.append(("time of a study, s", f"{min(s['wall'] for s in studies):.1f} to {max(s['wall'] for s in studies):.1f}"))
    each = [
        (f"{s['set']}/{s['study'].removesuffix('.toml')}" + (" (hard)" if s.get("hard") else ""), s["kind"],
         s["verdict"].replace("_", " "), ", ".join(s["families"]).replace("_", " "), share(s["closed"]),
         "right" if s["ok"] else "not all right", f"{s['wall']:.0f}")
        for s in studies
    ]
    heads = ["study", "kind", "verdict", "effects named", "gap closed", "", "s"]
    return table(["figure", "result"], rows) + "\n" + table(heads, each)


def plants(cases):
    single = [c for c in cases if c["known"] == 1]
    pairs = [c for c in cases if c["known"] > 1]
    silent = [c for c in cases if not c["labels"]]
    outside = [c for c in cases if c["labels"] and not c["known"]]
    of = lambda good, all_: f"{sum(map(good, all_))} of {len(all_)}"
    rows = [
        ("one effect: right one first", of(lambda c: c["first"] == 1, single)),
        ("one effect: right one first or in its set", of(lambda c: c["within"] == 1, single)),
        ("pairs: both", of(lambda c: c["first"] == c["known"], pairs)),
        ("nothing missing: nothing named", of(lambda c: not c["found"], silent)),
        ("outside the library: no wrong name", of(lambda c: not c["found"], outside)),
        ("false effects in all cases", sum(c["false"] for c in cases)),
        ("time of a case, s", f"{min(c['seconds'] for c in cases):.0f} to {max(c['seconds'] for c in cases):.0f}"),
    ]
    each = [
        (c["case"], ", ".join(c["labels"]) or "nothing", c["verdict"].replace("_", " "),
         ", ".join(c["found"]).replace("_", " "), share(c["closed"]), f"{c['seconds']:.0f}")
        for c in cases
    ]
    return table(["figure", "result"], rows) + "\n" + table(
        ["case", "missing", "verdict", "effects named", "gap closed", "s"], each)


def main():
    real, simulated, page = sys.argv[1:4]
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    text = [
        "# How often the diagnosis is right\n",
        f"Written by `./x figures` at commit {commit}, two cores. Test data of third parties are not part of the project.\n",
    ]
    if studies := read(real):
        text += ["## Recordings of real machines\n",
                 "Each nominal model lacks its machine's dominating effect; complete models lack nothing that is known. "
                 "The rules of the judge were made on these recordings.\n", machines(studies)]
    if cases := read(simulated):
        text += ["## Simulated plants\n",
                 "A servo-pump axis by another simulator, in other functional forms than the library's, with noise and "
                 f"disturbances at every node; labelled, and seen while the judge was made. Cases run: {len(cases)}.\n", plants(cases)]
    with open(page, "w") as out:
        out.write("\n".join(text))


main()
