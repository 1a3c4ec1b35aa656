"""2-1-1 manoeuvres of roll and pitch flown by Betaflight's SITL, in wall time, for `calibrate attitude`. Without ROS.

usage: betaflight_excite.py FLIGHT.csv. SITL runs already, with the configuration of betaflight_link.py.
"""

import math
import sys

from betaflight_link import GRAVITY, Link, roll_pitch, thrust_polynomial

UNIT, REST = 0.25, 3.0  # the "1" of a manoeuvre, and the time before the next one [s]
AMPLITUDES, REPEATS = (0.12, 0.2), 3  # [rad]
SETTLED = 6.0  # from take-off until the first manoeuvre [s]
HEIGHT, TILT_MAX = 2.0, 0.2  # [m], [rad]
COLUMNS = ("t_s", "roll_cmd_rad", "pitch_cmd_rad", "yaw_rate_cmd_radps", "roll_rad", "pitch_rad", "wx_radps", "wy_radps", "wz_radps", "height_m")


def manoeuvres():
    """Rows (start [s], axis, signed amplitude [rad]), and when the last one has come to rest [s]."""
    rows, start = [], SETTLED
    for _ in range(REPEATS):
        for amplitude in AMPLITUDES:
            for axis in (0, 1):
                for sign in (1, -1):
                    rows.append((start, axis, sign * amplitude))
                    start += 4.0 * UNIT + REST
    return rows, start


def added(plan, now):
    """The manoeuvre's share of (roll, pitch), or None at rest."""
    for start, axis, amplitude in plan:
        if start <= now < start + 4.0 * UNIT:
            signed = -amplitude if int((now - start) / UNIT) == 2 else amplitude
            return (0.0, signed) if axis == 1 else (signed, 0.0)
    return None


def clipped(value, limit):
    return max(-limit, min(limit, value))


class Excitation(Link):
    """Holds the position between the manoeuvres. During one the held tilt stays constant."""

    def __init__(self):
        super().__init__()
        self.rows, self.held, self.polynomial = [], (0.0, 0.0), thrust_polynomial()
        self.plan, self.end = manoeuvres()

    def level(self, yaw):
        (x, y, _), (vx, vy, _) = self.plant.position, self.plant.velocity
        east, north = -x - 1.6 * vx, -y - 1.6 * vy
        forward = east * math.cos(yaw) + north * math.sin(yaw)
        left = north * math.cos(yaw) - east * math.sin(yaw)
        return clipped(-left / GRAVITY, TILT_MAX), clipped(forward / GRAVITY, TILT_MAX)

    def throttle(self, roll, pitch):
        lift = GRAVITY + clipped(3.0 * (HEIGHT - self.plant.position[2] - self.plant.velocity[2]), 3.0)
        force = self.plant.mass * lift / (math.cos(roll) * math.cos(pitch))
        return sum(c * force ** i for i, c in enumerate(self.polynomial))

    def on_odometry(self, now):
        since = self.since_take_off(now)
        if since < 0.0:
            return
        plant = self.plant
        roll, pitch = roll_pitch(plant.attitude)
        w, x, y, z = plant.attitude
        yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        share = added(self.plan, since)
        if share is None:
            self.held, share = self.level(yaw), (0.0, 0.0)
        self.command = (self.held[0] + share[0], self.held[1] + share[1], clipped(-yaw, 1.0), self.throttle(roll, pitch))
        self.rows.append((since, *self.command[:3], roll, pitch, *plant.rates, plant.position[2]))

    def on_time(self, now):
        return self.since_take_off(now) < self.end


def main(path):
    excitation = Excitation()
    excitation.run(excitation.on_time)
    with open(path, "w") as file:
        file.write(",".join(COLUMNS) + "\n")
        for row in excitation.rows:
            file.write(",".join("%.6f" % value for value in row) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
