"""Heading of a rover: the last command is a parameter of the law, so that its change can be weighted."""
import sys

import numpy as np
import polyfly as pf

LAG, LIMIT = 0.3, 0.8  # of the turn rate [s]; of its command [rad/s]
mpc = (pf.MPC(A=[[0, 1], [0, -1 / LAG]], B=[0, 1 / LAG], Ts=0.1, horizon=8, C=[[1, 0]], name="rover_heading",
              states=[("psi", "rad"), ("r", "rad/s")], inputs=[("r_cmd", "rad/s")])
       .cost(Q=[8, 0.5], R=[0.5], R_delta=[2])
       .bounds(u=(-LIMIT, LIMIT))
       .parameters({"e_psi": (-np.pi, np.pi), "e_r": (-1, 1), "r_cmd_prev": (-LIMIT, LIMIT)}))
law = pf.Law(mpc.explicit())

# Turn by 90 degrees. The law keeps the last command itself.
model, x, changes, u_before = mpc.problem().discretise(), np.zeros(2), [], 0.0
for _ in range(80):
    u = law.step(x, np.pi / 2)[0]
    changes.append(abs(u - u_before))
    x, u_before = model.A @ x + model.B[:, 0] * u, u
print(f"turned to {np.degrees(x[0]):.1f} degrees; greatest change of the command {max(changes):.2f} rad/s")

mpc.explicit().plot("e_psi", "r_cmd_prev", output=sys.argv[1])
