#!/usr/bin/env python3
"""Flights end to end: plant, explicit controller, figure and recorder over real topics."""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import rosunit
from roslib.packages import find_node

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import flight  # noqa: E402

# Limits of the Firefly in config/firefly.yaml, with room for rounding.
ANGLE_MAX = 0.4363323 + 1e-9  # [rad]
YAW_RATE_MAX = 1.5707963 + 1e-9  # [rad/s]
MASS = 1.52  # [kg]
GRAVITY = 9.8066  # [m/s^2]
THRUST_MIN = 5.0 * MASS - 1e-9  # [N]
THRUST_MAX = 20.0 * MASS + 1e-9  # [N]

FIGURE_END = 34.7  # the vehicle holds from here [s]
DURATION = 49.7  # [s]
OPTIMAL, CLIPPED, HOLD_LAST, LEVEL = 0, 1, 2, 3  # ControllerStatus.status
NOT_FINITE, STALE, JUMP = 3, 4, 6  # ControllerStatus.reason

# A flight in which nothing but the wind disturbs.
CALM = {
    "gust_sigma": [0.0, 0.0, 0.0],
    "kick_time": 0.0,
    "position_noise": 0.0,
    "velocity_noise": 0.0,
    "attitude_noise": 0.0,
    "angular_velocity_noise": 0.0,
}

# A shorter figure than the demonstration's.
SHORT = {"figure": {"laps": 1, "yaw_turn": 2.0, "hold_time": 2.0}}


def problem_text(name):
    with open(flight.problem_path(name)) as file:
        return file.read()


def second_order(axis):
    """The problem of an axis with blocked moves whose attitude loop is of second order, about as slow as the shipped one."""
    text = problem_text("multirotor_" + axis)
    lateral = axis == "lateral"
    angle, letter, pull = ("phi", "y", -9.8066) if lateral else ("theta", "x", 9.8066)
    model = """
model:
  states: [{name: p_%s, unit: m}, {name: v_%s, unit: m/s}, {name: %s, unit: rad}, {name: %s_rate, unit: rad/s}]
  inputs: [{name: %s_cmd, unit: rad, range: [-0.4363323, 0.4363323]}]
  disturbances: [{name: d, unit: m/s^2}]
  A: [[0, 1, 0, 0], [0, -0.01, %r, 0], [0, 0, 0, 1], [0, 0, -160, -44]]
  B: [[0], [0], [0], [144]]
  B_d: [[0], [1], [0], [0]]
  C: [[1, 0, 0, 0]]
""" % (letter, letter, angle, angle, angle, pull)
    text = text[: text.index("\nmodel:")] + model + text[text.index("\nsampling_time:") :]
    text = text.replace("20, 20]", "20, 20, 0.1]").replace("\nweights:", "\nmoves: [1, 2, 17]\n\nweights:")
    return text + "  - {name: e_%s_rate, role: error, of: %s_rate, unit: rad/s, range: [-6, 6]}\n" % (angle, angle)


class FlightTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="polyfly_flight_")
        cls.flown = {}

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def fly(self, name, overrides=None, **arguments):
        """Each flight is flown once, however many tests look at it."""
        if name not in self.flown:
            self.flown[name] = flight.Flight(flight.Launch(self.folder, name, overrides, **arguments))
        return self.flown[name]

    def solved(self, name, texts):
        """A folder with the maps of the axes: those of the problem texts given, the shipped ones of the others."""
        folder = os.path.join(self.folder, name + "_maps")
        os.mkdir(folder)
        for axis in flight.AXES:
            path = os.path.join(folder, "multirotor_%s.map" % axis)
            if axis not in texts:
                shutil.copy(os.path.join(flight.maps_folder(), os.path.basename(path)), path)
                continue
            problem = os.path.join(folder, axis + ".yaml")
            with open(problem, "w") as file:
                file.write(texts[axis])
            subprocess.run([find_node("offline_mpt", "offline_mpt")[0], "solve", problem, "-o", path], check=True)
        return folder

    def fly_and_replay(self, name, texts):
        """A short figure by the maps of these problems, and what validate_bag says of it."""
        maps = self.solved(name, texts)
        launch = flight.Launch(self.folder, name, {"player": SHORT}, maps=maps)
        flown = flight.Flight(launch)
        self.assert_commands_within_limits(flown)
        self.assertEqual(flown.summary["missed_commands"], 0)
        for status in flown.statuses:
            self.assertEqual(status.status, OPTIMAL, status.text)
        numbers = os.path.join(self.folder, name + ".json")
        command = [find_node("calibration", "validate_bag")[0], "--bag", launch.bag, "--json", numbers, "--map"]
        command += [os.path.join(maps, "multirotor_%s.map" % axis) for axis in flight.AXES]
        replay = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        self.assertEqual(replay.returncode, 0, replay.stdout)
        with open(numbers) as file:
            report = json.load(file)
        # Simulated time runs as fast as the machine does, so the recorder may be late.
        self.assertEqual([text for text in report["warnings"] if "the recorder's clock" not in text], [])
        self.assertEqual(report["broken"], [])
        self.assertEqual(report["status"]["differing"], 0)
        self.assertEqual(report["coverage"], 1.0)
        return flown, report

    def assert_commands_within_limits(self, flown):
        for command in flown.commands:
            for angle in (command.roll, command.pitch):
                self.assertTrue(abs(angle) <= ANGLE_MAX, command)
            self.assertTrue(abs(command.yaw_rate) <= YAW_RATE_MAX, command)
            self.assertTrue(THRUST_MIN <= command.thrust.z <= THRUST_MAX, command)
        self.assertEqual(flown.summary["cut_commands"], 0)
        self.assertEqual(flown.summary["ignored_commands"], 0)

    def test_tracks_the_figure_within_a_few_centimetres(self):
        flown = self.fly("demo")
        self.assertLess(flown.rms(), 0.05)
        self.assertLess(flown.rms(5.0, FIGURE_END), 0.03)
        speeds = [
            math.hypot(m.twist.twist.linear.x, m.twist.twist.linear.y, m.twist.twist.linear.z) for m in flown.truth
        ]
        self.assertGreater(max(speeds), 2.0)
        self.assert_commands_within_limits(flown)
        for status in flown.statuses:
            self.assertEqual(status.status, OPTIMAL, status.text)
        # The push at the end brings the inputs to their bounds, and other regions into play.
        self.assertAlmostEqual(max(abs(command.pitch) for command in flown.commands), 0.4363323, places=6)
        self.assertGreater(len({status.longitudinal.region for status in flown.statuses}), 2)

    def test_the_laws_that_solve_online_track_as_well(self):
        explicit = self.fly("demo")
        for law in ("linear", "nonlinear"):
            flown = self.fly(law, law=law)
            self.assertLessEqual(flown.rms(), explicit.rms() + 1e-6, law)
            self.assert_commands_within_limits(flown)
            self.assertEqual(flown.summary["missed_commands"], 0)
            for status in flown.statuses:
                self.assertEqual(status.status, OPTIMAL, status.text)

    def test_maps_that_look_ahead_fly_and_are_replayed(self):
        texts = {axis: problem_text("look_ahead/" + axis) for axis in flight.AXES}
        flown, _ = self.fly_and_replay("look_ahead", texts)
        self.assertLess(flown.rms(), 0.05)
        ahead = [status.lateral.theta[5] for status in flown.statuses]
        self.assertGreater(max(ahead) - min(ahead), 0.02)

    def test_a_map_with_a_soft_bound_flies_and_is_replayed(self):
        flown, _ = self.fly_and_replay("soft", {"lateral": problem_text("lateral_speed_limit")})
        self.assertLess(flown.rms(), 0.05)
        self.assertEqual(len(flown.statuses[0].lateral.theta), 6)

    def test_maps_of_second_order_loops_fly_and_are_replayed(self):
        flown, _ = self.fly_and_replay("second_order", {axis: second_order(axis) for axis in flight.AXES[:2]})
        self.assertLess(flown.rms(), 0.05)
        self.assertEqual(len(flown.statuses[0].longitudinal.theta), 6)

    def test_every_odometry_has_its_command_and_nothing_is_lost(self):
        flown = self.fly("demo")
        stamps = [message.header.stamp for message in flown.odometry]
        self.assertGreaterEqual(len(stamps), 4970)
        self.assertEqual(stamps, sorted(set(stamps)))
        self.assertEqual(stamps, [message.header.stamp for message in flown.commands])
        self.assertEqual(stamps, [message.header.stamp for message in flown.statuses])
        self.assertEqual(stamps, [message.header.stamp for message in flown.truth])
        self.assertEqual(flown.summary["samples"], len(stamps))
        self.assertEqual(flown.summary["missed_commands"], 0)

    def assert_same_flight(self, one, other):
        for topic in (
            "/odometry",
            "/command/roll_pitch_yawrate_thrust",
            "/command/trajectory",
            "/ground_truth/odometry",
            "/ground_truth/disturbance",
        ):
            ours, theirs = one.raw[topic], other.raw[topic]
            if ours == theirs:
                continue
            differing = [i for i, pair in enumerate(zip(ours, theirs)) if pair[0] != pair[1]]
            self.fail(
                "the flights differ in %s: %d and %d messages, of which %d differ, the first is %s; %s said:\n%s"
                % (topic, len(ours), len(theirs), len(differing), differing[:1], other.name, other.output)
            )
        # The status also tells wall times, which differ.
        self.assertEqual(len(one.statuses), len(other.statuses))
        for first, second in zip(one.statuses, other.statuses):
            for axis in flight.AXES:
                self.assertEqual(getattr(first, axis), getattr(second, axis))

    def test_the_same_seed_gives_the_same_bag(self):
        self.assert_same_flight(self.fly("demo"), self.fly("demo_again"))

    def test_another_seed_gives_another_flight(self):
        other = self.fly("other_seed", seed=2)
        self.assertFalse(self.fly("demo").raw["/odometry"] == other.raw["/odometry"])

    def test_stand_alone_nodes_fly_like_nodelets(self):
        self.assert_same_flight(self.fly("demo"), self.fly("stand_alone", nodelets="false"))

    def test_constant_wind_leaves_no_offset(self):
        flown = self.fly("wind", {"plant": {"vehicle": CALM}})
        self.assertLess(flown.mean_offset(DURATION - 3.0, DURATION), 0.001)

    def test_without_the_disturbance_estimate_the_wind_leaves_an_offset(self):
        flown = self.fly("offset", {"plant": {"vehicle": CALM}, "controller": {"controller": {"offset_free": False}}})
        self.assertGreater(flown.mean_offset(DURATION - 3.0, DURATION), 0.1)

    def test_recovers_from_odometry_that_is_not_a_number(self):
        flown = self.fly("nan", {"plant": {"faults": {"nan_start": 15.0, "nan_time": 0.5}}})
        self.assert_commands_within_limits(flown)
        self.assertEqual(flown.summary["missed_commands"], 0)
        during = flown.between(flown.statuses, 15.0, 15.5)
        self.assertEqual(len(during), 50)
        for i, status in enumerate(during):
            self.assertEqual(status.reason, NOT_FINITE)
            self.assertEqual(status.status, HOLD_LAST if i < 10 else LEVEL)
        after = flown.between(flown.statuses, 15.5, DURATION)
        self.assertEqual(after[-1].status, OPTIMAL)
        self.assertLess(flown.rms(20.0, FIGURE_END), 0.03)

    def test_silence_levels_the_vehicle_and_ends(self):
        flown = self.fly("silence", {"plant": {"faults": {"silence_start": 15.0, "silence_time": 1.0}}})
        self.assert_commands_within_limits(flown)
        self.assertEqual(flown.between(flown.odometry, 15.0, 16.0), [])
        silent = [s for s in flown.between(flown.statuses, 15.0, 16.0) if s.reason == STALE]
        self.assertGreater(len(silent), 0, "nothing was sent in the silence")
        # Ten control periods make a silence; time in simulation comes in steps, hence the room.
        self.assertLess(flown.time(silent[0]), 15.3)
        self.assertTrue(all(status.status == LEVEL for status in silent))
        # Level is where the vehicle was found to be level; this one is so at commands of zero.
        level = (silent[0].roll_trim, silent[0].pitch_trim)
        self.assertLess(max(abs(angle) for angle in level), 1e-3)
        for command in flown.between(flown.commands, flown.time(silent[0]), 16.0):
            self.assertEqual((command.roll, command.pitch), level)
            self.assertAlmostEqual(command.thrust.z, MASS * GRAVITY, places=6)
        self.assertEqual(flown.statuses[-1].status, OPTIMAL)
        self.assertLess(flown.rms(23.0, FIGURE_END), 0.03)

    def test_a_jump_of_the_odometry_is_not_followed(self):
        flown = self.fly("jump", {"plant": {"faults": {"jump_start": 38.0, "jump_time": 0.1, "jump": [0.0, 5.0, 0.0]}}})
        self.assert_commands_within_limits(flown)
        during = flown.between(flown.statuses, 38.0, 38.1)
        self.assertEqual(len(during), 10)
        for status in during:
            self.assertEqual((status.status, status.reason), (HOLD_LAST, JUMP))
        self.assertEqual(flown.statuses[-1].status, OPTIMAL)
        self.assertLess(flown.rms(38.0, DURATION), 0.1)

    def test_a_jump_that_is_allowed_is_clipped_to_the_map(self):
        flown = self.fly(
            "far",
            {
                "plant": {"faults": {"jump_start": 38.0, "jump_time": 0.1, "jump": [0.0, 5.0, 0.0]}},
                "controller": {"controller": {"jump_distance": 0.0, "solve_outside": False}},
            },
        )
        self.assert_commands_within_limits(flown)
        for status in flown.between(flown.statuses, 38.0, 38.1):
            self.assertEqual(status.status, CLIPPED)
            self.assertEqual(status.lateral.outside_parameter, "e_p_y")
        self.assertEqual(flown.statuses[-1].status, OPTIMAL)
        self.assertLess(flown.rms(DURATION - 1.0, DURATION), 0.1)

    def test_a_map_of_another_axis_is_refused(self):
        swapped = os.path.join(self.folder, "swapped")
        os.mkdir(swapped)
        names = dict(zip(flight.AXES, ("lateral", "longitudinal", "vertical")))
        for axis, source in names.items():
            shutil.copy(
                os.path.join(flight.maps_folder(), "multirotor_%s.map" % source),
                os.path.join(swapped, "multirotor_%s.map" % axis),
            )
        launch = flight.Launch(self.folder, "swapped_maps", maps=swapped)
        self.assertFalse(os.path.exists(launch.bag), "it flew with the wrong maps")
        self.assertIn("multirotor_longitudinal.map", launch.output)
        self.assertIn("does not start", launch.output)


if __name__ == "__main__":
    rosunit.unitrun("polyfly_test", "flights", FlightTest)
