#!/usr/bin/env python3
"""Writes the figures of docs/papers from the runs that `./x papers` leaves in out/.

usage: papers.py [--check] [--out DIR]

docs/papers/numbers.csv   every figure by its name, with its unit and the run it comes from
docs/papers/claims.csv    the columns `here` and `deviation` of the claims that name a figure
docs/papers/*.md          blocks between `<!-- made by ./x papers: NAME -->` and `<!-- end -->`, and single figures: `6.77<!--NAME .2f-->`

--check writes nothing and fails where a page does not hold what numbers.csv and claims.csv say.
"""

import bisect
import csv
import io
import json
import math
import os
import re
import statistics
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGES = os.path.join(ROOT, "docs", "papers")

# Torque reserve in % and standard deviation in r/min of table 3, by pressure in MPa.
TABLE_3 = {2: (92, 4.138), 4: (84, 4.517), 6: (76, 5.246), 8: (68, 5.427), 10: (60, 5.899), 13: (48, 6.424), 15: (40, 7.889),
           17: (32, 8.209), 19: (24, 8.723)}
# Standard deviation in r/min of table 4, by speed in r/min.
TABLE_4 = {300: 4.32, 600: 5.77, 900: 8.58, 1200: 8.43, 1500: 10.64, 1800: 11.55, 2100: 10.55, 2400: 10.69, 2700: 11.32, 3000: 10.38}
POINTS = [("9.333", "3"), ("27.74", "3"), ("27.74", "6"), ("33.333", "3")]


# --- recordings ------------------------------------------------------------------------------------------------------


class Run:
    def __init__(self, path):
        with open(path, newline="") as file:
            rows = csv.reader(file)
            names = next(rows)
            columns = list(zip(*([float(x) for x in row] for row in rows)))
        self.columns = dict(zip(names, columns))
        self.times = columns[0]

    def __getitem__(self, name):
        return self.columns[name]

    def at(self, name, time):
        x, y = self.times, self.columns[name]
        i = min(max(bisect.bisect_right(x, time), 1), len(x) - 1)
        return y[i] if x[i] == x[i - 1] else y[i - 1] + (y[i] - y[i - 1]) * (time - x[i - 1]) / (x[i] - x[i - 1])

    def last(self, name):
        return self.columns[name][-1]

    def mean(self, name, start):
        return statistics.fmean(v for t, v in zip(self.times, self.columns[name]) if t >= start)


def line(points):
    """Slope, intercept and R2 of a straight line."""
    x, y = zip(*points)
    slope, intercept = statistics.linear_regression(x, y)
    return slope, intercept, statistics.correlation(x, y) ** 2


# --- figures ---------------------------------------------------------------------------------------------------------


class Numbers:
    def __init__(self):
        self.rows = {}

    def put(self, name, value, unit, source):
        self.rows[name] = (float(f"{value:.6g}") + 0.0, unit, source)

    def __getitem__(self, name):
        return self.rows[name][0]

    def text(self):
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["name", "value", "unit", "from"])
        for name in sorted(self.rows):
            value, unit, source = self.rows[name]
            writer.writerow([name, f"{value:.6g}", unit, source])
        return out.getvalue()


