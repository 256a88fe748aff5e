#!/usr/bin/env python3
"""What each rule of the judge is good for: recordings of real machines diagnosed with one rule taken out at a time.

usage: ablation.py SCORER WORK PAGE.md [--commit C]

Each rule is a constant of crates/gap/src/policy.rs with the value at which it does nothing. SCORER is score.py of the recordings,
WORK a folder for a checkout and its build. The scorer's JSON of each run stays there; runs that are there are not repeated.
"""

import argparse
import json
import os
import re
import subprocess
import sys

# constant, value, what that means
RULES = [
    (None, None, "all rules"),
    ("ALPHA", "0.5", "a false step is as likely as not"),
    ("DELTA", "1e-6", "every gain is worth a name"),
    ("ACCURACY", "0.0", "sensors are exact"),
    ("NEAR", "0.0", "only the best counts as best"),
    ("SURE", "0.0", "every rival that is behind is surely worse"),
    ("UNCORRELATED", "2.0", "errors count as independent"),
    ("WHOLE_RECORDINGS", "1000", "no recording is left out as a whole"),
    ("OTHER_WEIGHTING", "1e9", "one weighting"),
    ("OPENS", "1e9", "a correction may open the held gap"),
    ("EFFECTS", "1", "one effect"),
    ("STEPPED", "1", "no second step before the fits"),
    ("FRONT", "0", "front-runners are not fitted again"),
    ("STARTS", "1", "one start a hypothesis"),
    ("DAMPINGS", "[0.0, 0.0, 0.0]", "undamped steps in the screen"),
    ("DOUBLINGS", "0", "steps that gained are not doubled"),
    ("SETTLING", "0", "weights are not settled"),
]


def run(command, **options):
    subprocess.run(command, check=True, **options)


def checkout(work, commit):
    tree = os.path.join(work, "tree")
    if not os.path.exists(tree):
        run(["git", "worktree", "add", "--detach", tree, commit])
    run(["git", "checkout", "--quiet", "--force", commit], cwd=tree)
    return tree


def changed(tree, name, value):
    path = os.path.join(tree, "crates/gap/src/policy.rs")
    run(["git", "checkout", "--quiet", "--", "crates/gap/src/policy.rs"], cwd=tree)
    if name is None:
        return
    text, count = re.subn(rf"(pub const {name}: [^=]*= )[^;]*;", rf"\g<1>{value};", open(path).read())
    if count != 1:
        sys.exit(f"no constant {name}")
    open(path, "w").write(text)


def scores(scorer, work, tree, name, value):
    found = os.path.join(work, f"{name or 'all'}.json")
    if not os.path.exists(found):
        changed(tree, name, value)
        target = os.path.abspath(os.path.join(work, "target"))
        run(["cargo", "build", "--release", "--quiet"], cwd=tree, env={**os.environ, "CARGO_TARGET_DIR": target})
        run([sys.executable, scorer, os.path.join(target, "release/bramah"), found], stdout=subprocess.DEVNULL)
    return json.load(open(found))


def row(rule, studies):
    name, value, meaning = rule
    effects = [s for s in studies if s["kind"] == "effect" and not s.get("hard")]
    complete = [s for s in studies if s["kind"] == "complete"]
    others = [s for s in studies if s["kind"] in ("recording_error", "ambiguous")]
    of = lambda group, key: f"{sum(bool(s.get(key)) for s in group)} of {len(group)}"
    what = meaning if name is None else f"`{name}` = {value}: {meaning}"
    return [what, of(effects, "first"), of(effects, "ok"), of(complete, "ok"), of(others, "ok"), f"{sum(s['wall'] for s in studies):.0f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scorer")
    parser.add_argument("work")
    parser.add_argument("page")
    parser.add_argument("--commit", default="HEAD")
    options = parser.parse_args()
    os.makedirs(options.work, exist_ok=True)
    commit = subprocess.run(["git", "rev-parse", "--short", options.commit], capture_output=True, text=True, check=True).stdout.strip()
    tree = checkout(options.work, commit)
    rows = []
    for rule in RULES:
        rows.append(row(rule, scores(options.scorer, options.work, tree, rule[0], rule[1])))
        print(" | ".join(rows[-1]), flush=True)
    heads = ["rule taken out", "first effect right", "all right", "complete models silent", "recording errors, short runs", "s in all"]
    lines = ["| " + " | ".join(r) + " |" for r in [heads, ["---"] * len(heads)] + rows]
    with open(options.page, "w") as out:
        out.write("# What each rule of the judge is good for\n\n")
        out.write(f"Written by `benches/ablation.py` at commit {commit}: the recordings of real machines of `gap.md`, one rule taken out at a time by a value of its constant in `crates/gap/src/policy.rs` at which it does nothing.\n\n")
        out.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
