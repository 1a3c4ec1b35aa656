"""Ball on a plate, one axis: bounds on the plate's angle and on the ball's position hold along the horizon."""
import sys

import numpy as np
import polyfly as pf

GRAVITY, LAG = 9.81, 0.15  # [m/s^2]; of the plate's drive [s]
# A solid ball that rolls: p' = v, v' = 5/7 g alpha; the plate follows its command.
A = [[0, 1, 0], [0, 0, 5 / 7 * GRAVITY], [0, 0, -1 / LAG]]
mpc = (pf.MPC(A, B=[0, 0, 1 / LAG], Ts=0.05, horizon=6, C=[[1, 0, 0]], name="ball_on_plate",
              states=[("p", "m"), ("v", "m/s"), ("alpha", "rad")], inputs=[("alpha_cmd", "rad")])
       .cost(Q=[60, 1, 0.1], R=[2])
       .bounds(x=([-0.25, -1, -0.2], [0.25, 1, 0.2]), u=(-0.2, 0.2)))
law = mpc.explicit(parameters={"e_p": (-0.25, 0.25), "e_v": (-1, 1), "e_alpha": (-0.2, 0.2)})

states = np.random.default_rng(1).uniform([-0.25, -1, -0.2], [0.25, 1, 0.2], (10_000, 3))
feasible = ~np.isnan(law.evaluate(states, threads=2)[:, 0])
print(f"{len(law.regions)} regions; from {100 * feasible.mean():.0f} % of all states the ball stays on the plate")

law.plot("e_p", "e_v", output=sys.argv[1])