def pump(numbers, out):
    run = lambda name: Run(os.path.join(out, "papers", name + ".csv"))
    for name, options in [("no_load", ""), ("no_load_rigid", " compression=false")]:
        r = run(name)
        slope, _, fit = line([(n, q * 6e7) for n, q in zip(r["N"], r["Q_A"]) if n > 100])
        source = "ServoPump.NoLoad" + options
        numbers.put(name + ".slope", slope, "ml/r", source + ": Q_A over N above 100 r/min")
        numbers.put(name + ".R2", fit, "1", source)
    for name, options in [("dead_zone", ""), ("dead_zone_fast", " ramp=2"), ("dead_zone_slow", " ramp=0.02"),
                          ("dead_zone_rigid", " ramp=0.02 compression=false")]:
        r = run(name)
        dp = [(a - b) / 1e5 for a, b in zip(r["p_A"], r["p_B"])]
        slope, intercept, fit = line([(n, p) for n, p in zip(r["N"], dp) if 50 <= p <= 210])
        source = "ServoPump.DeadZone" + options + ": p_A - p_B over N, 50 to 210 bar"
        numbers.put(name + ".slope", slope, "bar/(r/min)", source)
        numbers.put(name + ".intercept", intercept, "bar", source)
        numbers.put(name + ".R2", fit, "1", source)
    for p in (2, 5, 10, 15, 21):
        r, c = run(f"partition_{p}"), run(f"partition_{p}_compressed")
        source = f"ServoPump.FlowPartition p_load={p}e6: N_d at the end"
        numbers.put(f"dead_{p}", r.last("N_d"), "r/min", source)
        numbers.put(f"dead_{p}.line", (10 * p + 75.1) / 6.95, "r/min", "the paper's line, (dp + 75.1 bar)/6.95")
        numbers.put(f"dead_{p}.compressed", c.last("N_d"), "r/min", source + ", pump.compression=true")
        numbers.put(f"dead_{p}.share_compression", 100 * (1 - r.last("N_d") / c.last("N_d")), "%", "N_d with and without pump.compression")
    # V N_d = sigma N_d + Q_xi + Q_c: what the pump turns through its dead zone for, at 21 MPa
    shear = 100 * 3.178e-8 / 0.8e-6
    numbers.put("dead_21.share_shear", shear, "%", "sigma/V of ServoPump.BenchPump")
    numbers.put("dead_21.share_pressure", 100 - shear - numbers["dead_21.share_compression"], "%", "the rest: leakage by pressure, calibrated")
    r = run("partition_21")
    numbers.put("limit_voltage", r.last("N_U"), "r/min", "ServoPump.FlowPartition p_load=21e6: N_U at the end")
    numbers.put("limit", r.last("N_s"), "r/min", "ServoPump.FlowPartition p_load=21e6: N_s at the end")
    errors = []
    for table, points in [("table_3", [(600, p, std) for p, (_, std) in TABLE_3.items()]),
                          ("table_4", [(n, 10, std) for n, std in TABLE_4.items()])]:
        for n, p, printed in points:
            r = run(f"load_{n}_{p}")
            samples = [r.at("N_meas", 8 - 0.625e-3 * (k + 0.5)) for k in range(3200)]
            key = f"{table}.{p if table == 'table_3' else n}"
            numbers.put(key + ".std", statistics.pstdev(samples), "r/min", f"ServoPump.Load N_set={n} p_load={p}e6: N_meas, last 2 s")
            numbers.put(key + ".printed", printed, "r/min", "the paper")
            errors.append(numbers[key + ".std"] - printed)
            if table == "table_3":
                for name in ("reserve", "reserve_ideal"):
                    numbers.put(f"{key}.{name}", 100 * r.mean(name, 6), "%", f"ServoPump.Load N_set={n} p_load={p}e6: mean of {name}")
                numbers.put(key + ".product", numbers[key + ".std"] * numbers[key + ".reserve_ideal"] / 100, "r/min", "reserve_ideal times deviation")
                numbers.put(key + ".product_printed", printed * TABLE_3[p][0] / 100, "r/min", "the same from the paper's table 3")
    for first, last in [(300, 1500), (1500, 3000)]:
        for what in ("std", "printed"):
            numbers.put(f"table_4.rise_{last}.{what}", numbers[f"table_4.{last}.{what}"] - numbers[f"table_4.{first}.{what}"], "r/min",
                        f"table 4: {what} at {last} less that at {first} r/min")
    numbers.put("tables.rms", math.sqrt(statistics.fmean(e * e for e in errors)), "r/min", "19 values of tables 3 and 4")
    numbers.put("tables.largest", max(abs(e) for e in errors), "r/min", "19 values of tables 3 and 4")
    for pick, name in [(max, "most"), (min, "least")]:
        numbers.put(f"table_3.lost_{name}", pick(numbers[f"table_3.{p}.reserve_ideal"] - numbers[f"table_3.{p}.reserve"] for p in TABLE_3),
                    "%", "reserve_ideal less reserve")
    r = run("friction")
    peak = max((i for i in range(len(r.times)) if r["N"][i] < 200), key=lambda i: r["T_f"][i])
    least = min(range(peak, len(r.times)), key=lambda i: r["T_f"][i])
    numbers.put("friction.peak", r["T_f"][peak], "N.m", "ServoPump.FrictionCurve: greatest T_f below 200 r/min")
    numbers.put("friction.least", r["T_f"][least], "N.m", "ServoPump.FrictionCurve: least T_f behind it")
    numbers.put("friction.least_speed", r["N"][least], "r/min", "ServoPump.FrictionCurve: N there")
    numbers.put("friction.end", r.last("T_f"), "N.m", "ServoPump.FrictionCurve: T_f at 1500 r/min")
    steepest = max((a - b) / ((m - n) * math.pi / 30) for a, b, n, m in zip(r["T_f"], r["T_f"][1:], r["N"], r["N"][1:]) if m > n)
    numbers.put("friction.fall", 100 * steepest / 0.0791, "%", "steepest fall of T_f over the gain of the speed loop, 0.0791 N.m.s/rad")
    for p in (2, 10, 21):
        r = Run(os.path.join(out, f"{p}_MPa.csv"))
        slope, _, _ = line([(n, q * 6e7) for n, q in zip(r["N_set"], r["Q"]) if 300 < n < 2900])
        for n in (100, 3000):
            at = min(range(len(r.times)), key=lambda i: abs(r["N_set"][i] - n))
            numbers.put(f"zones_{p}.eta_{n}", r["Q"][at] / r["Q_ideal"][at], "1", f"ServoPump.FlowZones p_load={p}e6: Q over Q_ideal at {n} r/min")
        numbers.put(f"zones_{p}.slope", slope, "ml/r", f"ServoPump.FlowZones p_load={p}e6: Q over N_set")


