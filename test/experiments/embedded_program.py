"""The safety filter of TinyMPC's microcontroller benchmark, as one parametric program for one axis.

usage: embedded_program.py PROGRAM.json

A double integrator x' = v, v' = u, sampled at h. The wishes r_k follow from the state by a PD law along 2 sin(h (t + k)),
rolled out without bounds, so they are linear in theta = (x, v, sin(h t), cos(h t)). The program is

    min 50 sum (u_k - r_k)^2   s.t.  |u_k| <= 2 for k = 0 .. 8,   |x_k|, |v_k| <= 1.5 for k = 1 .. 9.

The bounds on x_0 and v_0 are the parameters' ranges. Numbers from the benchmark's own programs
(RoboticExplorationLab/mcu-solver-benchmarks, safety_filter).
"""

import json
import math
import sys

STEP = 0.05  # h [s]
STAGES = 10  # states x_0 .. x_9, so 9 inputs
STATE_LIMIT = 1.5  # [m], [m/s]
INPUT_LIMIT = 2.0  # [m/s^2]
GAINS = (7.0, 3.0)  # of the PD law
AMPLITUDE = 2.0  # of the reference [m]
WEIGHT = 100.0  # of 1/2 (u - r)^2
STEPS = 190  # that the benchmark solves


def advance(x, v, u):
    return x + STEP * v + 0.5 * STEP * STEP * u, v + STEP * u


def wishes(theta):
    """r_0 .. r_8."""
    x, v, sine, cosine = theta
    result = []
    for k in range(STAGES - 1):
        reference = AMPLITUDE * (sine * math.cos(STEP * k) + cosine * math.sin(STEP * k))
        result.append(GAINS[0] * (reference - x) - GAINS[1] * v)
        x, v = advance(x, v, result[-1])
    return result


def wish_at(x, v, t):
    """r_0 in step t."""
    return wishes((x, v, math.sin(STEP * t), math.cos(STEP * t)))[0]


def states(x, v, inputs):
    """(x_k, v_k) for k = 1 .. 9."""
    result = []
    for u in inputs:
        x, v = advance(x, v, u)
        result.append((x, v))
    return result


def unit(size, index):
    return [1.0 if i == index else 0.0 for i in range(size)]


def columns(function, size):
    """Of a linear function, the matrix as a list of rows."""
    images = [function(unit(size, i)) for i in range(size)]
    return [list(row) for row in zip(*images)]


def program():
    count = STAGES - 1
    to_wishes = columns(wishes, 4)
    by_inputs = columns(lambda u: sum(states(0.0, 0.0, u), ()), count)
    by_theta = columns(lambda theta: sum(states(theta[0], theta[1], [0.0] * count), ()), 4)
    rows, bounds, slopes = [], [], []
    for k in range(count):
        for sign in (1.0, -1.0):
            rows.append([sign * value for value in unit(count, k)])
            bounds.append(INPUT_LIMIT)
            slopes.append([0.0] * 4)
    for row, slope in zip(by_inputs, by_theta):
        for sign in (1.0, -1.0):
            rows.append([sign * value for value in row])
            bounds.append(STATE_LIMIT)
            slopes.append([-sign * value for value in slope])
    return {
        "name": "embedded_benchmark",
        "description": "Safety filter of TinyMPC's microcontroller benchmark; theta = (x, v, sin, cos of 0.05 t)",
        "H": [[WEIGHT * value for value in unit(count, k)] for k in range(count)],
        "f": [0.0] * count,
        "F": [[-WEIGHT * value for value in row] for row in to_wishes],
        "A": rows, "b": bounds, "B": slopes, "eq_ids": [],
        "lb": [-STATE_LIMIT, -STATE_LIMIT, -1.0, -1.0], "ub": [STATE_LIMIT, STATE_LIMIT, 1.0, 1.0],
        "A_theta": [], "b_theta": [], "out": [0],
    }


if __name__ == "__main__":
    with open(sys.argv[1], "w") as file:
        json.dump(program(), file, indent=1)
        file.write("\n")
