#!/usr/bin/env python3
"""Checks and runs every example of the Modelica Standard Library and writes docs/validation/libraries.md.

usage: libraries.py BRAMAH FOLDER PAGE.md [--limit SECONDS]

FOLDER holds the folder `Modelica`. Two runs at a time; one that takes longer than the limit counts as stopped.
"""

import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile

PACKAGES = [
    "Blocks", "Clocked", "ComplexBlocks", "Electrical", "Fluid", "Magnetic", "Math", "Mechanics", "Media", "StateGraph",
    "Thermal", "Utilities",
]
ROW = re.compile(r"^(Modelica\.\S+)\s+(ok|[EW]\d{3})\s+(.*)$")


def checked(bramah, folder, package):
    command = [bramah, "check", os.path.join(folder, "Modelica"), "--all", "--model", f"Modelica.{package}"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    rows = [ROW.match(line) for line in found.stdout.splitlines()]
    return [row.groups() for row in rows if row]


def first_error(text):
    lines = [line for line in text.splitlines() if line.startswith("error[")]
    return re.sub(r"^error\[(E\d+)\]: ", r"\1 ", lines[0]) if lines else "ended without a message"


def run(bramah, folder, model, limit):
    with tempfile.TemporaryDirectory() as out:
        command = [bramah, "simulate", model, "--library", folder, "-o", os.path.join(out, "run.mat")]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=False)
        except subprocess.TimeoutExpired:
            return f"not at its end after {limit} s"
    return None if done.returncode == 0 else first_error(done.stderr)


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"


def cell(text):
    return text.replace("|", "\\|")


def main():
    bramah, folder, page = sys.argv[1:4]
    limit = int(sys.argv[5]) if sys.argv[4:5] == ["--limit"] else 30
    counts, refused, stopped = [], [], []
    for package in PACKAGES:
        rows = checked(bramah, folder, package)
        good = [name for name, state, _ in rows if state == "ok"]
        refused += [(name, f"{state} {why}") for name, state, why in rows if state != "ok"]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            ends = list(pool.map(lambda name: run(bramah, folder, name, limit), good))
        stopped += [(name, end) for name, end in zip(good, ends) if end]
        counts.append((package, len(rows), len(good), sum(end is None for end in ends)))
        print(*counts[-1], flush=True)
    counts.append(("all", *(sum(row[i] for row in counts) for i in (1, 2, 3))))
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    with open(page, "w", encoding="utf-8") as out:
        out.write("# The Modelica Standard Library: what runs\n\n")
        out.write(f"Made by `./x libraries` at {commit.stdout.strip()}: every example of version 4.1 with an `experiment` "
                  f"annotation, checked and run to its end ({limit} s at most, two at a time). Whether the results are "
                  "right is another question, which the reference results of the library answer where there are any.\n\n")
        out.write(table(["package", "examples", "compile", "run to their end"], counts))
        out.write("\n## Refused\n\n" + table(["example", "why"], [(n, cell(w)) for n, w in refused]))
        out.write("\n## Stopped on the way\n\n" + table(["example", "why"], [(n, cell(w)) for n, w in stopped]))


main()
