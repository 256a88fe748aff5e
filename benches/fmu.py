#!/usr/bin/env python3
"""What a unit costs: python benches/fmu.py BRAMAH

Size; time from the call to the end of initialization, of the first instance in a process and of later ones; 1000 steps of 1 ms through the C functions beside the same second
inside bramah (solving alone, no rows). Needs fmpy. Medians of 10.
"""

import ctypes
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import fmpy

BRAMAH = os.path.abspath(sys.argv[1])
RUNS, STEPS, STEP = 10, 1000, 1e-3


def run(*args):
    subprocess.run([BRAMAH, *args], check=True, capture_output=True)


def begin(library, token, resources):
    make = library.fmi3InstantiateCoSimulation
    make.restype = ctypes.c_void_p
    none = ctypes.c_void_p()
    unit = make(b"i", token, resources, False, False, False, False, none, ctypes.c_size_t(0), none, none, none)
    unit = ctypes.c_void_p(unit)
    assert unit.value
    library.fmi3EnterInitializationMode(unit, False, ctypes.c_double(0), ctypes.c_double(0), False, ctypes.c_double(0))
    assert library.fmi3ExitInitializationMode(unit) == 0
    return unit


def first(folder, token):
    """Milliseconds of the first instance in this process."""
    library = ctypes.CDLL(str(next(Path(folder, "binaries").rglob("*.so"))))
    clock = time.perf_counter()
    begin(library, token.encode(), (folder + "/resources/").encode())
    print(1e3 * (time.perf_counter() - clock))


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        for name in ("ServoPump.DeadZone", "ServoPump.System"):
            run("export", name, "-o", str(work / f"{name}.fmu"))
            print(f"{name}: {(work / f'{name}.fmu').stat().st_size / 1e6:.1f} MB")
        unpacked = str(fmpy.extract(str(work / "ServoPump.System.fmu"), unzipdir=str(work / "unit")))
        token = fmpy.read_model_description(str(work / "ServoPump.System.fmu")).guid.encode()
        library = ctypes.CDLL(str(next(Path(unpacked, "binaries").rglob("*.so"))))
        resources = (unpacked + "/resources/").encode()
        begun, stepped, inside = [], [], []
        flag, last = ctypes.c_bool(), ctypes.c_double()
        flags = [ctypes.byref(flag)] * 3 + [ctypes.byref(last)]
        for _ in range(RUNS):
            clock = time.perf_counter()
            unit = begin(library, token, resources)
            begun.append(time.perf_counter() - clock)
            clock = time.perf_counter()
            for k in range(STEPS):
                status = library.fmi3DoStep(unit, ctypes.c_double(k * STEP), ctypes.c_double(STEP), True, *flags)
                assert status == 0
            stepped.append(time.perf_counter() - clock)
            library.fmi3FreeInstance(unit)
            run("simulate", "ServoPump.System", "--stop-time", str(STEPS * STEP), "--output-interval", str(STEP),
                "--event-rows", "none", "--variables", "x", "-o", str(work / "x.csv"), "--statistics", str(work / "s.json"))
            inside.append(json.loads((work / "s.json").read_text())["solve_s"])
        empty = time.perf_counter()
        for k in range(STEPS):
            library.fmi3GetVersion(ctypes.c_void_p(), ctypes.c_double(k * STEP), ctypes.c_double(STEP), True, *flags)
        empty = time.perf_counter() - empty
        median = statistics.median
        firsts = [
            float(subprocess.run([sys.executable, __file__, BRAMAH, unpacked, token], check=True, capture_output=True).stdout)
            for _ in range(RUNS)
        ]
        print(f"instantiated and initialized: {median(firsts):.1f} ms, the next in a process {1e3 * median(begun):.1f} ms")
        unit, own = median(stepped) - empty, median(inside)
        print(f"{STEPS} steps: {1e3 * unit:.1f} ms, inside bramah {1e3 * own:.1f} ms, ratio {unit / own:.2f}")


first(*sys.argv[2:]) if len(sys.argv) > 2 else main()
