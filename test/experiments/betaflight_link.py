"""UDP packets of Betaflight's SITL, its configuration, a rigid multirotor for it, and what a flight must keep.
Without ROS.

usage: betaflight_link.py FOLDER writes what the node flies by: vehicle.yaml and problems/multirotor_AXIS.yaml.

Axes of the plant: body forward, left, up; world east, north, up. SI units. Quaternions are (w, x, y, z).
"""

import math
import os
import re
import select
import socket
import struct
import sys
import time

GRAVITY = 9.8066  # [m/s^2]
MOTOR_PORT, STATE_PORT, RC_PORT = 9002, 9003, 9004
STATE_PERIOD, ODOMETRY_PERIOD = 0.002, 0.01  # [s]
BOOT_TIME, ARM_TIME = 8.0, 1.0  # until the arming switch is on, from turning motors until take-off [s]
ARM_PATIENCE = 5.0  # from the arming switch until the motors turn [s]

# src/platform/SIMULATOR/target/SITL/target.h of Betaflight: servo_packet, fdm_packet, rc_packet. None has padding.
MOTORS = struct.Struct("<4f")
STATE = struct.Struct("<18d")
RC = struct.Struct("<d16H")

GREATEST_GAP = 0.05  # between commands; a flight with a greater one does not count [s]
# Of the distance to the reference: in the last seconds of a part, or rms over the eight [m].
LIMITS = {"hover": 0.02, "step": 0.05, "eight": 0.25, "wind": 0.05, "loss": 1.5, "after": 0.05}
SETTLED = 1.5  # the last seconds of a part [s]

ANGLE_LIMIT = 45  # of the stick's end [deg]
YAW_RATE_LIMIT = 200  # of the stick's end [deg/s]
THROTTLE_LOW = 1050  # throttle of 0: `min_check`
IDLE = 0.055  # motor signal of an armed vehicle at throttle 0: `motor_idle`

# For `--config FILE`: arming on AUX1, angle mode on AUX2, sticks without expo, no heading from a GPS.
CONFIGURATION = """feature -GPS
set small_angle = 180
set min_check = %d
set motor_idle = %d
set mag_hardware = NONE
set angle_limit = %d
set rates_type = ACTUAL
set yaw_rc_rate = %d
set yaw_srate = %d
set yaw_expo = 0
set roll_rc_rate = 36
set roll_srate = 36
set roll_expo = 0
set pitch_rc_rate = 36
set pitch_srate = 36
set pitch_expo = 0
set runaway_takeoff_prevention = OFF
set enable_stick_arming = OFF
aux 0 0 0 1700 2100 0 0
aux 1 1 1 1700 2100 0 0
save
""" % (THROTTLE_LOW, round(10000 * IDLE), ANGLE_LIMIT, YAW_RATE_LIMIT // 10, YAW_RATE_LIMIT // 10)


# Attitude loop from the odometry to the tilt, a lag of first order behind a dead time: what `calibrate attitude` finds in a
# flight of betaflight_excite.py, alike for roll and pitch. Most of the dead time is Betaflight's filters and the rotors.
GAIN, LAG, DEAD_TIME = 1.0, 0.05, 0.105  # [1], [s], [s]

VEHICLE = """vehicle: {mass: %g, delay: %g}
controller: {disturbance_rate_drift: 0.03}
nonlinear: {roll_gain: %g, roll_time: %g, pitch_gain: %g, pitch_time: %g}
""" % (1.52, DEAD_TIME, GAIN, LAG, GAIN, LAG)


def with_loop(problem):
    """The text of a problem file of an axis, with this attitude loop; that of the vertical axis has none."""
    problem = re.sub(r"-[0-9.]+\](  # -1 / tau)", r"%.12g]\1" % (-1.0 / LAG), problem)
    return re.sub(r"\[[0-9.]+\](  # K / tau)", r"[%.12g]\1" % (GAIN / LAG), problem)


def rotated(q, v):
    """The body's vector v in the world."""
    w, x, y, z = q
    tx, ty, tz = 2.0 * (y * v[2] - z * v[1]), 2.0 * (z * v[0] - x * v[2]), 2.0 * (x * v[1] - y * v[0])
    return (v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx)


def conjugate(q):
    return (q[0], -q[1], -q[2], -q[3])


def roll_pitch(q):
    w, x, y, z = q
    sine = max(-1.0, min(1.0, 2.0 * (w * y - z * x)))
    return math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)), math.asin(sine)


