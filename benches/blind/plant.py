"""The plant of a case as Modelica text, and its simulation by bramah."""

import csv
import os
import subprocess

# Seconds of a run; a plant that takes longer is drawn again.
LONGEST = 120

PROBES = """
model BlindRod
  Interfaces.TranslationalFlange flange;
  Interfaces.RealInput f;
  Real x(nominal = 0.01);
  Real v(nominal = 0.01);
equation
  x = flange.s;
  v = der(x);
  flange.f = f;
end BlindRod;

model BlindShaft
  Interfaces.RotationalFlange flange;
  Interfaces.RealInput f;
  Real x;
  Real v(nominal = 10);
equation
  x = flange.phi;
  v = der(x);
  flange.tau = f;
end BlindShaft;

model BlindRodCut
  Interfaces.TranslationalFlange flange;
  Interfaces.TranslationalFlange flange_b;
  Interfaces.RealInput f;
  Real x(nominal = 1e-4, start = 0, stateSelect = StateSelect.prefer);
  Real v(nominal = 0.01);
equation
  x = flange.s - flange_b.s;
  v = der(x);
  flange.f = f;
  flange_b.f = -f;
end BlindRodCut;

model BlindShaftCut
  Interfaces.RotationalFlange flange;
  Interfaces.RotationalFlange flange_b;
  Interfaces.RealInput f;
  Real x(nominal = 1e-2, start = 0, stateSelect = StateSelect.prefer);
  Real v(nominal = 10);
equation
  x = flange.phi - flange_b.phi;
  v = der(x);
  flange.tau = f;
  flange_b.tau = -f;
end BlindShaftCut;

model BlindPinCut
  Interfaces.Pin pin;
  Interfaces.Pin pin_b;
  Interfaces.RealInput f;
  Real x(nominal = 1);
equation
  x = pin.i;
  pin.v - pin_b.v = f;
  pin.i + pin_b.i = 0;
end BlindPinCut;

model BlindNode
  Interfaces.HydraulicPort port;
  Interfaces.RealInput f;
  Real p(nominal = 1e6);
equation
  p = port.p;
  port.q = f;
end BlindNode;

model BlindBridge
  Interfaces.HydraulicPort port;
  Interfaces.HydraulicPort port_b;
  Interfaces.RealInput f;
  Real p(nominal = 1e6);
equation
  p = port.p - port_b.p;
  port.q = f;
  port_b.q = -f;
end BlindBridge;
"""

# probe, its first port, its second, for each domain
KINDS = {
    "translation": ("BlindRod", "flange"),
    "rotation": ("BlindShaft", "flange"),
    "translation cut": ("BlindRodCut", "flange"),
    "rotation cut": ("BlindShaftCut", "flange"),
    "pin cut": ("BlindPinCut", "pin"),
    "hydraulic": ("BlindNode", "port"),
    "bridge": ("BlindBridge", "port"),
}


