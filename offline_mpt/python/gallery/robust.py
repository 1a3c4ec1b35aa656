"""Robust altitude: the least peak of the error that is guaranteed for every wind in a range, proven in fractions."""
import sys

import numpy as np
import polyfly as pf

# p' = v, v' = u + w: thrust over mass less gravity, and the wind's acceleration [m/s^2].
mpc = (pf.RobustMPC(A=[[0, 1], [0, 0]], B=[0, 1], G=[0, 1], Ts=0.08, horizon=6, C=[1, 0], floor=0.02,
                    invariance="first_step", states=[("p", "m"), ("v", "m/s")], inputs=[("u", "m/s^2")],
                    disturbances=[("w", "m/s^2")], name="altitude")
       .tie_break(Q=[40, 20], R=[2])
       .bounds(x=([-np.inf, -1], [np.inf, 1]), u=(-4, 4), w=(-0.5, 0.5)))
law = mpc.explicit(parameters={"e_p": (-4, 4), "e_v": (-2, 2)})
proof = law.certify()
problem = mpc.problem()
wind = problem.disturbances[0]
print(f"{len(law.regions)} regions for all winds of {wind.lower} to {wind.upper} {wind.unit}")
print("every bound holds for each of them, now and later" if proof.recursively_feasible else "feasibility may be lost")

# In a loop, with the wind that is worst for the speed.
loop, model, x, fastest = pf.RobustLaw(law), problem.discretise(), np.array([2.0, 0.0]), 0.0
for _ in range(100):
    x = model.A @ x + model.B @ loop.step(x) + model.Bd @ [np.copysign(0.5, x[1])]
    fastest = max(fastest, abs(x[1]))
print(f"from 2 m at {fastest:.3f} m/s at most to {abs(x[0]):.3f} m")

law.plot("e_p", "e_v", output=sys.argv[1])