def rc_channels(roll, pitch, yaw_rate, throttle, armed):
    """16 channels [us] for angles [rad], a yaw rate to the left [rad/s] and a throttle from 0 to 1; cut to the sticks' ends."""
    def stick(value, limit):
        return round(1500 + 500 * max(-1.0, min(1.0, value / math.radians(limit))))

    # Arming needs a throttle below `min_check`.
    throttle = round(THROTTLE_LOW + (2000 - THROTTLE_LOW) * min(1.0, throttle)) if throttle > 0.0 else 1000
    channels = [stick(roll, ANGLE_LIMIT), stick(pitch, ANGLE_LIMIT), throttle, stick(-yaw_rate, YAW_RATE_LIMIT)]
    return channels + [2000 if armed else 1000, 2000] + [1000] * 10


class Plant:
    """A rigid body with four rotors, each with a lag and a thrust that is quadratic in its signal, on flat ground."""

    mass, drag = 1.52, 0.1  # [kg], of the body in the air [1/s]
    inertia = (0.012, 0.012, 0.02)  # [kg m^2]
    rotor_thrust = 1.52 * 24.0 / 4.0  # of signal 1 [N]
    rotor_time, lever, torque = 0.025, 0.15, 0.016  # lag [s], arm about x and y [m], moment about z per thrust [m]
    # Rear right, front right, rear left, front left: signs of the moments about x, y, z. The first turns clockwise.
    rotors = ((-1, 1, 1), (-1, -1, -1), (1, 1, -1), (1, -1, 1))
    substep = 0.001  # [s]

    def __init__(self):
        self.position, self.velocity = [0.0] * 3, [0.0] * 3
        self.attitude, self.rates = (1.0, 0.0, 0.0, 0.0), [0.0] * 3
        self.signals = [0.0] * 4
        self.specific_force = (0.0, 0.0, GRAVITY)  # in the body [m/s^2]
        self.wind = (0.0, 0.0, 0.0)  # an acceleration in the world [m/s^2]

    def advance(self, motors, period):
        steps = max(1, math.ceil(period / self.substep))
        for _ in range(steps):
            self._step(motors, period / steps)

    def _step(self, motors, h):
        share = 1.0 - math.exp(-h / self.rotor_time)
        self.signals = [s + share * (max(0.0, min(1.0, m)) - s) for s, m in zip(self.signals, motors)]
        thrusts = [self.rotor_thrust * s * s for s in self.signals]
        lift = sum(thrusts) / self.mass
        up = rotated(self.attitude, (0.0, 0.0, lift))
        pushed = [up[i] - self.drag * self.velocity[i] + self.wind[i] for i in range(3)]
        if self.position[2] <= 0.0 and pushed[2] < GRAVITY:
            # The ground holds it, level.
            self.velocity, self.rates, self.position[2] = [0.0] * 3, [0.0] * 3, 0.0
            self.specific_force = (0.0, 0.0, GRAVITY)
            return
        arms = (self.lever, self.lever, self.torque)
        moment = [arms[i] * sum(sign[i] * f for sign, f in zip(self.rotors, thrusts)) for i in range(3)]
        (p, q, r), (jx, jy, jz) = self.rates, self.inertia
        turning = ((moment[0] - (jz - jy) * q * r) / jx, (moment[1] - (jx - jz) * r * p) / jy, (moment[2] - (jy - jx) * p * q) / jz)
        self.rates = [w + h * a for w, a in zip(self.rates, turning)]
        self._turn(h)
        self.velocity = [v + h * (a - (GRAVITY if i == 2 else 0.0)) for i, (v, a) in enumerate(zip(self.velocity, pushed))]
        self.position = [x + h * v for x, v in zip(self.position, self.velocity)]
        self.specific_force = rotated(conjugate(self.attitude), pushed)

    def _turn(self, h):
        speed = math.sqrt(sum(w * w for w in self.rates))
        half = 0.5 * h * speed
        scale = math.sin(half) / speed if speed > 0.0 else 0.0
        b, (w, x, y, z) = [scale * rate for rate in self.rates], self.attitude
        c = math.cos(half)
        turned = (w * c - x * b[0] - y * b[1] - z * b[2], w * b[0] + x * c + y * b[2] - z * b[1],
                  w * b[1] - x * b[2] + y * c + z * b[0], w * b[2] + x * b[1] - y * b[0] + z * c)
        norm = math.sqrt(sum(value * value for value in turned))
        self.attitude = tuple(value / norm for value in turned)

    def state_packet(self):
        """What SITL's default build (Gazebo) takes. Betaflight's own axes are forward, left, up; it negates the pitch rate,
        all accelerations, and the y and z of the quaternion, so they are negated here. SITL sets the rate of its clock from
        the stamps of two packets and the time between their arrivals. Packets that arrive together would let it race, and
        lose the sticks. A stamp that stays the same leaves it at wall time."""
        (p, q, r), (fx, fy, fz), (w, x, y, z) = self.rates, self.specific_force, self.attitude
        return STATE.pack(0.0, p, -q, r, -fx, -fy, -fz, w, x, -y, -z, *self.velocity, *self.position, 101325.0)