def answer(r):
    """Of a step of the load at 20 s: drop of the speed, overshoot of the pressure in % of its step, time until the speed stays within 5 %."""
    p_0, p_1, n_0, n_1 = r.at("p", 19.9), r.last("p"), r.at("n_m", 19.9), r.last("n_m")
    top = max(p for t, p in zip(r.times, r["p"]) if t >= 20)
    late = max(t for t, n in zip(r.times, r["n_m"]) if abs(n - n_1) > 0.05 * (n_0 - n_1))
    return n_0 - n_1, 100 * max(0, (top - p_1) / (p_1 - p_0)), late - 20


def circuit(numbers, out):
    run = lambda name: Run(os.path.join(out, "papers", name + ".csv"))
    put = numbers.put
    for motor in "AB":
        for f, u in POINTS:
            r, key = run(f"steady_{motor}_{f}_{u}"), f"steady.{motor}_{f}_{u}"
            source = f"ClosedCircuit.Reduced motor={motor} f={f} u={u}: at the end"
            for name, unit, scale in [("n_p", "r/min", 1), ("n_m", "r/min", 1), ("p", "MPa", 1e-6), ("T_e", "N.m", 1)]:
                put(f"{key}.{name}", r.last(name) * scale, unit, source)
    for f, wanted in [("11.604404886281275", 280), ("36.64933216233574", 1000)]:
        put(f"pump_{wanted}.f", float(f), "Hz", "frequency at which the pump itself turns so, from the reference")
        put(f"pump_{wanted}.n_p", run("pump_" + f.split(".")[0]).last("n_p"), "r/min", f"ClosedCircuit.Reduced f={f}")
    r = run("case1")
    for name, unit, scale in [("n_p", "r/min", 1), ("n_m", "r/min", 1), ("p", "MPa", 1e-6), ("T_e", "N.m", 1)]:
        put(f"case1.{name}.first", r.at(name, 9.9) * scale, unit, "ClosedCircuit.Case1: before the ramp")
        put(f"case1.{name}.last", r.last(name) * scale, unit, "ClosedCircuit.Case1: at the end")
    put("case1.p.top", max(r["p"]) / 1e6, "MPa", "ClosedCircuit.Case1: greatest p")
    put("case1.synchronous.first", 30 * 9.333, "r/min", "30 times 9.333 Hz, two pole pairs")
    put("case1.synchronous.last", 30 * 33.333, "r/min", "30 times 33.333 Hz, two pole pairs")
    r = run("case2")
    for name, time in [("first", 9.9), ("loaded", 22), ("last", 40)]:
        put(f"case2.n_m.{name}", r.at("n_m", time), "r/min", f"ClosedCircuit.Case2 at {time} s")
        put(f"case2.n_p.{name}", r.at("n_p", time), "r/min", f"ClosedCircuit.Case2 at {time} s")
        put(f"case2.p.{name}", r.at("p", time) / 1e6, "MPa", f"ClosedCircuit.Case2 at {time} s")
    for name, model in [("case3", "Case3"), ("heavy", "StepHeavyLoad"), ("stiff", "StepStiffMotor"), ("vector", "StepVectorControl"),
                        ("vector_lags", "Case3 control=SFVC_reduced"), ("frozen", "StepStiffMotor with frozen air in the line")]:
        for value, what, unit in zip(answer(run(name)), ("drop", "overshoot", "settling"), ("r/min", "%", "s")):
            put(f"{name}.{what}", value, unit, f"ClosedCircuit.{model}")
    r = Run(os.path.join(out, "closed_circuit_motors.csv"))
    synchronous = 30 * 27.74
    for motor in "AB":
        torque = lambda n: r.at("T_" + motor, n / (1.1 * synchronous))
        put(f"stiffness.{motor}", (torque(synchronous - 5) - torque(synchronous + 5)) / (10 * math.pi / 30), "N.m.s/rad",
            "ClosedCircuit.MotorCurves: slope at 832 r/min")
    maps = {p: Run(os.path.join(out, f"map_{p}.csv")) for p in "2 3 4 6 8 10 12.5 15 17.5 20 22.5 25".split()}
    for name in ("eta_v", "eta_m", "eta_v_m", "eta_m_m", "eta", "eta_motor"):
        for pick, word in [(min, "least"), (max, "most")]:
            put(f"map.{name}.{word}", pick(pick(r[name]) for r in maps.values()), "1", f"ClosedCircuit.EfficiencyMap 2 to 25 MPa: {name}")
        for time, word in [(0, "slow"), (1, "fast")]:
            put(f"map_20.{name}.{word}", maps["20"].at(name, time), "1", f"ClosedCircuit.EfficiencyMap at 20 MPa: {name}")
    best = max(((r["eta"][i], r["N"][i], float(p)) for p, r in maps.items() for i in range(len(r.times))))
    put("map.best.N", best[1], "r/min", "speed at which eta is greatest")
    put("map.best.p", best[2], "MPa", "pressure at which eta is greatest")
    for share in ("slipper", "piston", "plate", "rest", "compression"):
        for time, word in [(0, "slow"), (1, "fast")]:
            put(f"share.{share}.{word}", 100 * maps["20"].at("share_" + share, time), "%", "ClosedCircuit.EfficiencyMap at 20 MPa")
    for f, u in POINTS:
        r = run(f"bench_{f}_{u}")
        for name, scale in [("n_p", 1), ("n_m", 1), ("p", 1e-6)]:
            put(f"bench_{f}_{u}.{name}", 100 * (r.last(name) * scale / numbers[f"steady.A_{f}_{u}.{name}"] - 1), "%", f"ClosedCircuit.Bench f={f} u={u} against Reduced")
    for cause in ("LoadPump", "ChargePump", "MotorCompression", "LowSide"):
        for u in "36":
            r = run(f"{cause}_{u}")
            for name, scale in [("n_p", 1), ("n_m", 1), ("p", 1e-6)]:
                put(f"cause.{cause}_{u}.{name}", 100 * (r.last(name) * scale / numbers[f"steady.A_27.74_{u}.{name}"] - 1), "%", f"ClosedCircuit.Reduced with {cause}, u={u}")
    for n in (150, 694, 900):
        for scheduled in ("true", "false"):
            key, r = f"control_{n}_{scheduled}", run(f"control_{n}_{scheduled}")
            source = f"ClosedCircuit.SpeedControl n_start={n} scheduled={scheduled}"
            drop = n - min(r["n_m"])
            put(key + ".drop", drop, "r/min", source)
            put(key + ".back", max(t for t, v in zip(r.times, r["n_m"]) if abs(v - n) > 0.05 * drop) - 20, "s", source)
            r = run(f"reference_{n}_{scheduled}")
            put(key + ".overshoot", 100 * (max(r["n_m"]) - n - 20) / 20, "%", source + ", reference by 20 r/min")
            put(key + ".rise", min(t for t, v in zip(r.times, r["n_m"]) if v >= n + 18) - 10, "s", source + ", reference by 20 r/min")
    r = run("warm_up")
    for name, column in [("suction", "reservoir.T_oil[3]"), ("pump", "pump.T_case"), ("motor", "hydraulicMotor.T_case")]:
        put("warm_up." + name, r.at(column, 3600) - 273.15, "degC", f"ClosedCircuit.WarmUp after 1 h: {column}")
    put("warm_up.share_valve", 100 * r.at("loadCooler.Q_flow", 3600) / r.at("P_room", 3600), "%", "ClosedCircuit.WarmUp after 1 h: radiator behind the load valve over P_room")
    put("warm_up.n_m", r.at("n_m", 3600), "r/min", "ClosedCircuit.WarmUp after 1 h")
    put("warm_up.n_m.cold", run("bench_27.74_3").last("n_m"), "r/min", "ClosedCircuit.Bench")
    for case, nonlinear, shift in [(1, run("case1"), 40), (2, run("case2"), 40), (3, run("case3"), 40)]:
        for form in ("Long", "Short"):
            r = run(f"{form}_{case}")
            begin = 10 if case < 3 else 20
            times = [begin + 0.01 * k for k in range(int((nonlinear.times[-1] - begin) / 0.01))]
            for name, state, scale, offset in [("n_m", "x_5", 30 / math.pi, 0), ("n_p", "x_2", 30 / math.pi, 0), ("p", "x_3", 1e-6, 2)]:
                unit = "MPa" if name == "p" else "r/min"
                of = 1e-6 if name == "p" else 1
                errors = [r.at(state, t + shift) * scale - offset - nonlinear.at(name, t) * of for t in times]
                source = f"out/papers/{form}.mo against ClosedCircuit.Case{case}"
                put(f"form.{form}_{case}.{name}.most", max(map(abs, errors)), unit, source)
                put(f"form.{form}_{case}.{name}.rms", math.sqrt(statistics.fmean(e * e for e in errors)), unit, source)
                put(f"form.{case}.{name}.span", (max(nonlinear[name]) - min(nonlinear[name])) * of, unit, f"ClosedCircuit.Case{case}: range")
    with open(os.path.join(out, "papers", "three.txt")) as file:
        exact = re.search(r"meets the rates to (\S+)", file.read())
    put("form.three_inputs", float(exact.group(1)) if exact else math.nan, "1", "bramah linearize ClosedCircuit.Reduced --inputs f,u,p_low")
    found(numbers, out)


