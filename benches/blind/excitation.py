"""Trajectories of commands: steps, triangles, chirps, staircases, sums of sines, rest."""

import math


def steps(rng, n, dt, dwell, low, high):
    """Random levels, each held for a random time around `dwell`."""
    trajectory, level = [], 0.5 * (low + high)
    left = int(0.3 * dwell / dt)
    for _ in range(n):
        if left <= 0:
            level = rng.uniform(low, high)
            left = max(2, int(rng.expovariate(1) * dwell / dt) + int(0.3 * dwell / dt))
        trajectory.append(level)
        left -= 1
    return trajectory


def triangle(rng, n, dt, period, low, high):
    """Slow triangle through the middle."""
    period *= rng.uniform(0.7, 1.5)
    start = rng.random()
    middle, half = 0.5 * (low + high), 0.5 * (high - low) * rng.uniform(0.5, 1)

    def wave(t):
        phase = (t / period + 0.25 * round(4 * start)) % 1
        return 4 * phase if phase < 0.25 else 2 - 4 * phase if phase < 0.75 else 4 * phase - 4

    return [middle + half * wave(k * dt) for k in range(n)]


def chirp(rng, n, dt, slowest, fastest, low, high):
    """Sine whose frequency rises from 1/`slowest` to 1/`fastest`."""
    f_0, f_1, end = 1 / slowest, 1 / fastest, n * dt
    middle, half = 0.5 * (low + high), 0.5 * (high - low) * rng.uniform(0.4, 1)
    rise = math.log(f_1 / f_0)
    angle = lambda t: 2 * math.pi * f_0 * end / rise * (math.exp(rise * t / end) - 1)
    return [middle + half * math.sin(angle(k * dt)) for k in range(n)]


def staircase(rng, n, dt, stages, low, high):
    """Up and down in equal stages."""
    stages = max(3, round(stages * rng.uniform(0.7, 1.3)))
    heights = [low + (high - low) * k / (stages - 1) for k in range(stages)]
    heights = (heights + heights[-2:0:-1])[rng.randrange(stages) :] + heights
    return [heights[min(len(heights) - 1, int(k * 2 * stages / n))] for k in range(n)]


def sines(rng, n, dt, slowest, fastest, low, high):
    """Sum of five sines of random frequency."""
    waves = [
        (math.exp(rng.uniform(math.log(1 / slowest), math.log(1 / fastest))), rng.uniform(0, 2 * math.pi), rng.uniform(0.3, 1))
        for _ in range(5)
    ]
    size = 0.5 * (high - low) / sum(a for _, _, a in waves) * 1.5
    middle = 0.5 * (low + high)
    value = lambda t: middle + size * sum(a * math.sin(2 * math.pi * f * t + p) for f, p, a in waves)
    return [min(max(value(k * dt), low), high) for k in range(n)]


def mixed(low, high, dwell, slew=None, quiet=0.15):
    """A trajectory of changing kind: train and held recordings get different kinds.

    `dwell` is the time that the circuit needs to follow; `slew` limits the rate; now and then a part rests (`quiet`).
    """

    def trajectory(rng, n, dt, role):
        kinds = ["steps", "triangle", "chirp"] if role.startswith("train") else ["staircase", "sines"]
        kind = kinds[(int(role[-1]) - 1) % len(kinds)]
        if rng.random() < 0.2:
            kind = rng.choice(["steps", "sines", "triangle"])
        values = {
            "steps": lambda: steps(rng, n, dt, dwell, low, high),
            "triangle": lambda: triangle(rng, n, dt, 6 * dwell, low, high),
            "chirp": lambda: chirp(rng, n, dt, 5 * dwell, 0.3 * dwell, low, high),
            "staircase": lambda: staircase(rng, n, dt, n * dt / dwell / 2.5, low, high),
            "sines": lambda: sines(rng, n, dt, 5 * dwell, 0.4 * dwell, low, high),
        }[kind]()
        if rng.random() < quiet:
            begin = int(rng.uniform(0.5, 0.8) * n)
            values[begin:] = [values[begin]] * (n - begin)
        return limited(values, dt, slew) if slew else values

    return trajectory


def limited(values, dt, slew):
    """The trajectory with a limited rate."""
    out = [values[0]]
    for v in values[1:]:
        out.append(out[-1] + min(max(v - out[-1], -slew * dt), slew * dt))
    return out


def level(low, high, wander=0.0):
    """A value that differs from recording to recording and wanders slowly by `wander`."""

    def trajectory(rng, n, dt, role):
        start, end = rng.uniform(low, high), rng.uniform(-wander, wander)
        return [start + end * k / n for k in range(n)]

    return trajectory
