"""What every bench has: coloured disturbances, sensor noise, quantisation; and what sensors and commands do wrong."""

import math

FINE = 4
# Disturbances of plants, and of plants that lack nothing: these may also wander off.
KINDS = ("filtered", "filtered", "narrow", "jumps", "none")
NULL_KINDS = ("filtered", "narrow", "jumps", "drift", "none")


def disturbance(rng, n, dt, scale, slow, kinds):
    """A disturbance of random kind, level and bandwidth; `slow` is a usual time of the circuit."""
    level = scale * math.exp(rng.uniform(math.log(1e-3), math.log(1.2e-2)))
    kind = rng.choice(kinds)
    T = slow * math.exp(rng.uniform(math.log(0.02), math.log(2)))
    if kind == "none":
        return [0.0] * n
    if kind == "jumps":
        values, value = [], 0.0
        for _ in range(n):
            if rng.random() < dt / T:
                value = rng.gauss(0, 1)
            values.append(value)
        return smooth([level * v for v in values], dt, 0.05 * T)
    if kind == "drift":
        return scaled(walk(rng, n), level)
    if kind == "narrow":
        return scaled(oscillation(rng, n, dt, 2 * math.pi / T), level)
    a = math.exp(-dt / T)
    values, value = [], rng.gauss(0, 1)
    for _ in range(n):
        value = a * value + math.sqrt(1 - a * a) * rng.gauss(0, 1)
        values.append(level * value)
    return smooth(values, dt, 0.1 * T)


def oscillation(rng, n, dt, omega):
    """Noise through a lightly damped resonance."""
    omega = min(omega, 0.8 / dt)
    r = math.exp(-0.1 * omega * dt)
    c = 2 * r * math.cos(omega * dt)
    y, z, out = 0.0, 0.0, []
    for _ in range(n + 500):
        y, z = c * y - r * r * z + rng.gauss(0, 1), y
        out.append(y)
    return out[500:]


def walk(rng, n):
    """A random walk from zero."""
    values = [0.0]
    for _ in range(n - 1):
        values.append(values[-1] + rng.gauss(0, 1))
    return values


def smooth(values, dt, T):
    a, out, value = math.exp(-dt / max(T, 1e-9)), [], values[0]
    for v in values:
        value = a * value + (1 - a) * v
        out.append(value)
    return out


def scaled(values, level):
    rms = math.sqrt(sum(v * v for v in values) / len(values))
    return [v * level / rms for v in values]


def hum(rng, n, dt, slow):
    """What several sensors pick up alike, of size 1."""
    omega = 2 * math.pi / (slow * math.exp(rng.uniform(math.log(0.02), math.log(2))))
    return scaled(oscillation(rng, n, dt, omega), 1.0)


def noisy(rng, values, sigma, step):
    """White noise, then quantisation."""
    return [step * round((v + rng.gauss(0, sigma)) / step) for v in values]


# --- sensors: values over time, size as part of the range ---------------------------------------------------------


def offset(values, dt, size, span, rng):
    return [v + size * span for v in values]


def gain(values, dt, size, span, rng):
    """A scale that is wrong by a little more for one sign."""
    return [v * (1 + size * (1.08 if v > 0 else 0.92)) for v in values]


def delay(values, dt, size, span, rng):
    """By `size` samples, between them by cubic interpolation."""
    return [between(values, k - size) for k in range(len(values))]


def lag(values, dt, size, span, rng):
    """First order, of `size` samples, for straight lines between samples."""
    a, out, y = math.exp(-1 / size), [], values[0]
    for before, now in zip([values[0]] + values, values):
        slope = now - before
        y = now - slope * size + (y - before + slope * size) * a
        out.append(y)
    return out


def drift(values, dt, size, span, rng):
    """The zero wanders off, fast at first."""
    end = len(values)
    return [v + size * span * (k / end) ** 0.8 for k, v in enumerate(values)]


def saturation(values, dt, size, span, rng):
    """Hard ends at a part of the range that is used."""
    return [min(max(v, -size * span), size * span) for v in values]


def rectification(values, dt, size, span, rng):
    return [abs(v) for v in values]


def between(values, at):
    """Cubic interpolation; beyond the ends the nearest value."""
    k = math.floor(at)
    f = at - k
    get = lambda j: values[min(max(j, 0), len(values) - 1)]
    a, b, c, d = get(k - 1), get(k), get(k + 1), get(k + 2)
    return b + 0.5 * f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)))


# --- commands: samples as they act, from samples as they are recorded ---------------------------------------------


def command_gain(values, dt, size, reach):
    return [v * (1 + size * (1.1 if v > 0 else 0.9)) for v in values]


def command_dead_zone(values, dt, size, reach):
    """Nothing below a part of the largest command, on one side a little earlier."""
    d = size * reach
    return [v - d if v > d else v + 0.9 * d if v < -0.9 * d else 0.0 for v in values]


def command_saturation(values, dt, size, reach):
    m = size * reach
    return [min(max(v, -0.95 * m), m) for v in values]


def command_dead_time(values, dt, size, reach):
    k = max(1, round(size))
    return [values[0]] * k + values[: len(values) - k]


def command_lag(values, dt, size, reach):
    """First order, of `size` samples, for held samples; the mean over each quarter of a sample acts: four values for one."""
    size *= FINE
    a, out, y = math.exp(-1 / size), [], values[0]
    for v in values:
        for _ in range(FINE):
            out.append(v + (y - v) * size * (1 - a))
            y = v + (y - v) * a
    return out


def finer(values, held):
    """Four values for one, held or on straight lines."""
    if held:
        return [v for v in values for _ in range(FINE)]
    pairs = zip(values, values[1:] + values[-1:])
    return [a + (b - a) * k / FINE for a, b in pairs for k in range(FINE)]