def found(numbers, out):
    """Parameters found from made recordings, beside those that made them."""
    folder = os.path.join(out, "clearances")
    with open(os.path.join(folder, "truth.csv"), newline="") as file:
        truth = {row["name"]: float(row["value"]) for row in csv.DictReader(file)}
    for place, name in [("pump", "clearances"), ("motor", "motor_clearances"), ("load", "load_polynomial"), ("valve", "load_pump")]:
        with open(os.path.join(folder, place, name + ".json")) as file:
            result = json.load(file)
        study = f"models/ClosedCircuit/{'load_polynomial' if place in ('load', 'valve') else name}.toml"
        for parameter, value in result["parameters"].items():
            gap = ".h_" in parameter
            scale, unit = (1e6, "um") if gap else (1, value["unit"])
            key = f"found.{place}.{parameter.split('.')[1]}"
            numbers.put(key, value["value"] * scale, unit, study)
            numbers.put(key + ".std", value["std"] * scale, unit, study)
            if place != "valve":
                numbers.put(key + ".truth", truth[parameter] * scale, unit, "out/clearances/truth.csv")
                numbers.put(key + ".error", 100 * (value["value"] / truth[parameter] - 1), "%", study)
        for signal, rms in result["fit"]["held"].items():
            numbers.put(f"found.{place}.{signal}.held", rms, {"T": "N.m", "Q_case": "m3/s"}.get(signal, "1"), study)
    with open(os.path.join(folder, "pump", "volumetric.json")) as file:
        result = json.load(file)
    numbers.put("found.volumetric.groups", len(result["inseparable"]), "1", "models/ClosedCircuit/volumetric.toml: groups that cannot be told apart")


