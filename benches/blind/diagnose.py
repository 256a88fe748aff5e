#!/usr/bin/env python3
"""Runs `bramah gap` on every folder of OUT/data; verdicts, words and exit codes go to OUT/verdicts. Knows no truth.

usage: diagnose.py BRAMAH OUT [--limit SECONDS] [CASE ...]
"""

import argparse
import os
import subprocess
import time


def diagnose(binary, folder, result, limit):
    """One case; what happened goes into a .log beside the verdict, its first line says how it ended."""
    command = [binary, "gap", os.path.join(folder, "study.toml"), "--data", folder, "--output", result + ".json"]
    begin = time.monotonic()
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit)
        end, words = f"exit {done.returncode}", done.stderr
    except subprocess.TimeoutExpired:
        end, words = "time", ""
    with open(result + ".log", "w") as log:
        log.write(f"{end} {time.monotonic() - begin:.1f} s\n{words}")
    return end


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("binary")
    parser.add_argument("out")
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--limit", type=float, default=900)
    options = parser.parse_args()
    data, verdicts = os.path.join(options.out, "data"), os.path.join(options.out, "verdicts")
    os.makedirs(verdicts, exist_ok=True)
    for name in options.cases or sorted(os.listdir(data)):
        if not os.path.exists(os.path.join(verdicts, name + ".log")):
            end = diagnose(options.binary, os.path.join(data, name), os.path.join(verdicts, name), options.limit)
            print(f"{name}: {end}", flush=True)


if __name__ == "__main__":
    main()
