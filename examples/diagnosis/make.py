#!/usr/bin/env python3
"""Makes the recordings of this example by simulation.

The plant is the model of Loop.mo with a leak that Loop.mo does not have and with parameters a little off their data
sheet. Its text is written to a temporary folder and deleted afterwards, so that the diagnosis cannot read it. What was
drawn is written to truth.toml.
"""

import argparse
import csv
import math
import random
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent

STEP = 0.05  # s between samples
LENGTH = 24.0  # s of a recording
SETTLE = 5.0  # s that run before a recording begins: a bench does not start at the model's start values

# Parameter: data sheet value and one standard deviation as part of it. The same deviations stand in gap.toml.
PARAMETERS = {
    "J_L": (2, 0.05), "p_low": (2e6, 0.03), "V_line": (1.5e-3, 0.08), "bearing_1.d": (0.02, 0.2),
    "shaft_1.J": (0.37, 0.03), "electricMotor.R_r": (0.40, 0.05), "load.a_0": (8, 0.1), "load.a_1": (20, 0.03),
    "load.a_2": (0.03, 0.1), "load.B": (0.1, 0.15),
}

# Variable of the model, column of the recording, the column's unit in the variable's, range of the sensor in the column's unit.
SENSORS = [
    ("n_p", "n_pump", 1, 1500), ("n_m", "n_motor", 1, 1500), ("p", "p_high", 1e5, 200), ("T_e", "T_drive", 1, 300),
]
UNITS = {
    "time": "s", "n_pump": "rev/min", "n_motor": "rev/min", "p_high": "bar", "T_drive": "N.m", "f_ref": "Hz", "u_load": "V",
}

DELIVERY = 69.8e-6 * 15  # m3/s of the pump at 900 rev/min
P_REF = 1e7  # Pa at which the size of the leak is given

# The leak is a short rough gap: pressure falls partly by viscosity (a*q), mostly at the edges (b*q^2), one after the
# other. Bramah's effect library has leaks that are laminar, turbulent or growing, none of this form. The 1 kPa under
# the root only keeps the derivative finite at dp = 0.
PLANT = """
model RoughGap "Viscous and turbulent pressure loss in series: dp = a*q + b*q^2"
  Interfaces.HydraulicPort port_a;
  Interfaces.HydraulicPort port_b;
  parameter Real q_ref(unit = "m3/s") = 5e-5 "Flow at 10 MPa";
  parameter Real s = 0.9 "Turbulent part of the pressure loss at 10 MPa";
  parameter Real a = (1 - s)*1e7/q_ref;
  parameter Real b = s*1e7/q_ref^2;
  Real dp(nominal = 1e7);
equation
  dp = port_a.p - port_b.p;
  port_a.q = 2*dp/(a + sqrt(a^2 + 4*b*sqrt(dp^2 + 1e3^2)));
  port_a.q + port_b.q = 0;
end RoughGap;

model Plant
  extends Loop;
  RoughGap leak;
equation
  connect(highSide.port, leak.port_a);
  connect(leak.port_b, lowSide.port);
end Plant;

"""


def clipped(rng):
    """A deviation in standard deviations, at most two."""
    while abs(x := rng.gauss(0, 1)) > 2:
        pass
    return x


def steps(rng, n, low, high):
    """Random levels, each held for 1.5 to 5 s."""
    trajectory = []
    while len(trajectory) < n:
        trajectory += [rng.uniform(low, high)] * round(rng.uniform(1.5, 5) / STEP)
    return trajectory[:n]


def sweep(rng, n, low, high):
    """Sine that becomes faster, from a period of 15 s to one of 2 s."""
    slow, rise, start = 1 / 15, math.log(7.5) / (n * STEP), rng.uniform(0, 2 * math.pi)
    angle = lambda t: start + 2 * math.pi * slow * (math.exp(rise * t) - 1) / rise
    return [0.5 * (low + high) + 0.45 * (high - low) * math.sin(angle(k * STEP)) for k in range(n)]


def stairs(rng, n, low, high):
    """Up and down in equal stages."""
    up = [low + (high - low) * k / 4 for k in range(5)]
    stages = up + up[-2:0:-1]
    turn = rng.randrange(len(stages))
    return [stages[(turn + int(10 * k / n)) % len(stages)] for k in range(n)]


def limited(trajectory, slew):
    """The trajectory at a limited rate, as inverter and load accept it, rounded as it is recorded."""
    out = [trajectory[0]]
    for v in trajectory[1:]:
        out.append(out[-1] + min(max(v - out[-1], -slew * STEP), slew * STEP))
    return [float(f"{v:.5g}") for v in out]