# --- tables ----------------------------------------------------------------------------------------------------------


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"


def blocks(n, claims):
    signed = lambda key: plain(f"{n[key]:+.1f}")
    made = {}
    for paper, name in [("1", "claims of paper 1"), ("2", "claims of paper 2")]:
        rows = [(c["item"], c["page"], c["claim"], quantity(c["quoted"], c["unit"]), quantity(c["here"], c["unit"]),
                 c["deviation"], c["status"]) for c in claims if c["paper"] == paper]
        made[name] = table(["", "section", "the paper says", "its figure", "here", "deviation", ""], rows)
    made["dead zone"] = table(
        ["dp MPa", "the paper's line, r/min", "calibrated pump, r/min", "and compression on top, r/min", "compression, % of it"],
        [(p, f"{n[f'dead_{p}.line']:.1f}", f"{n[f'dead_{p}']:.1f}", f"{n[f'dead_{p}.compressed']:.1f}", f"{n[f'dead_{p}.share_compression']:.1f}")
         for p in (2, 5, 10, 15, 21)])
    made["dead zone lines"] = table(
        ["run", "slope bar/(r/min)", "intercept bar"],
        [("the paper", "6.95", "-75.1")] + [(text, f"{n[key + '.slope']:.2f}", f"{n[key + '.intercept']:.1f}") for text, key in [
            ("0.5 r/min per s", "dead_zone"), ("2 r/min per s", "dead_zone_fast"), ("0.02 r/min per s", "dead_zone_slow"),
            ("0.02 r/min per s, without compression in the chambers", "dead_zone_rigid")]])
    made["table 3"] = table(
        ["p MPa", "reserve %, paper", "here, ideal torque", "here, with losses", "deviation r/min, paper", "here", "reserve times deviation, paper", "here"],
        [(p, TABLE_3[p][0], f"{n[f'table_3.{p}.reserve_ideal']:.0f}", f"{n[f'table_3.{p}.reserve']:.0f}", f"{TABLE_3[p][1]:.2f}",
          f"{n[f'table_3.{p}.std']:.2f}", f"{n[f'table_3.{p}.product_printed']:.2f}", f"{n[f'table_3.{p}.product']:.2f}") for p in TABLE_3])
    made["table 4"] = table(
        ["r/min", "paper, r/min", "here, r/min", "here less paper"],
        [(v, f"{TABLE_4[v]:.2f}", f"{n[f'table_4.{v}.std']:.2f}", f"{n[f'table_4.{v}.std'] - TABLE_4[v]:+.2f}") for v in TABLE_4])
    made["steady points"] = table(
        ["motor, f, u", "n_p r/min", "n_m r/min", "p MPa", "T_e Nm"],
        [(f"{motor}, {f} Hz, {u} V", *(f"{n[f'steady.{motor}_{f}_{u}.{name}']:{form}}" for name, form in
                                       [("n_p", ".1f"), ("n_m", ".1f"), ("p", ".3f"), ("T_e", ".1f")])) for motor in "AB" for f, u in POINTS])
    made["steps"] = table(
        ["step 3 to 6 V at 27.74 Hz", "drop of speed r/min", "overshoot of pressure %", "settling of speed (5 %) s"],
        [(text, f"{n[key + '.drop']:.1f}", f"{n[key + '.overshoot']:.1f}", f"{n[key + '.settling']:.2f}") for text, key in [
            ("motor A, 2 kg m2", "case3"), ("motor A, 4 kg m2", "heavy"), ("motor B, 2 kg m2", "stiff"),
            ("motor B, air of the line frozen", "frozen"), ("vector control, 2 kg m2", "vector"),
            ("the same, drive reduced to lags", "vector_lags")]])
    pair = lambda key: ", ".join(f"{float(f'{n[key + what]:.2g}'):g}" for what in (".most", ".rms"))
    made["quasi-linear form"] = table(
        ["case", "vector", "hydraulic motor r/min", "of", "pump r/min", "of", "pressure MPa", "of"],
        [(case, form.lower(), *(cell for name in ("n_m", "n_p", "p") for cell in
                                (pair(f"form.{form}_{case}.{name}"), f"{n[f'form.{case}.{name}.span']:.3g}")))
         for case in (1, 2, 3) for form in ("Long", "Short")])
    made["speed control"] = table(
        ["at, gains", "drop of speed r/min", "back within 5 % of it s", "step of the reference: overshoot %", "90 % after s"],
        [(f"{v} r/min, {'by the speed' if s == 'true' else 'of 694 r/min'}", *(f"{n[f'control_{v}_{s}.{what}']:{form}}" for what, form in
                                                                             [("drop", ".1f"), ("back", ".2f"), ("overshoot", ".1f"), ("rise", ".2f")]))
         for s in ("true", "false") for v in (150, 694, 900)])
    made["losses"] = table(
        ["r/min", "slippers %", "pistons %", "valve plate %", "bearings, churning %", "compression %"],
        [(v, *(f"{n[f'share.{s}.{word}']:.0f}" for s in ("slipper", "piston", "plate", "rest", "compression"))) for v, word in [(280, "slow"), (1500, "fast")]])
    made["bench"] = table(["f, u", "n_p %", "n_m %", "p %"],
                          [(f"{f} Hz, {u} V", *(signed(f"bench_{f}_{u}.{name}") for name in ("n_p", "n_m", "p"))) for f, u in POINTS])
    made["causes"] = table(
        ["cause", "n_p %", "n_m %", "p %, at 3 V", "p %, at 6 V"],
        [(text, signed(f"cause.{key}_3.n_p"), signed(f"cause.{key}_3.n_m"), signed(f"cause.{key}_3.p"), signed(f"cause.{key}_6.p")) for text, key in [
            ("a pump against a relief valve as load", "LoadPump"), ("the charge pump on the motor's shaft", "ChargePump"),
            ("the hydraulic motor too loses compressed oil", "MotorCompression"), ("the low side at 2.05 MPa", "LowSide")]])
    words = {"h_s": "gap under the slippers um", "h_p": "gap around the pistons um", "h_v": "gap at the valve plate um",
             "w_p": "share of fluid friction, pistons", "w_v": "share of fluid friction, valve plate"}
    start = {"h_s": "20", "h_p": "24", "h_v": "19", "w_p": "0.70", "w_v": "0.75"}
    for place in ("pump", "motor"):
        made[f"found of the {place}"] = table(
            ["", "start value", "truth", "found", "error %"],
            [(text, start[p], f"{n[f'found.{place}.{p}.truth']:g}", f"{n[f'found.{place}.{p}']:.3g} +- {n[f'found.{place}.{p}.std']:.1g}",
              signed(f"found.{place}.{p}.error")) for p, text in words.items()])
    units = {"a_0": ("Nm", "8"), "a_1": ("Nm/V", "20"), "a_2": ("Nm/(r/min)", "0.03"), "a_3": ("Nm/V/(r/min)", "0.006")}
    made["load polynomial"] = table(
        ["", "start value", "truth", "found", "error %", "pump and valve of the bench"],
        [(f"{p} {unit}", first, f"{n[f'found.load.{p}.truth']:g}", f"{n[f'found.load.{p}']:.3g} +- {n[f'found.load.{p}.std']:.1g}",
          signed(f"found.load.{p}.error"), f"{n[f'found.valve.{p}']:.3g}") for p, (unit, first) in units.items()])
    return made


