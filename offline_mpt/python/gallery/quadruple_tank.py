"""Quadruple tank (Johansson, 2000): two pumps, each of which fills two of four coupled tanks."""
import sys

import polyfly as pf

# The linear model of the minimum-phase operating point: levels [cm], pump voltages [V].
T1, T2, T3, T4 = 62, 90, 23, 30  # time constants [s]
A1, A2, A3, A4 = 28, 32, 28, 32  # cross sections [cm^2]
k1, k2, gamma1, gamma2 = 3.33, 3.35, 0.70, 0.60
A = [[-1 / T1, 0, A3 / (A1 * T3), 0], [0, -1 / T2, 0, A4 / (A2 * T4)], [0, 0, -1 / T3, 0], [0, 0, 0, -1 / T4]]
B = [[gamma1 * k1 / A1, 0], [0, gamma2 * k2 / A2], [0, (1 - gamma2) * k2 / A3], [(1 - gamma1) * k1 / A4, 0]]

levels = [(f"h{i}", "cm") for i in (1, 2, 3, 4)]
mpc = (pf.MPC(A, B, Ts=5, horizon=3, C=[[1, 0, 0, 0], [0, 1, 0, 0]], name="quadruple_tank", states=levels,
              inputs=[("v1", "V"), ("v2", "V")])
       .cost(Q=[1, 1, 0.1, 0.1], R=[0.1, 0.1])
       .bounds(u=([-2, -2], [2, 2])))
law = mpc.explicit(parameters={f"e_{name}": (-5, 5) for name, _ in levels})
u = law([2, -1, 0, 0])
print(f"{len(law.regions)} regions; tank 1 too full by 2 cm, tank 2 too empty by 1 cm: {u[0]:+.2f} V, {u[1]:+.2f} V")

law.plot("e_h1", "e_h2", output=sys.argv[1])
