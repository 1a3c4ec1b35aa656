#!/usr/bin/env python3
"""The packets of betaflight_link.py against a C compiler's layout of the same structures, its sticks, and its plant."""

import ctypes
import math
import os
import random
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "experiments"))

import betaflight_excite as excite
import betaflight_link as link


class ServoPacket(ctypes.Structure):
    _fields_ = [("motor_speed", ctypes.c_float * 4)]


class FdmPacket(ctypes.Structure):
    _fields_ = [("timestamp", ctypes.c_double), ("rates", ctypes.c_double * 3), ("acceleration", ctypes.c_double * 3),
                ("quaternion", ctypes.c_double * 4), ("velocity", ctypes.c_double * 3), ("position", ctypes.c_double * 3),
                ("pressure", ctypes.c_double)]


class RcPacket(ctypes.Structure):
    _fields_ = [("timestamp", ctypes.c_double), ("channels", ctypes.c_uint16 * 16)]


def random_attitude(source):
    q = [source.gauss(0.0, 1.0) for _ in range(4)]
    norm = math.sqrt(sum(v * v for v in q))
    return tuple(v / norm for v in q)


class VehicleTest(unittest.TestCase):
    def test_problems_have_the_loop_and_nothing_else_changes(self):
        folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "region_maps", "problems")
        for axis, changes in (("longitudinal", 2), ("lateral", 2), ("vertical", 0)):
            with open(os.path.join(folder, "multirotor_%s.yaml" % axis)) as file:
                given = file.read()
            pairs = list(zip(given.split("\n"), link.with_loop(given).split("\n")))
            changed = [new for old, new in pairs if old != new]
            self.assertEqual(len(changed), changes)
            if changes:
                self.assertEqual(changed[0].strip(), "- [0, 0, -20]  # -1 / tau")
                self.assertEqual(changed[1].strip(), "- [20]  # K / tau")


class ExcitationTest(unittest.TestCase):
    def test_each_manoeuvre_is_2_1_1_on_one_axis(self):
        plan, end = excite.manoeuvres()
        self.assertEqual(len(plan), 2 * 2 * len(excite.AMPLITUDES) * excite.REPEATS)
        self.assertIsNone(excite.added(plan, end - 0.01))
        for start, axis, amplitude in plan:
            self.assertIsNone(excite.added(plan, start - 0.01))
            for unit, sign in ((0.1, 1), (1.9, 1), (2.1, -1), (2.9, -1), (3.1, 1), (3.9, 1)):
                share = excite.added(plan, start + unit * excite.UNIT)
                self.assertEqual(share[axis], sign * amplitude)
                self.assertEqual(share[1 - axis], 0.0)
            self.assertIsNone(excite.added(plan, start + 4.1 * excite.UNIT))
        self.assertEqual(sum(amplitude for _, _, amplitude in plan), 0.0)


