"""Closed loop with wind: the lateral axis in gusts, with and without knowing the mean wind."""
import pathlib
import sys

import numpy as np
import polyfly as pf

PROBLEMS = pathlib.Path(__file__).resolve().parents[3] / "region_maps/problems"

problem = pf.load(PROBLEMS / "multirotor_lateral.yaml")
law, model = problem.solve(), problem.discretise()
STEPS, MEAN = 150, 1.2  # periods; acceleration by the mean wind [m/s^2]

# Gusts: white noise through a first-order filter of 1 s.
noise, gusts = np.random.default_rng(4).normal(0, 0.3, STEPS), np.zeros(STEPS)
for k in range(1, STEPS):
    gusts[k] = 0.9 * gusts[k - 1] + noise[k]


def fly(known_wind):
    loop, x, positions = pf.Law(law), np.array([-2.0, 0.0, 0.0]), []
    for k in range(STEPS):
        u = loop.step(x, 0.0, known_wind)
        x = model.A @ x + model.B @ u + model.Bd @ [MEAN + gusts[k]]
        positions.append(x[0])
    return positions


curves = {"mean wind known": fly(MEAN), "not known": fly(0.0)}
for name, positions in curves.items():
    print(f"{name}: mean error of the last 10 s {np.mean(positions[-100:]):+.2f} m")

law.plot("e_p_y", "e_v_y", output=sys.argv[1])
