"""The safety filter of (state, wish), region_maps/problems/safety/double_integrator.yaml, flown in the benchmark's scenario."""

import ctypes
import os
import random

import embedded_program as benchmark

WISH_LIMIT = 2.0  # the input's, to which a wish is limited before the look-up; it changes no answer [m/s^2]
NOISE = 0.01  # of both states in a step [m], [m/s]
PARAMETERS = 3
SAMPLES = 20000
NEARBY = 1000  # samples about each of the worst inputs
REFINED = 5  # inputs about which samples are taken
SPREAD = 0.02  # of those, in parts of each range
RANGES = (benchmark.STATE_LIMIT, benchmark.STATE_LIMIT, WISH_LIMIT)


def compiled(place, real):
    """The compiled look-up as a function of theta: u, or None where it has no answer."""
    library = ctypes.CDLL(os.path.join(os.path.abspath(place), "filter.so"))
    number = {"double": ctypes.c_double, "float": ctypes.c_float}[real]

    def evaluate(theta):
        u = number(0)
        return u.value if library.filter_evaluate((number * PARAMETERS)(*theta), ctypes.byref(u)) == 0 else None

    return evaluate


def fly(evaluate, noise_seed=None):
    """Rows (theta, u, wish, whether there is an answer), and the last state. From rest at 0, with the benchmark's PD law as the wish."""
    noise = random.Random(noise_seed)
    x = v = 0.0
    rows = []
    for t in range(benchmark.STEPS):
        wish = benchmark.wish_at(x, v, t)
        theta = (x, v, max(-WISH_LIMIT, min(WISH_LIMIT, wish)))
        u = evaluate(theta)
        rows.append((theta, 0.0 if u is None else u, wish, u is not None))
        x, v = benchmark.advance(x, v, rows[-1][1])
        if noise_seed is not None:
            x += noise.uniform(-NOISE, NOISE)
            v += noise.uniform(-NOISE, NOISE)
    return rows, (x, v)


def sampled():
    """Inputs in the box, seeded."""
    source = random.Random(1)
    return [tuple(source.uniform(-limit, limit) for limit in RANGES[:2]) + (source.uniform(-WISH_LIMIT, WISH_LIMIT),)
            for _ in range(SAMPLES)]


def nearby(thetas, instructions):
    """Inputs about those that took the most instructions."""
    source = random.Random(2)
    worst = sorted(range(len(thetas)), key=lambda i: -instructions[i])[:REFINED]
    return [tuple(max(-limit, min(limit, value + SPREAD * limit * source.uniform(-1.0, 1.0))) for value, limit in zip(thetas[i], RANGES))
            for i in worst for _ in range(NEARBY)]