def plain(text):
    """Without the sign of a zero."""
    return text[1:] if re.fullmatch(r"[-+]0(\.0*)?", text) else text


def quantity(text, unit):
    """A figure with its unit behind it, where it is a bare number."""
    bare = re.fullmatch(r"[-+]?[\d.]+(e-?\d+)?", text)
    return f"{text} {unit}" if bare and unit not in ("", "1") else text


# --- files -----------------------------------------------------------------------------------------------------------


def judged(claims, n):
    """Fills `here` and `deviation` of the claims that name a figure in `key`, as `name` or `name .2f`."""
    for claim in claims:
        if not claim["key"]:
            continue
        name, _, form = claim["key"].partition(" ")
        value = n[name]
        claim["here"] = plain(f"{value:{form or '.4g'}}")
        claim["deviation"] = ""
        if re.fullmatch(r"[-+]?[\d.]+(e-?\d+)?", claim["quoted"]) and float(claim["quoted"]):
            quoted = float(claim["quoted"])
            share = 100 * (value / quoted - 1)
            claim["deviation"] = plain(f"{share:+.1f}") + " %" if abs(share) < 100 else f"{value - quoted:+.2f}"
    return claims


def rewritten(page, made, n):
    def block(match):
        if match.group(1) not in made:
            sys.exit(f"error: no block is called `{match.group(1)}`")
        return f"<!-- made by ./x papers: {match.group(1)} -->\n\n{made[match.group(1)]}\n<!-- end -->"

    page = re.sub(r"<!-- made by \./x papers: ([^>]+?) -->.*?<!-- end -->", block, page, flags=re.S)
    return re.sub(r"[-+]?[\d.]+(?:e-?\d+)?<!--([\w.]+) (\.\d\w)-->", lambda m: f"{n[m.group(1)]:{m.group(2)}}<!--{m.group(1)} {m.group(2)}-->", page)


