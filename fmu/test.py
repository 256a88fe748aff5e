#!/usr/bin/env python3
"""Units that `bramah export` writes, in the hands of FMPy: python fmu/test.py BRAMAH [--quick]

Needs fmpy and numpy (PyPI), and the library beside the command (`cargo build --release -p bramah-fmu`). With a C compiler
a client in C is tried too. Each check is a line; the exit status is 1 where one failed.
"""

import csv
import ctypes
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import (
    FMU2Slave,
    calloc,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    free,
)
from fmpy.fmi3 import FMU3Slave, fmi3LogMessageCallback
from fmpy.logging import addLoggerProxy
from fmpy.validation import validate_fmu

BRAMAH = os.path.abspath(sys.argv[1])
QUICK = "--quick" in sys.argv
ROOT = Path(__file__).resolve().parent.parent
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
ALL = """
model All "every type, as parameter, input and output"
  type Mode = enumeration(low, mid, high);
  parameter Integer N = 3 "the structure depends on it";
  parameter Real T(unit = "s", min = 1e-3, max = 10) = 0.5;
  parameter Real T_twice(unit = "s") = 2*T;
  parameter Mode m = Mode.mid;
  parameter Boolean on = true;
  parameter Integer gain = 2;
  parameter Real p(unit = "Pa", displayUnit = "bar") = 1e5;
  input Real u(start = 2, unit = "V");
  input Integer iu(start = 1);
  input Boolean bu(start = false);
  input Mode mu(start = Mode.low);
  output Real y(start = 0, fixed = true);
  output Real through = 2*u;
  output Integer iy = gain*iu;
  output Boolean by = not bu;
  output Mode my = mu;
  Real x[N](each start = 1, each fixed = true);
equation
  T*der(y) = (if on and m <> Mode.high then u else 0) - y;
  for i in 1:N loop
    der(x[i]) = -i*x[i];
  end for;
  assert(y < 50, "y is large");
  annotation(experiment(StopTime = 2));
end All;
"""
SAMPLED = """
model Sampled "a controller that reads its input at its own times, and a state that it sets back"
  input Real u(start = 0);
  discrete output Real y(start = 0, fixed = true);
  output Real x(start = 0, fixed = true);
equation
  der(x) = u;
  when sample(0.1, 0.1) then
    y = u;
  end when;
  when x > 1 then
    reinit(x, x - 1);
  end when;
end Sampled;
"""
TABLE = """
model Table "a table from a file beside it"
  Signal.TimeTable source(fileName = "cycle.csv");
  output Real x(start = 0, fixed = true);
equation
  der(x) = source.y;
end Table;
"""
ODD = """
model Odd "quotes \\"x\\" & <y>,
two lines"
  parameter Integer n(min = -3000000000, max = 3000000000) = 2 "limits that no Int32 has";
  Real 'a "name" <x>' = n*time;
end Odd;
"""
# Stop times (s) where round-off decides later: an encoder that counts, or friction that sticks one step earlier. The others
# run as long as they say.
SHORTER = {
    "ServoPump.Load": 2.0,
    "ServoPump.ResolvedSystem": 0.2,
    "ServoPump.SampledSystem": 0.1,
    "ServoPump.System": 0.5,
}
QUICKLY = ["ClosedCircuit.Case1", "Emps.Complete", "ServoPump.System"]
# Both are runs of one solver that ends its steps at other times. At the tolerance of the models friction that sticks a step
# later moves a torque by 5 % for a moment; at this one a signal is off by a ten-thousandth of its range on average (root of
# the mean square), and by no more than a two-hundredth at a row beside such an instant, where accelerations jump.
TOLERANCE = 1e-8
CLOSE, NEAR = 1e-4, 5e-3
# In Model Exchange the other integrator, CVODE of FMPy, needs this one to come as close: ServoPump.System converges to the
# same trajectory, from 2.7e-4 at 1e-8 to 3.3e-5 at 1e-9 in the force on its piston.
EXCHANGED_TOLERANCE = 1e-9
# Whether a count of the encoder falls before or behind a sampling instant is round-off from the first sample on.
BY_CHANCE = ["ServoPump.Load"]
# What the integrator of FMPy cannot do in Model Exchange, by what CVODE says then.
BEYOND_FMPY = {
    "mxstep steps": "FMPy allows CVODE 500 steps from one row to the next",
    "right-hand side routine failed": "FMPy takes a step that the unit discards for an error",
}
# A signal that moves by less, in its unit or of its greatest value, is round-off.
STILL = 1e-7
CLIENT = r"""
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include "fmi3FunctionTypes.h"
static void say(fmi3InstanceEnvironment e, fmi3Status s, fmi3String c, fmi3String m) { (void)e; (void)s; (void)c; puts(m); }
#define FUNCTION(name) name##TYPE *name = (name##TYPE *)dlsym(library, #name)
#define MUST(call) do { if ((call) != fmi3OK) { puts("failed: " #call); return 1; } } while (0)
/* client LIBRARY RESOURCES TOKEN REFERENCE: what it has after 1 s in 100 steps */
int main(int count, char **words) {
  void *library = count == 5 ? dlopen(words[1], RTLD_NOW | RTLD_LOCAL) : 0;
  if (!library) { puts("no library"); return 1; }
  FUNCTION(fmi3InstantiateCoSimulation); FUNCTION(fmi3EnterInitializationMode); FUNCTION(fmi3ExitInitializationMode);
  FUNCTION(fmi3DoStep); FUNCTION(fmi3GetFloat64); FUNCTION(fmi3Terminate); FUNCTION(fmi3FreeInstance);
  fmi3Instance one = fmi3InstantiateCoSimulation("c", words[3], words[2], fmi3False, fmi3True, fmi3False, fmi3False, 0, 0,
      0, say, 0);
  if (!one) return 1;
  MUST(fmi3EnterInitializationMode(one, fmi3False, 0, 0, fmi3True, 1));
  MUST(fmi3ExitInitializationMode(one));
  for (int k = 0; k < 100; k++) {
    fmi3Boolean event, terminate, early; fmi3Float64 last;
    MUST(fmi3DoStep(one, 0.01 * k, 0.01, fmi3True, &event, &terminate, &early, &last));
  }
  fmi3ValueReference reference = (fmi3ValueReference)atoi(words[4]), unknown = 123456; fmi3Float64 value, other;
  MUST(fmi3GetFloat64(one, &reference, 1, &value, 1));
  if (fmi3GetFloat64(one, &unknown, 1, &other, 1) != fmi3Error || fmi3Terminate(0) != fmi3Error) return 1;
  MUST(fmi3Terminate(one));
  fmi3FreeInstance(one);
  printf("%.9f\n", value);
  return 0;
}
"""

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


