"""Double integrator: the law of a mass that a bounded force brings to rest, for every state in a box."""
import sys

import numpy as np
import polyfly as pf

mpc = (pf.MPC(A=[[0, 1], [0, 0]], B=[[0], [1]], Ts=0.1, horizon=10, C=[[1, 0]], name="double_integrator",
              states=[("p", "m"), ("v", "m/s")], inputs=[("a", "m/s^2")])
       .cost(Q=[10, 1], R=[0.5])
       .bounds(u=(-1, 1)))
law = mpc.explicit(parameters={"e_p": (-2, 2), "e_v": (-2, 2)})

# From 2 m away to rest: each period one look-up.
model = mpc.problem().discretise()
x = np.array([2.0, 0.0])
for _ in range(60):
    x = model.A @ x + model.B @ law(x)
print(f"{len(law.regions)} regions; after 6 s the mass is {abs(x[0]):.3f} m from its target")

law.plot("e_p", "e_v", output=sys.argv[1])