def main():
    arguments = sys.argv[1:]
    check = "--check" in arguments
    out = arguments[arguments.index("--out") + 1] if "--out" in arguments else os.path.join(ROOT, "out")
    numbers = Numbers()
    path = os.path.join(PAGES, "numbers.csv")
    if check:
        with open(path, newline="") as file:
            for row in csv.DictReader(file):
                numbers.put(row["name"], float(row["value"]), row["unit"], row["from"])
    else:
        pump(numbers, out)
        circuit(numbers, out)
    files = {} if check else {path: numbers.text()}
    path = os.path.join(PAGES, "claims.csv")
    with open(path, newline="") as file:
        claims = judged(list(csv.DictReader(file)), numbers)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(claims[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(claims)
    files[path] = text.getvalue()
    made = blocks(numbers, claims)
    for name in ("servo_pump.md", "closed_circuit.md"):
        path = os.path.join(PAGES, name)
        with open(path) as file:
            files[path] = rewritten(file.read(), made, numbers)
    wrong = []
    for path, text in files.items():
        if check:
            with open(path, newline="") as file:
                if file.read() != text:
                    wrong.append(os.path.relpath(path, ROOT))
        else:
            with open(path, "w") as file:
                file.write(text)
    if wrong:
        sys.exit(f"error: {', '.join(wrong)} hold other figures than docs/papers/numbers.csv; `./x papers` writes them")


if __name__ == "__main__":
    main()