# What units have said. FMPy formats the messages of FMI 2 for one logger in a process.
SAID = []
LOGGER_3 = fmi3LogMessageCallback(lambda _, status, category, text: SAID.append(text.decode()))
LOGGER_2 = fmi2CallbackFunctions()
LOGGER_2.logger = fmi2CallbackLoggerTYPE(lambda _, instance, status, category, text: SAID.append(text.decode()))
LOGGER_2.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
LOGGER_2.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
addLoggerProxy(ctypes.byref(LOGGER_2))


class Slave:
    """A unit of either standard, unpacked once."""

    def __init__(self, fmu, token=None, folder=None):
        self.description = fmpy.read_model_description(fmu)
        self.folder = folder or fmpy.extract(fmu)
        self.three = self.description.fmiVersion.startswith("3")
        kind = FMU3Slave if self.three else FMU2Slave
        self.fmu = kind(
            guid=token or self.description.guid, unzipDirectory=self.folder, modelIdentifier="bramah", instanceName="i"
        )
        if self.three:
            self.fmu.instantiate(loggingOn=True, logMessage=LOGGER_3)
        else:
            self.fmu.instantiate(callbacks=LOGGER_2, loggingOn=True)
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

    def put(self, kind, name, value):
        """Sets a value of another type: Integer, Boolean or Enumeration."""
        name, value = [self.references[name]], [value]
        if self.three:
            {"Integer": self.fmu.setInt32, "Boolean": self.fmu.setBoolean, "Enumeration": self.fmu.setInt64}[kind](name, value)
        else:
            (self.fmu.setBoolean if kind == "Boolean" else self.fmu.setInteger)(name, value)

    def take(self, kind, name):
        name = [self.references[name]]
        if self.three:
            getters = {"Integer": self.fmu.getInt32, "Boolean": self.fmu.getBoolean, "Enumeration": self.fmu.getInt64}
            return getters[kind](name)[0]
        return (self.fmu.getBoolean if kind == "Boolean" else self.fmu.getInteger)(name)[0]

    def state(self):
        return self.fmu.getFMUState() if self.three else self.fmu.getFMUstate()

    def back(self, state):
        (self.fmu.setFMUState if self.three else self.fmu.setFMUstate)(state)

    def stored(self, state):
        return (self.fmu.serializeFMUState if self.three else self.fmu.serializeFMUstate)(state)

    def read(self, stored):
        return (self.fmu.deserializeFMUState if self.three else self.fmu.deSerializeFMUstate)(stored)

    def step(self, time, step):
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=step)

    def end(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def refused(what, text, act):
    """Must fail, with a message in the logger that has this text."""
    SAID.clear()
    try:
        act()
        check(what, False, "nothing was refused")
    except Exception:  # noqa: BLE001 - FMPy raises plain exceptions for a status that is not OK
        check(what, any(text in message for message in SAID), SAID)


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
    kept = slave.state()
    stored = slave.stored(kept)
    slave.step(0.5, 0.5)
    first = slave.get("y")
    slave.back(kept)
    slave.step(0.5, 0.5)
    restored = slave.get("y")
    # the integrator begins afresh at a restored state: the same within its tolerance, and to the last bit each time
    check(name + "a restored state goes on as before", abs(restored - first) < 2e-5, restored - first)
    slave.back(slave.read(stored))
    slave.step(0.5, 0.5)
    check(name + "a serialized one as the restored one, to the last bit", slave.get("y") == restored, slave.get("y") - restored)
    other = Slave(fmu)
    other.back(other.read(stored))
    other.step(0.5, 0.5)
    check(name + "and in another instance", other.get("y") == restored, other.get("y") - restored)
    broken = "these bytes are no state"
    refused(name + "half a state", broken, lambda: other.read(stored[: len(stored) // 2]))
    refused(name + "no state at all", broken, lambda: other.read(b""))
    other.end()
    refused(name + "a parameter after the start", "keeps its value", lambda: slave.set(T=1.0))
    refused(name + "an input that is not a number", "cannot be NaN", lambda: slave.set(u=float("nan")))
    refused(name + "a step backwards", "a step from 1 s to 0.5 s", lambda: slave.step(1.0, -0.5))
    refused(name + "a step to nowhere", "NaN", lambda: slave.step(1.0, float("nan")))
    refused(name + "a step without end", "inf", lambda: slave.step(1.0, float("inf")))
    slave.references["nothing"] = 4000
    refused(name + "an unknown reference", "value reference 4000", lambda: slave.get("nothing"))
    slave.fmu.reset()
    slave.start(u=1.0)
    slave.step(0, 1.0)
    check(name + "goes on after all that, and after a reset", abs(slave.get("y") - (1 - np.exp(-2))) < 1e-4, slave.get("y"))
    slave.end()
    refused(name + "a token of another unit", "the token is not", lambda: Slave(fmu, token="{0}"))

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
    refused(name + "a failed assertion", "too much", lambda: slave.step(0, 0.1))
    slave.fmu.freeInstance()
    alone(work, fmu, name)
    if fmi == 3:
        client(work, fmu, name)


def types(work, fmi):
    fmu = export(work / "All.mo", fmi, work / f"all{fmi}.fmu")
    name = f"FMI {fmi}, all types: "
    check(name + "valid", validate_fmu(fmu) == [], validate_fmu(fmu))
    variables = {v.name: v for v in fmpy.read_model_description(fmu).modelVariables}
    wanted = {"N": "calculatedParameter", "T": "parameter", "T_twice": "calculatedParameter", "iu": "input", "my": "output", "x[1]": "local"}
    found = {one: variables[one].causality for one in wanted}
    check(name + "causalities", found == wanted, found)
    units = {u.name: u for u in fmpy.read_model_description(fmu).unitDefinitions}
    pascal, bar = units["Pa"].baseUnit, units["Pa"].displayUnits[0]
    found = (pascal.kg, pascal.m, pascal.s, bar.name, bar.factor, bar.offset)
    check(name + "units", found[:4] == (1, -1, -2, "bar") and abs(bar.factor * 1e5 - 1) < 1e-12 and bar.offset == 0, found)

    odd = validate_fmu(export(work / "Odd.mo", fmi, work / f"odd{fmi}.fmu"))
    check(name + "odd names, descriptions and limits are valid", odd == [], odd)
    slave = Slave(fmu)
    before = slave.state()
    slave.set(T=1.0)
    slave.back(before)
    check(name + "a state from before the start has its parameters", slave.get("T") == 0.5, slave.get("T"))
    for value, text in [(float("nan"), "not a number"), (-1.0, "`min`"), (1e9, "`max`")]:
        refused(name + f"T = {value}", text, lambda value=value: slave.set(T=value))
    refused(name + "a parameter that follows from others", "follows from others", lambda: slave.set(T_twice=5.0))
    refused(name + "a structural parameter", "`N`", lambda: slave.put("Integer", "N", 4))
    refused(name + "a literal that is none, parameter", "`m`", lambda: slave.put("Enumeration", "m", 7))
    slave.put("Integer", "gain", 3)
    slave.put("Enumeration", "m", 1)
    slave.start(T=0.25)
    check(name + "a parameter that follows has followed", slave.get("T_twice") == 0.5, slave.get("T_twice"))
    slave.step(0, 0.5)
    check(name + "an array", abs(slave.get("x[3]") - np.exp(-1.5)) < 1e-4, slave.get("x[3]"))
    slave.set(u=7.0)
    slave.put("Integer", "iu", 21)
    slave.put("Boolean", "bu", True)
    slave.put("Enumeration", "mu", 3)
    check(name + "an input is what was set", slave.get("u") == 7.0, slave.get("u"))
    slave.step(0.5, 0.1)
    found = (slave.get("through"), slave.take("Integer", "iy"), bool(slave.take("Boolean", "by")), slave.take("Enumeration", "my"))
    check(name + "inputs reach outputs with the next step", found == (14.0, 63, False, 3), found)
    refused(name + "a literal that is none, input", "`mu`", lambda: slave.put("Enumeration", "mu", 9))
    refused(name + "an output that is set", "`y`", lambda: slave.set(y=1.0))

    slave.fmu.reset()
    slave.start(u=100.0)
    refused(name + "a run that fails on its way", "y is large", lambda: slave.step(0, 5.0))
    refused(name + "and does not go on from elsewhere", "the unit stands at", lambda: slave.step(5.0, 1.0))
    slave.fmu.reset()
    slave.start(u=1.0)
    slave.step(0, 1.0)
    check(name + "goes on after a reset", abs(slave.get("y") - (1 - np.exp(-2))) < 1e-4, slave.get("y"))
    slave.end()


def alone(work, fmu, name):
    """On a machine with neither bramah nor its environment, under a name with a space, on a thread with a small stack."""
    code = (
        "import fmpy, threading; threading.stack_size(1 << 18); out = []; run = lambda: out.append("
        "fmpy.simulate_fmu('a unit.fmu', stop_time=1, output=['y'], output_interval=0.5)[-1][1]);"
        "t = threading.Thread(target=run); t.start(); t.join(); print(out[0])"
    )
    with tempfile.TemporaryDirectory() as elsewhere:
        shutil.copy(fmu, os.path.join(elsewhere, "a unit.fmu"))
        done = subprocess.run([sys.executable, "-c", code], env={"PATH": ""}, cwd=elsewhere, capture_output=True, text=True)
    check(name + "runs alone", done.returncode == 0 and abs(float(done.stdout) - 2 * (1 - np.exp(-2))) < 1e-3, done.stderr[-400:])


def client(work, fmu, name):
    """A client in C, with the headers of the standard that FMPy has."""
    compiler = shutil.which("cc")
    headers = Path(fmpy.__file__).parent / "c-code"
    if not compiler or not (headers / "fmi3FunctionTypes.h").exists():
        print(f"skipped: {name}a client in C, without compiler or headers")
        return
    (work / "client.c").write_text(CLIENT)
    made = subprocess.run([compiler, "-Wall", "-Werror", f"-I{headers}", "client.c", "-o", "client", "-ldl"], cwd=work, capture_output=True, text=True)
    check(name + "a client in C is compiled", made.returncode == 0, made.stderr[-400:])
    folder = fmpy.extract(fmu)
    description = fmpy.read_model_description(fmu)
    reference = next(v.valueReference for v in description.modelVariables if v.name == "y")
    library = next(Path(folder, "binaries").rglob("bramah.*"))
    words = [str(work / "client"), str(library), f"{folder}/resources/", description.guid, str(reference)]
    done = subprocess.run(words, env={}, capture_output=True, text=True)
    last = (done.stdout.split() or ["nan"])[-1]
    check(name + "a client in C", done.returncode == 0 and abs(float(last) - 2 * (1 - np.exp(-2))) < 1e-4, done.stdout[-400:])


def table(work, fmi):
    """A file that the model reads goes along."""
    folder = work / f"table{fmi}"
    folder.mkdir()
    (folder / "Table.mo").write_text(TABLE)
    (folder / "cycle.csv").write_text("time,value\n0,0\n1,2\n2,2\n")
    fmu = export(folder / "Table.mo", fmi, work / f"table{fmi}.fmu")
    shutil.rmtree(folder)
    x = fmpy.simulate_fmu(fmu, stop_time=2, output=["x"], relative_tolerance=1e-6)[-1][1]
    check(f"FMI {fmi}: a table from a file", abs(x - 3) < 1e-4, x)


def inputs_and_samples(work, fmi):
    """An input that was set before the start and again on the way is not set back when a controller samples."""
    fmu = export(work / "Sampled.mo", fmi, work / f"sampled{fmi}.fmu")
    one = Slave(fmu).start(u=1.0)
    one.step(0.0, 0.05)
    one.set(u=2.0)
    one.step(0.05, 0.02)
    one.step(0.07, 0.08)
    check(f"FMI {fmi}: a sample reads the input that was set last", one.get("y") == 2.0, one.get("y"))
    one.end()
    signals = np.array([(0, 1), (0.25, 1), (0.25, 3), (2, 3)], dtype=[("time", float), ("u", float)])
    for kind in ("CoSimulation", "ModelExchange"):
        found = fmpy.simulate_fmu(
            fmu, stop_time=1.0, output_interval=0.01, fmi_type=kind, input=signals, start_values={"u": 1.0}, relative_tolerance=1e-8
        )
        rows = {round(row["time"], 6): row for row in found}
        truth = lambda t: (t if t <= 0.25 else 0.25 + 3 * (t - 0.25)) % 1.0  # noqa: E731
        worst = max(abs(rows[t]["x"] - truth(t)) for t in (0.2, 0.24, 0.4, 0.47, 0.6, 0.8, 0.9))
        # FMPy steps of Co-Simulation hold an input from their beginning
        check(f"FMI {fmi}: {kind} with an input that jumps and a state that is set back", worst < (0.021 if kind == "CoSimulation" else 1e-6), worst)
        check(f"FMI {fmi}: {kind} samples", (rows[0.22]["y"], rows[0.42]["y"]) == (1.0, 3.0), (rows[0.22], rows[0.42]))


def page(work):
    """The example of docs/fmi.md, with the circuit that `bramah new` writes."""
    text = (ROOT / "docs" / "fmi.md").read_text()
    commands = [shlex.split(line, comments=True) for line in text.splitlines() if line.startswith("bramah ")]
    examples = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    check("docs/fmi.md has commands and an example", len(commands) > 2 and len(examples) == 1, commands)
    for words in commands:
        done = subprocess.run([BRAMAH, *words[1:]], cwd=work, capture_output=True, text=True)
        check(f"docs/fmi.md: {' '.join(words)}", done.returncode == 0, done.stderr[-300:])
    done = subprocess.run([sys.executable, "-c", examples[0]], cwd=work, capture_output=True, text=True)
    check("docs/fmi.md: the example", done.returncode == 0, done.stderr[-300:])


def circuits():
    """Those with an experiment."""
    for file in sorted((ROOT / "models").glob("*/*.mo")):
        if file.parent.name != "stiff" and "experiment(" in file.read_text():
            yield f"{file.parent.name}.{file.stem}"


def circuit(work, name, fmi):
    """All its Real variables beside those of a run in bramah, inputs held (where they begin with 0, at a value that overcomes friction)."""
    fmu = export(name, fmi, work / f"unit{fmi}.fmu")
    messages = validate_fmu(fmu)
    check(f"{name}: FMI {fmi}, valid", messages == [], messages[:3])
    description = fmpy.read_model_description(fmu)
    start, stop = float(description.defaultExperiment.startTime), float(description.defaultExperiment.stopTime)
    stop = min(stop, SHORTER.get(name, stop))
    # no row at an instant at which a controller samples: whether it is read before or after is a matter of taste
    interval = (stop - start) / 487.3
    held = {v.name: float(v.start) or 30.0 for v in description.modelVariables if v.causality == "input"}
    more = []
    if held:
        rows = [["time", *held], [start, *held.values()], [stop, *held.values()]]
        (work / "held.csv").write_text("".join(",".join(map(str, row)) + "\n" for row in rows))
        more = ["--input", str(work / "held.csv")]
    out = work / "out.csv"
    wanted = run("simulate", name, "--stop-time", repr(stop), "--output-interval", repr(interval), "--event-rows", "none", "--relative-tolerance", str(TOLERANCE), "-o", str(out), *more)
    if wanted.returncode:
        return check(f"{name} runs in bramah", False, wanted.stderr[-300:])
    with out.open() as lines:
        head, *rows = csv.reader(lines)
    columns = dict(zip(head, zip(*rows)))
    shown = [v.name for v in description.modelVariables if v.name in columns and v.type in ("Real", "Float64") and v.causality in ("output", "local")]
    for kind, offered in (("CoSimulation", description.coSimulation), ("ModelExchange", description.modelExchange)):
        if offered:
            exchanged = kind == "ModelExchange"
            tolerance = EXCHANGED_TOLERANCE if exchanged else TOLERANCE
            how = {"output": shown, "output_interval": interval, "relative_tolerance": tolerance, "start_values": held}
            try:
                found = fmpy.simulate_fmu(fmu, start_time=start, stop_time=stop, fmi_type=kind, **how)
            except RuntimeError as why:
                reason = next((said for text, said in BEYOND_FMPY.items() if text in str(why)), None)
                if reason is None or kind == "CoSimulation":
                    check(f"{name}: FMI {fmi}, {kind}", False, why)
                else:
                    print(f"skip  {name}: FMI {fmi}, {kind}: {reason}", flush=True)
                continue
            if exchanged and name in BY_CHANCE:
                print(f"skip  {name}: FMI {fmi}, {kind}: it runs; round-off decides what its encoder counts", flush=True)
                continue
            compare(f"{name}: FMI {fmi}, {kind}", columns, found, shown, stop)


def compare(what, columns, found, shown, stop):
    """Trajectories of FMPy beside those of a run in bramah."""
    worst, moving = (0.0, ""), 0
    # FMPy adds rows at events: of rows at one time the last is meant
    times = np.array(columns["time"], float)
    last = np.searchsorted(found["time"], times + 1e-9) - 1
    found = found[np.maximum(last, 0)]
    same = np.allclose(times, found["time"], rtol=0, atol=1e-9)
    for one in shown if same else []:
        reference = np.array(columns[one], float)
        scale = np.ptp(reference)
        if scale > STILL * max(1.0, np.max(np.abs(reference))):
            error = np.abs(found[one] - reference) / scale
            worst = max(worst, (float(max(np.sqrt(np.mean(error**2)) / CLOSE, np.max(error) / NEAR)), one))
            moving += 1
    check(f"{what}, {moving} signals as in bramah over {stop:g} s", same and moving > 0 and worst[0] < 1, worst if same else "other rows")


def main():
    with tempfile.TemporaryDirectory() as folder:
        tempfile.tempdir = folder  # FMPy unpacks units there, and leaves them
        work = Path(folder)
        (work / "Lag.mo").write_text(LAG)
        (work / "Ending.mo").write_text(ENDING)
        (work / "All.mo").write_text(ALL)
        (work / "Odd.mo").write_text(ODD)
        (work / "Sampled.mo").write_text(SAMPLED)
        for fmi in (2, 3):
            small(work, fmi)
            types(work, fmi)
            table(work, fmi)
            inputs_and_samples(work, fmi)
        page(work)
        for name in QUICKLY if QUICK else circuits():
            for fmi in (2, 3):
                circuit(work, name, fmi)
    if failures:
        raise SystemExit(f"{len(failures)} failed")


main()