# The held recording has other trajectories than the train ones: a model that only copies them fails there.
TRAJECTORIES = {"train_1": (steps, steps), "train_2": (sweep, steps), "held_1": (stairs, sweep)}


def simulate(bramah, folder, commands, sets):
    """Runs the plant; values of the sensors' variables at each sample."""
    source, result = Path(folder, "in.csv"), Path(folder, "out.csv")
    n = len(commands["f_ref"])
    write(source, {"time": [k * STEP for k in range(n)], **commands}, "{:.9g}")
    command = [
        bramah, "simulate", str(Path(folder, "plant.mo")), "--model", "Plant", "--input", str(source),
        "--stop-time", f"{(n - 1) * STEP:.9g}", "--output-interval", f"{STEP:g}", "--relative-tolerance", "1e-8",
        "--variables", ",".join(s[0] for s in SENSORS), "--output-file", str(result),
    ]
    for name, value in sets.items():
        command += ["--set", f"{name}={value:.12g}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    # Where a command steps there are two rows of one time; the last one is after the step.
    with open(result, newline="") as file:
        rows = {round(float(row["time"]) / STEP): row for row in csv.DictReader(file)}
    return {s[0]: [float(rows[k][s[0]]) for k in range(n)] for s in SENSORS}


def write(path, table, form="{:.5g}"):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table)
        writer.writerows([form.format(v) for v in row] for row in zip(*table.values()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bramah", help="the command, such as target/release/bramah")
    parser.add_argument("out", nargs="?", default=HERE, type=Path)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = random.Random(options.seed)

    part, turbulent = rng.uniform(0.03, 0.06), rng.uniform(0.8, 0.95)
    q_ref = part * DELIVERY
    drawn = {name: clipped(rng) for name in PARAMETERS}
    values = {name: v * math.exp(drawn[name] * sigma) for name, (v, sigma) in PARAMETERS.items()}
    noise = {column: rng.uniform(0.002, 0.005) * full for _, column, _, full in SENSORS}
    quantum = {column: full / 4096 for _, column, _, full in SENSORS}  # 12 bits

    options.out.mkdir(parents=True, exist_ok=True)
    n, skip = round((SETTLE + LENGTH) / STEP) + 1, round(SETTLE / STEP)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "plant.mo").write_text(PLANT + (HERE / "Loop.mo").read_text())
        for name, (drive, load) in TRAJECTORIES.items():
            commands = {
                "f_ref": limited(drive(rng, n, 20, 40), 4), "u_load": limited(load(rng, n, 0.8, 3.8), 3),
            }
            found = simulate(options.bramah, folder, commands, {**values, "leak.q_ref": q_ref, "leak.s": turbulent})
            table = {"time": [k * STEP for k in range(n - skip)]}
            table |= {c: v[skip:] for c, v in commands.items()}
            for variable, column, unit, _ in SENSORS:
                d = quantum[column]
                noisy = [v / unit + rng.gauss(0, noise[column]) for v in found[variable][skip:]]
                table[column] = [d * round(v / d) for v in noisy]
            write(options.out / f"{name}.csv", {f"{c} [{UNITS[c]}]": v for c, v in table.items()})

    lines = ["# What the plant of the recordings is. No command of bramah reads this file.", f"seed = {options.seed}", "",
             "[effect]", 'name = "leak from the high side to the low side, mostly turbulent"',
             'family = "external_leak"', 'place = "highSide.port"', 'law = "dp = a*q + b*q^2"',
             f"flow_at_100_bar_l_per_min = {6e4 * q_ref:.4g}", f"part_of_delivery_at_900_rev_per_min = {part:.4g}",
             f"turbulent_part_of_dp_at_100_bar = {turbulent:.4g}", f"a_Pa_s_per_m3 = {(1 - turbulent) * P_REF / q_ref:.5g}",
             f"b_Pa_s2_per_m6 = {turbulent * P_REF / q_ref**2:.5g}", "", "[parameters]",
             "# Value in SI units, and how many standard deviations it lies off the data sheet."]
    lines += [f'"{k}" = {{ value = {values[k]:.6g}, deviation = {drawn[k]:.3f} }}' for k in PARAMETERS]
    lines += ["", "[sensors]", "# One standard deviation of the noise and the step of the digits, in the column's unit."]
    lines += [f"{c} = {{ noise = {noise[c]:.4g}, step = {quantum[c]:.4g} }}" for c in noise]
    (options.out / "truth.toml").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