class Plant:
    """Text of a plant: nominal model, effects with sizes as parameters, inputs for disturbances."""

    def __init__(self, circuit, effects, probes=PROBES):
        self.circuit, self.effects, self.probes = circuit, effects, circuit.probes or probes
        self.declare, self.equate, self.start, self.breaks = [], [], [], []
        for k, effect in enumerate(effects):
            self.attach(k, effect)
        for node in circuit.nodes:
            self.shake(node)

    def attach(self, k, effect):
        if not effect.probes:
            return
        self.declare.append(f"parameter Real size_{k} = 0")
        if effect.cut:
            self.breaks.append(f"break {effect.cut}")
        for j, (kind, a, b, form) in enumerate(effect.probes):
            name = f"e{k}_{j}"
            probe, port = KINDS[kind]
            self.declare.append(f"{probe} {name}")
            self.equate.append(f"connect({name}.{port}, {a})")
            if b:
                self.equate.append(f"connect({name}.{port}_b, {b})")
            p = f"{name}.p"
            words = {
                "A": f"size_{k}", "v": f"{name}.v", "x": f"{name}.x", "p": p, "z": f"{name}_z", "y": f"{name}_y",
                "dp": p if kind == "bridge" else f"({p} - ({effect.back}))",
            }
            self.equate.append(f"{name}.f = {form.flow.format(**words)}")
            for state, start, nominal in form.states:
                self.declare.append(f"Real {words[state]}(nominal = {max(abs(nominal), 1e-9):g})")
                self.start.append(f"{words[state]} = {str(start).format(**words)}")
            self.equate += [e.format(**words) for e in form.equations]

    def shake(self, node):
        name = "d_" + node.name.replace(" ", "_")
        probe, port = KINDS[node.domain]
        self.declare += [f"Interfaces.RealInput {name}(start = 0)", f"{probe} {name}_at"]
        self.equate += [f"connect({name}_at.{port}, {node.port})", f"{name}_at.f = -{name}"]

    def text(self):
        breaks = f"({', '.join(self.breaks)})" if self.breaks else ""
        lines = ["model BlindPlant", f"  extends {self.circuit.model}{breaks};"]
        lines += [f"  {d};" for d in self.declare]
        if self.start:
            lines += ["initial equation"] + [f"  {e};" for e in self.start]
        lines += ["equation"] + [f"  {e};" for e in self.equate] + ["end BlindPlant;", ""]
        text = "\n".join(lines) + self.probes + self.loop()
        return text + (self.circuit.text() if self.circuit.text else "")

    def loop(self):
        loop = self.circuit.loop
        if loop is None:
            return ""
        inputs = [i.name for i in self.circuit.inputs if i.name != loop.drives] + disturbance_names(self.circuit)
        declare = "".join(f"  Interfaces.RealInput {i};\n" for i in inputs)
        joined = "".join(f"  plant.{i} = {i};\n" for i in inputs)
        variable = next(s.variable for s in self.circuit.signals if s.name == loop.signal)
        return (
            "\nmodel BlindLoop\n  BlindPlant plant;\n  Interfaces.RealInput r;\n  Interfaces.RealInput noise;\n"
            f"  Real y;\n  Real {loop.drives};\n{declare}equation\n  y = plant.{variable} + noise;\n"
            f"  {loop.drives} = {loop.law};\n  plant.{loop.drives} = {loop.drives};\n{joined}end BlindLoop;\n"
        )


def disturbance_names(circuit):
    return ["d_" + n.name.replace(" ", "_") for n in circuit.nodes]


class Failed(Exception):
    """A plant that does not run."""


def simulate(binary, folder, model, table, dt, variables, sets, linear, tolerance, fine=1):
    """Runs a class of `folder`/plant.mo driven by the columns of `table`; values at each time, after the events.

    The table has `fine` rows for each time of the result.
    """
    source, result = os.path.join(folder, "in.csv"), os.path.join(folder, "out.csv")
    rows = len(next(iter(table.values())))
    n = rows // fine
    write(source, dict(time=[k * dt / fine for k in range(rows)], **table))
    command = [
        binary, "simulate", os.path.join(folder, "plant.mo"), "--model", model, "--input", source, "--stop-time",
        f"{(n - 1) * dt:.9g}", "--output-interval", f"{dt:.9g}", "--relative-tolerance", f"{tolerance:g}", "--variables",
        ",".join(variables), "--output-file", result, "--message-format", "short",
    ]
    if linear:
        command += ["--map", ",".join(f"{c}={c}:linear" for c in linear)]
    for name, value in sets.items():
        command += ["--set", f"{name}={value:.12g}"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired as trouble:
        raise Failed("takes too long") from trouble
    if done.returncode != 0:
        raise Failed(done.stderr.strip()[:600])
    return read(result, variables, n, dt)


def write(path, table):
    with open(path, "w", newline="") as out:
        writer = csv.writer(out)
        writer.writerow(table)
        writer.writerows(zip(*([f"{v:.9g}" for v in column] for column in table.values())))


def read(path, variables, n, dt):
    """The last row of each time: after the events."""
    rows = {}
    with open(path, newline="") as source:
        for row in csv.DictReader(source):
            rows[round(float(row["time"]) / dt)] = row
    if len(rows) < n:
        raise Failed(f"{len(rows)} of {n} rows")
    return {v: [float(rows[k][v]) for k in range(n)] for v in variables}