class PacketTest(unittest.TestCase):
    def test_sizes_are_those_of_the_structures(self):
        for layout, structure in ((link.MOTORS, ServoPacket), (link.STATE, FdmPacket), (link.RC, RcPacket)):
            self.assertEqual(layout.size, ctypes.sizeof(structure))

    def test_state_stands_where_the_autopilot_reads_it(self):
        plant = link.Plant()
        plant.rates, plant.velocity, plant.position = [1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]
        plant.specific_force, plant.attitude = (10.0, 11.0, 12.0), (0.5, 0.5, -0.5, 0.5)
        packet = FdmPacket.from_buffer_copy(plant.state_packet())
        self.assertEqual(packet.timestamp, 0.0)
        self.assertEqual(list(packet.rates), [1.0, -2.0, 3.0])
        self.assertEqual(list(packet.acceleration), [-10.0, -11.0, -12.0])
        self.assertEqual(list(packet.quaternion), [0.5, 0.5, 0.5, -0.5])
        self.assertEqual(list(packet.velocity), [4.0, 5.0, 6.0])
        self.assertEqual(list(packet.position), [7.0, 8.0, 9.0])

    def test_sticks(self):
        def channels(*command):
            return list(RcPacket.from_buffer_copy(link.RC.pack(0.0, *link.rc_channels(*command))).channels)

        # Arming is refused unless the throttle is below min_check.
        self.assertEqual(channels(0.0, 0.0, 0.0, 0.0, False), [1500, 1500, 1000, 1500, 1000, 2000] + [1000] * 10)
        half = math.radians(link.ANGLE_LIMIT / 2)
        self.assertEqual(channels(half, -half, 0.0, 1.0, True)[:6], [1750, 1250, 2000, 1500, 2000, 2000])
        # A yaw to the left is the stick to the left. Beyond the ends nothing grows.
        self.assertEqual(channels(9.0, -9.0, math.radians(link.YAW_RATE_LIMIT), 9.0, True)[:4], [2000, 1000, 2000, 1000])

    def test_attitude_comes_back_from_a_target(self):
        source = random.Random(1)
        for _ in range(200):
            roll, pitch, yaw = source.uniform(-1.0, 1.0), source.uniform(-1.0, 1.0), source.uniform(-3.0, 3.0)
            # The body's up and forward axes by yaw, pitch and roll one after another.
            q = (1.0, 0.0, 0.0, 0.0)
            for angle, axis in ((yaw, 3), (pitch, 2), (roll, 1)):
                turn = [math.cos(0.5 * angle), 0.0, 0.0, 0.0]
                turn[axis] = math.sin(0.5 * angle)
                a, b = q, turn
                q = (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                     a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])
            for got, wanted in zip(link.roll_pitch(q), (roll, pitch)):
                self.assertAlmostEqual(got, wanted, places=9)


class PlantTest(unittest.TestCase):
    def hovering(self):
        plant = link.Plant()
        signal = math.sqrt(plant.mass * link.GRAVITY / (4.0 * plant.rotor_thrust))
        plant.position, plant.signals = [0.0, 0.0, 5.0], [signal] * 4
        return plant, signal

    def test_hover_and_ground(self):
        plant, signal = self.hovering()
        plant.advance([signal] * 4, 1.0)
        self.assertLess(math.dist(plant.position, (0.0, 0.0, 5.0)), 1e-9)
        plant = link.Plant()
        plant.advance([0.5 * signal] * 4, 1.0)
        self.assertEqual(plant.position, [0.0, 0.0, 0.0])

    def test_free_fall(self):
        plant, _ = self.hovering()
        plant.signals, plant.drag = [0.0] * 4, 0.0
        plant.advance([0.0] * 4, 0.5)
        self.assertAlmostEqual(plant.position[2], 5.0 - 0.125 * link.GRAVITY, delta=0.003)

    def test_each_moment_turns_as_the_mixer_expects(self):
        # Rear right, front right, rear left, front left: to the right, nose down, and to the left seen from above, where
        # rotors that turn clockwise are faster.
        for faster, axis in (((2, 3), 0), ((0, 2), 1), ((0, 3), 2)):
            plant, signal = self.hovering()
            plant.advance([1.01 * signal if i in faster else 0.99 * signal for i in range(4)], 0.05)
            self.assertGreater(plant.rates[axis], 1e-3)
            self.assertTrue(all(abs(plant.rates[i]) < 1e-3 * plant.rates[axis] for i in range(3) if i != axis))

    def test_torque_free_rotation_keeps_the_angular_momentum(self):
        plant, _ = self.hovering()
        plant.signals, plant.position = [0.0] * 4, [0.0, 0.0, 99.0]
        plant.attitude, plant.rates = random_attitude(random.Random(2)), [2.0, -1.0, 3.0]

        def momentum():
            return link.rotated(plant.attitude, [j * w for j, w in zip(plant.inertia, plant.rates)])

        before = momentum()
        plant.advance([0.0] * 4, 1.0)
        self.assertLess(math.dist(before, momentum()), 0.01 * math.hypot(*before))

    def test_thrust_curve(self):
        curve = link.thrust_polynomial()
        for acceleration in (5.0, link.GRAVITY, 20.0):
            throttle = sum(c * (acceleration * link.Plant.mass) ** i for i, c in enumerate(curve))
            signal = link.IDLE + (1.0 - link.IDLE) * throttle
            self.assertAlmostEqual(4.0 * link.Plant.rotor_thrust * signal ** 2 / link.Plant.mass, acceleration, delta=0.15)


if __name__ == "__main__":
    unittest.main()
