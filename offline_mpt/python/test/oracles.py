"""Small problems, and answers that share no code with the module: numpy alone."""
import itertools
import os
import pathlib

import numpy as np

ROOT = pathlib.Path(os.environ["POLYFLY_ROOT"])
LATERAL = ROOT / "region_maps/problems/reference/lateral_asl.yaml"

# The double integrator of Bemporad, Morari, Dua and Pistikopoulos (2002), Sect. 7.1, as matrices.
BEMPORAD = {
    "H": np.array([[1.5064, 0.4838], [0.4838, 1.5258]]), "f": np.zeros(2),
    "F": np.array([[9.6652, 5.2115], [7.0732, -7.0879]]),
    "A": np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]), "b": np.full(4, 2.0), "B": np.zeros((4, 2)),
    "lo": np.full(2, -1.5), "hi": np.full(2, 1.5)}

# x' = A x + B u of a mass, and a tracking problem for it.
MASS = {"A": [[0, 1], [0, 0]], "B": [[0], [1]], "C": [[1, 0]], "Ts": 0.1, "horizon": 8, "name": "mass"}
MASS_WEIGHTS = {"Q": [10.0, 1.0], "R": [0.5]}
MASS_BOX = {"e_p": (-3.0, 3.0), "e_v": (-2.0, 2.0)}


def random_parameters(lower, upper, count, seed):
    return np.random.default_rng(seed).uniform(lower, upper, (count, len(lower)))


def minimiser(H, g, A, b, tolerance=1e-9):
    """argmin 1/2 z'Hz + g'z s.t. A z <= b by trying every set of active rows; None where there is no solution."""
    for size in range(min(len(b), len(g)) + 1):
        for rows in itertools.combinations(range(len(b)), size):
            active = A[list(rows)]
            kkt = np.block([[H, active.T], [active, np.zeros((size, size))]])
            if np.linalg.matrix_rank(kkt) < len(kkt):
                continue
            solution = np.linalg.solve(kkt, np.concatenate([-g, b[list(rows)]]))
            z, multipliers = solution[:len(g)], solution[len(g):]
            if np.all(multipliers >= -tolerance) and np.all(A @ z <= b + tolerance):
                return z
    return None


def mass_input(error, weights, period, horizon, limit):
    """First input of the mass's tracking problem, by coordinate descent in the inputs: the bounds are a box."""
    A, B = np.array([[1.0, period], [0.0, 1.0]]), np.array([[period**2 / 2], [period]])
    Q, R = np.diag(weights["Q"]), np.diag(weights["R"])
    P = Q
    for _ in range(2000):
        P = A.T @ P @ A - A.T @ P @ B @ np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A) + Q
    H, g = np.zeros((horizon, horizon)), np.zeros(horizon)
    for step in range(1, horizon + 1):
        gain = np.zeros((2, horizon))
        for k in range(step):
            gain[:, k] = (np.linalg.matrix_power(A, step - 1 - k) @ B)[:, 0]
        weight = P if step == horizon else Q
        H += gain.T @ weight @ gain
        g += gain.T @ weight @ np.linalg.matrix_power(A, step) @ error
    H += R[0, 0] * np.eye(horizon)
    u = np.zeros(horizon)
    for _ in range(20000):
        before = u.copy()
        for i in range(horizon):
            u[i] = np.clip(u[i] - (H[i] @ u + g[i]) / H[i, i], -limit, limit)
        if np.max(np.abs(u - before)) < 1e-13:
            break
    return u[0]


def least_peak(A, B, G, C, error, u_bounds, w_bounds):
    """min over (u_0, u_1) of the greatest |C e_k|, k = 1, 2, over all w: the lowest vertex of t >= +-C e_k."""
    A, B, G, C = (np.asarray(value, dtype=float) for value in (A, B, G, C))
    rows = [[1, 0, 0, u_bounds[1]], [-1, 0, 0, -u_bounds[0]], [0, 1, 0, u_bounds[1]], [0, -1, 0, -u_bounds[0]]]
    for w in itertools.product(w_bounds, repeat=2):
        free = A @ error + G[:, 0] * w[0]
        stages = ((C @ free, C @ B[:, 0], 0.0 * C @ B[:, 0]),
                  (C @ (A @ free + G[:, 0] * w[1]), C @ A @ B[:, 0], C @ B[:, 0]))
        for constant, by_first, by_second in stages:
            for sign in (1.0, -1.0):
                rows += [[sign * f, sign * s, -1.0, -sign * c] for f, s, c in zip(by_first, by_second, constant)]
    rows = np.array(rows)
    triples = rows[list(itertools.combinations(range(len(rows)), 3))]
    triples = triples[np.abs(np.linalg.det(triples[:, :, :3])) > 1e-12]
    vertices = np.linalg.solve(triples[:, :, :3], triples[:, :, 3:])[:, :, 0]
    feasible = np.all(vertices @ rows[:, :3].T <= rows[:, 3] + 1e-9, axis=1)
    return np.min(vertices[feasible, 2])


def constrained_input(model, weights, horizon, error, u_limit, x_bounds, soft=None):
    """First input of the tracking problem with bounds on x_k - x_ref, k = 1..N, by every active set.

    model       (A, B) in discrete time, one input
    weights     (Q, R, P), matrices
    x_bounds    (state, lower, upper)
    soft        (linear, quadratic): the cost of a slack v >= 0 for each stage
    """
    A, B = (np.asarray(value, dtype=float) for value in model)
    Q, R, P = weights
    state, lower, upper = x_bounds
    slacks = 0 if soft is None else horizon
    size = horizon + slacks
    H, g, rows, limits = np.zeros((size, size)), np.zeros(size), [], []
    H[:horizon, :horizon] = 2 * R[0, 0] * np.eye(horizon)
    for step in range(1, horizon + 1):
        gain = np.zeros((len(A), size))
        for k in range(step):
            gain[:, k] = (np.linalg.matrix_power(A, step - 1 - k) @ B)[:, 0]
        free = np.linalg.matrix_power(A, step) @ error
        weight = P if step == horizon else Q
        H += 2 * gain.T @ weight @ gain
        g += 2 * gain.T @ weight @ free
        for sign, bound in ((1.0, upper), (-1.0, lower)):
            row = sign * gain[state]
            if slacks:
                row[horizon + step - 1] = -1.0
            rows.append(row)
            limits.append(sign * (bound - free[state]))
    for k in range(size):
        unit = np.eye(size)[k]
        if k >= horizon:
            g[k], H[k, k] = soft[0], 2 * soft[1]
        rows += [unit, -unit] if k < horizon else [-unit]
        limits += [u_limit, u_limit] if k < horizon else [0.0]
    z = minimiser(H, g, np.array(rows), np.array(limits))
    return None if z is None else z[0]
