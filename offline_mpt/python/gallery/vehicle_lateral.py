"""Lane keeping: steering of a car at constant speed by the linear single-track model."""
import sys

import numpy as np
import polyfly as pf

SPEED, MASS, INERTIA = 20.0, 1500.0, 2500.0  # [m/s], [kg], [kg m^2]
FRONT, REAR = 1.2, 1.5  # distances of the axles from the centre of mass [m]
STIFF_FRONT, STIFF_REAR = 80e3, 90e3  # cornering stiffnesses [N/rad]

# y' = v_y + speed psi; v_y and the yaw rate r by the side forces of both axles.
total, moment = STIFF_FRONT + STIFF_REAR, FRONT * STIFF_FRONT - REAR * STIFF_REAR
damping = FRONT**2 * STIFF_FRONT + REAR**2 * STIFF_REAR
A = [[0, 1, SPEED, 0], [0, -total / (MASS * SPEED), 0, -moment / (MASS * SPEED) - SPEED], [0, 0, 0, 1],
     [0, -moment / (INERTIA * SPEED), 0, -damping / (INERTIA * SPEED)]]
B = [0, STIFF_FRONT / MASS, 0, FRONT * STIFF_FRONT / INERTIA]

mpc = (pf.MPC(A, B, Ts=0.1, horizon=5, C=[[1, 0, 0, 0]], name="vehicle_lateral", inputs=[("delta", "rad")],
              states=[("y", "m"), ("v_y", "m/s"), ("psi", "rad"), ("r", "rad/s")])
       .cost(Q=[1, 0.1, 1, 0.1], R=[50])
       .bounds(u=(-0.06, 0.06)))
law = mpc.explicit(parameters={"e_y": (-2, 2), "e_v_y": (-1, 1), "e_psi": (-0.2, 0.2), "e_r": (-0.5, 0.5)})

model, x = mpc.problem().discretise(), np.array([1.5, 0, 0, 0])
for _ in range(60):
    x = model.A @ x + model.B @ law(x)
print(f"{len(law.regions)} regions; 1.5 m beside the lane, {abs(x[0]) * 100:.1f} cm after 6 s")

law.plot("e_y", "e_psi", output=sys.argv[1])
