#!/usr/bin/env python3
"""Units that `bramah export` writes, in the hands of FMPy: python fmu/test.py BRAMAH [--quick]

Needs fmpy and numpy (PyPI), and the library beside the command (`cargo build --release -p bramah-fmu`). Each check is a
line; the exit status is 1 where one failed.
"""

import ctypes
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

BRAMAH = os.path.abspath(sys.argv[1])
QUICK = "--quick" in sys.argv
LAG = """
model Lag "a lag with an event"
  type Mode = enumeration(low, high);
  input Real u(start = 2, unit = "V");
  parameter Real T(unit = "s", min = 1e-3, displayUnit = "ms") = 0.5 "time constant";
  parameter Real T_0(unit = "K", displayUnit = "degC") = 313.15;
  parameter Boolean on = true;
  parameter Integer n = 2;
  output Real y(start = 0, fixed = true, unit = "V");
  Mode mode = if y > 1 then Mode.high else Mode.low;
  Integer k(start = 0, fixed = true);
equation
  T*der(y) = (if on then u else 0) - y;
  when y > 1 then
    k = pre(k) + n;
  end when;
  annotation(experiment(StopTime = 2));
end Lag;
"""
ENDING = """
model Ending
  input Real u(start = 0);
  output Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  when x > 0.55 then
    terminate("far enough");
  end when;
  assert(u < 5, "too much");
end Ending;
"""
# Circuits of the papers, their stop time here (s), what is compared.
CIRCUITS = [
    ("ServoPump.System", 0.5, ["x", "p_A", "p_B", "N"]),
    ("ServoPump.DeadZone", 5.0, ["N", "p_A", "p_B"]),
    ("ClosedCircuit.Case1", 20.0, ["n_p", "n_m", "p"]),
]
MORE = [
    ("ServoPump.Load", 0.5, ["N", "p_A", "T_e"]),
    ("ServoPump.NoLoad", 1.0, ["N", "Q_A"]),
    ("ClosedCircuit.Case3", 35.0, ["n_p", "n_m", "p"]),
]
# Both are runs of one solver with other steps. At the tolerance of the models friction that sticks a step later moves a
# torque by 5 % for a moment; at this one they agree to a ten-thousandth of a signal's range at every row.
TOLERANCE = 1e-8
CLOSE = 1e-4

failures = []


def check(what, fine, more=""):
    print(("ok    " if fine else "FAIL  ") + what, more if not fine else "", flush=True)
    if not fine:
        failures.append(what)


def run(*args):
    return subprocess.run([BRAMAH, *args], capture_output=True, text=True)


def export(source, fmi, out, *more):
    done = run("export", source, "--fmi", str(fmi), "-o", str(out), *more)
    if done.returncode:
        raise SystemExit(f"export {source}: {done.stderr}")
    return str(out)