class NotArmed(RuntimeError):
    """SITL must be started again: README.md tells why."""


class Link:
    """Between SITL and the vehicle. A command is (roll, pitch, yaw rate, throttle)."""

    def __init__(self):
        self.plant, self.motors = Plant(), [0.0] * 4
        self.command, self.armed = (0.0, 0.0, 0.0, 0.0), False
        self.armed_since = None  # since when the motors turn
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", MOTOR_PORT))
        self.socket.setblocking(False)

    def on_odometry(self, now):
        """Each 10 ms, after the last command was sent."""

    def since_take_off(self, now):
        """Arms, and tells the seconds since take-off: below 0 before it. Raises NotArmed."""
        self.armed = now >= BOOT_TIME
        if self.armed_since is None and max(self.motors) > 0.5 * IDLE:
            self.armed_since = now
        if self.armed_since is not None:
            return now - self.armed_since - ARM_TIME
        if now > BOOT_TIME + ARM_PATIENCE:
            raise NotArmed("the motors of SITL stand %g s after it was told to arm" % ARM_PATIENCE)
        return -math.inf

    def run(self, on_time):
        """Until on_time(seconds since the start) says False."""
        start = last = time.monotonic()
        next_state = next_odometry = start
        while on_time(last - start):
            select.select([self.socket], [], [], max(0.0, next_state - time.monotonic()))
            self._take_motors()
            now = time.monotonic()
            if now < next_state:
                continue
            self.plant.advance(self.motors, now - last)
            last, next_state = now, max(next_state + STATE_PERIOD, now)
            self.socket.sendto(self.plant.state_packet(), ("127.0.0.1", STATE_PORT))
            if now >= next_odometry:
                next_odometry = max(next_odometry + ODOMETRY_PERIOD, now)
                channels = rc_channels(*self.command, self.armed)
                self.socket.sendto(RC.pack(now - start, *channels), ("127.0.0.1", RC_PORT))
                self.on_odometry(now - start)

    def _take_motors(self):
        try:
            while True:
                packet = self.socket.recv(64)
                if len(packet) == MOTORS.size:
                    self.motors = MOTORS.unpack(packet)
        except BlockingIOError:
            pass


def thrust_polynomial():
    """c of throttle = c[0] + c[1] F + c[2] F^2 [N]: a fit between 4 and 21 m/s^2 of mass, for `output/thrust_polynomial`."""
    import numpy

    force = numpy.linspace(4.0, 21.0, 100) * Plant.mass
    throttle = (numpy.sqrt(force / (4.0 * Plant.rotor_thrust)) - IDLE) / (1.0 - IDLE)
    return [float(c) for c in numpy.polyfit(force, throttle, 2)[::-1]]


def main(folder):
    os.makedirs(os.path.join(folder, "problems"))
    with open(os.path.join(folder, "vehicle.yaml"), "w") as file:
        file.write(VEHICLE)
    problems = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "region_maps", "problems")
    for axis in ("longitudinal", "lateral", "vertical"):
        name = "multirotor_%s.yaml" % axis
        with open(os.path.join(problems, name)) as given, open(os.path.join(folder, "problems", name), "w") as file:
            file.write(with_loop(given.read()))


if __name__ == "__main__":
    main(sys.argv[1])