class Slave:
    """A unit of either standard, unpacked once."""

    def __init__(self, fmu, token=None, folder=None):
        self.description = fmpy.read_model_description(fmu)
        self.folder = folder or fmpy.extract(fmu)
        self.three = self.description.fmiVersion.startswith("3")
        self.said = []
        kind = FMU3Slave if self.three else FMU2Slave
        self.fmu = kind(
            guid=token or self.description.guid, unzipDirectory=self.folder, modelIdentifier="bramah", instanceName="i"
        )
        if self.three:
            from fmpy.fmi3 import fmi3LogMessageCallback

            self.logger = fmi3LogMessageCallback(lambda _, status, category, text: self.said.append(text.decode()))
            self.fmu.instantiate(loggingOn=True, logMessage=self.logger)
        else:
            self.fmu.instantiate(loggingOn=True)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}

    def start(self, time=0.0, **values):
        if self.three:
            self.set(**values)
            self.fmu.enterInitializationMode(startTime=time)
        else:
            self.fmu.setupExperiment(startTime=time)
            self.set(**values)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values):
        for name, value in values.items():
            setter = self.fmu.setFloat64 if self.three else self.fmu.setReal
            setter([self.references[name]], [value])

    def get(self, name):
        getter = self.fmu.getFloat64 if self.three else self.fmu.getReal
        return getter([self.references[name]])[0]

    def step(self, time, step):
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=step)

    def end(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def refused(what, act):
    try:
        act()
        check(what, False, "nothing was refused")
    except Exception:  # noqa: BLE001 - FMPy raises plain exceptions for a status that is not OK
        check(what, True)


def small(work, fmi):
    fmu = export(work / "Lag.mo", fmi, work / f"lag{fmi}.fmu")
    name = f"FMI {fmi}: "
    check(name + "valid", validate_fmu(fmu) == [], validate_fmu(fmu))
    out = fmpy.simulate_fmu(fmu, stop_time=2, output=["y", "k", "mode"], output_interval=0.1)
    check(name + "values, events and enumerations", abs(out[-1][1] - 2 * (1 - np.exp(-4))) < 1e-4 and out[-1][2] == 2 and out[-1][3] == 2, out[-1])
    out = fmpy.simulate_fmu(fmu, stop_time=2, start_values={"T": 1.0, "u": 3.0, "on": True}, output=["y"], output_interval=0.1)
    check(name + "parameters and start values", abs(out[-1][1] - 3 * (1 - np.exp(-2))) < 1e-4, out[-1])
    signal = np.array([(0, 1), (0.999999, 1), (1, 4), (2, 4)], dtype=[("time", float), ("u", float)])
    out = fmpy.simulate_fmu(fmu, stop_time=2, input=signal, output=["y"], output_interval=0.05)
    check(name + "inputs over time", abs(out[-1][1] - (4 + (1 - np.exp(-2) - 4) * np.exp(-2))) < 1e-3, out[-1])
    variables = {v.name: v for v in fmpy.read_model_description(fmu).modelVariables}
    check(name + "causalities", (variables["u"].causality, variables["y"].causality, variables["T"].causality) == ("input", "output", "parameter"))
    shown = {u.name: {d.name: (d.factor, d.offset) for d in u.displayUnits} for u in fmpy.read_model_description(fmu).unitDefinitions}
    check(name + "units for people", shown["s"]["ms"] == (1000.0, 0.0) and abs(shown["K"]["degC"][1] + 273.15) < 1e-9, shown)

    slave = Slave(fmu).start(T=0.5)
    slave.step(0, 0.5)
    kept = slave.fmu.getFMUState() if slave.three else slave.fmu.getFMUstate()
    stored = slave.fmu.serializeFMUState(kept) if slave.three else slave.fmu.serializeFMUstate(kept)
    slave.step(0.5, 0.5)
    first = slave.get("y")
    (slave.fmu.setFMUState if slave.three else slave.fmu.setFMUstate)(kept)
    slave.step(0.5, 0.5)
    restored = slave.get("y")
    # the integrator begins afresh at a restored state: the same within its tolerance, and to the last bit each time
    check(name + "a restored state goes on as before", abs(restored - first) < 2e-5, restored - first)
    again = (slave.fmu.deserializeFMUState if slave.three else slave.fmu.deSerializeFMUstate)(stored)
    (slave.fmu.setFMUState if slave.three else slave.fmu.setFMUstate)(again)
    slave.step(0.5, 0.5)
    check(name + "a serialized one as the restored one, to the last bit", slave.get("y") == restored, slave.get("y") - restored)
    refused(name + "a parameter after the start", lambda: slave.set(T=1.0))
    refused(name + "an input that is not a number", lambda: slave.set(u=float("nan")))
    refused(name + "a step backwards", lambda: slave.step(1.0, -0.5))
    slave.references["nothing"] = 4000
    refused(name + "an unknown reference", lambda: slave.get("nothing"))
    slave.fmu.reset()
    slave.start(u=1.0)
    slave.step(0, 1.0)
    check(name + "goes on after all that, and after a reset", abs(slave.get("y") - (1 - np.exp(-2))) < 1e-4, slave.get("y"))
    slave.end()
    refused(name + "a token of another unit", lambda: Slave(fmu, token="{0}"))

    folder = fmpy.extract(fmu)
    many = [Slave(fmu, folder=folder).start(u=1.0 + k) for k in range(100)]
    for one in many:
        one.step(0, 1.0)
    check(name + "a hundred instances", all(abs(s.get("y") - (1 + k) * (1 - np.exp(-2))) < 1e-3 for k, s in enumerate(many)))
    for one in many:
        one.end()
    found = []

    def work_alone(k):
        one = Slave(fmu, folder=folder).start(u=1.0 + k)
        for i in range(100):
            one.step(0.01 * i, 0.01)
        found.append(abs(one.get("y") - (1 + k) * (1 - np.exp(-2))) < 1e-3)
        one.end()

    threads = [threading.Thread(target=work_alone, args=(k,)) for k in range(8)]
    [t.start() for t in threads]
    [t.join() for t in threads]
    check(name + "eight threads", len(found) == 8 and all(found), found)

    ending = export(work / "Ending.mo", fmi, work / f"ending{fmi}.fmu")
    out = fmpy.simulate_fmu(ending, stop_time=2, output=["x"], output_interval=0.1)
    check(name + "the model ends the run", out[-1][0] < 1.0, out[-1])
    slave = Slave(ending).start()
    slave.set(u=6.0)
    refused(name + "a failed assertion", lambda: slave.step(0, 0.1))
    slave.fmu.freeInstance()
    alone(fmu, name)


def alone(fmu, name):
    """On a machine with neither bramah nor its environment."""
    code = f"import fmpy; out = fmpy.simulate_fmu({fmu!r}, stop_time=1, output=['y'], output_interval=0.5); print(out[-1][1])"
    with tempfile.TemporaryDirectory() as elsewhere:
        done = subprocess.run([sys.executable, "-c", code], env={"PATH": ""}, cwd=elsewhere, capture_output=True, text=True)
    check(name + "runs alone", done.returncode == 0 and abs(float(done.stdout) - 2 * (1 - np.exp(-2))) < 1e-3, done.stderr[-400:])


def circuit(work, name, stop, compared, fmi):
    # no row at an instant at which a controller samples: whether it is read before or after is a matter of taste
    interval = stop / 487.3
    described = name.replace(".", "_")
    wanted = run("simulate", name, "--stop-time", str(stop), "--output-interval", str(interval), "-o", str(work / f"{described}.csv"), "--event-rows", "none", "--relative-tolerance", str(TOLERANCE))
    check(f"{name} runs in bramah", wanted.returncode == 0, wanted.stderr[-300:])
    table = np.genfromtxt(work / f"{described}.csv", delimiter=",", names=True, deletechars="")
    fmu = export(name, fmi, work / f"{described}{fmi}.fmu", "--outputs", ",".join(compared))
    messages = validate_fmu(fmu)
    check(f"{name}: FMI {fmi}, valid", messages == [], messages[:3])
    out = fmpy.simulate_fmu(fmu, stop_time=stop, output=compared, output_interval=interval, relative_tolerance=TOLERANCE)
    worst = ("", 0.0)
    for one in compared:
        reference = np.interp(out["time"], table["time"], table[one])
        error = np.max(np.abs(out[one] - reference)) / np.ptp(table[one])
        worst = max(worst, (one, error), key=lambda w: w[1])
    check(f"{name}: FMI {fmi}, as in bramah ({', '.join(compared)})", worst[1] < CLOSE, worst)


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "Lag.mo").write_text(LAG)
        (work / "Ending.mo").write_text(ENDING)
        for fmi in (2, 3):
            small(work, fmi)
        for name, stop, compared in CIRCUITS + ([] if QUICK else MORE):
            for fmi in (3,) if QUICK else (2, 3):
                circuit(work, name, stop, compared, fmi)
    if failures:
        raise SystemExit(f"{len(failures)} failed")


main()
