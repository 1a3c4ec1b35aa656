#!/usr/bin/env python3
"""The minimum-peak robust MPC of the ASLquad over real topics: robust.launch."""

import json
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

OPTIMAL, LEAST_VIOLATION = 0, 10  # ControllerStatus.status
DECISION = 8  # samples of 0.01 s in the maps' 0.08 s


class RobustFlightTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="polyfly_robust_")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def launch(self, name, overrides=None, **arguments):
        return flight.Launch(self.folder, name, overrides, launch="robust.launch", **arguments)

    def test_flies_the_figure_in_turbulent_wind(self):
        flown = flight.Flight(self.launch("wind"))
        self.assertLess(flown.rms(), 0.03)
        self.assertLess(max(abs(value) for error in flown.errors() for value in error), 0.06)
        for status in flown.statuses:
            self.assertEqual(status.status, OPTIMAL, status.text)
        self.assertEqual(flown.summary["missed_commands"], 0)
        self.assertEqual(flown.summary["cut_commands"], 0)
        self.assertGreater(len({status.lateral.region for status in flown.statuses}), 2)
        # It decides each 0.08 s, and every odometry has its command all the same.
        self.assertEqual(len(flown.commands), len(flown.odometry))
        inputs = [status.lateral.input for status in flown.statuses]
        changes = [i for i in range(1, len(inputs)) if inputs[i] != inputs[i - 1]]
        self.assertGreater(len(changes), len(inputs) // (2 * DECISION))
        self.assertEqual({i % DECISION for i in changes}, {0})

    def test_carries_a_slung_load_that_is_hit(self):
        load = {"mass": 0.16, "length": 0.65, "hit": [1.0, 1.5, 0.0], "hit_start": 3.0, "hit_time": 0.1}
        flown = flight.Flight(
            self.launch(
                "load",
                {
                    "plant": {"vehicle": {"load": load, "air_velocity": [0.0, 0.0, 0.0], "turbulence_sigma": [0.0] * 3}},
                    "controller": {"vehicle": {"mass": 0.81}},
                },
            )
        )
        self.assertLess(flown.rms(), 0.03)
        self.assertLess(max(abs(value) for error in flown.errors() for value in error), 0.1)

    def test_a_push_beyond_the_range_ends_and_is_replayed(self):
        push = {"kick": [0.0, 6.0, 0.0], "kick_start": 1.0, "kick_time": 0.4}  # to 2.4 m/s, and the bound is 1.5 m/s
        launch = self.launch("push", {"plant": {"vehicle": push}, "player": {"figure": {"laps": 1, "hold_time": 2.0}}})
        flown = flight.Flight(launch)
        statuses = [status.status for status in flown.statuses]
        self.assertLessEqual(set(statuses), {OPTIMAL, LEAST_VIOLATION})
        self.assertGreaterEqual(statuses.count(LEAST_VIOLATION), DECISION)
        self.assertEqual(statuses[-1], OPTIMAL)
        numbers = os.path.join(self.folder, "push.json")
        maps = [os.path.join(flight.maps_folder(), "aslquad_%s.map" % axis) for axis in flight.AXES]
        replay = subprocess.run(
            [find_node("calibration", "validate_bag")[0], "--bag", launch.bag, "--json", numbers, "--min-coverage", "0.8", "--map"]
            + maps,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        self.assertEqual(replay.returncode, 0, replay.stdout)
        self.assertIn("least_violation %d. Recorded" % statuses.count(LEAST_VIOLATION), replay.stdout)
        with open(numbers) as file:
            report = json.load(file)
        self.assertEqual(report["status"]["differing"], 0)
        for what in ("recorded", "replayed"):
            self.assertEqual(report["status"][what]["least_violation"], statuses.count(LEAST_VIOLATION))

    def test_a_period_that_does_not_divide_the_sampling_time_is_refused(self):
        launch = self.launch("period", {"controller": {"controller": {"control_period": 0.03}}})
        self.assertFalse(os.path.exists(launch.bag), "it flew")
        self.assertIn("does not start", launch.output)
        self.assertIn("controller/control_period", launch.output)


if __name__ == "__main__":
    rosunit.unitrun("polyfly_test", "robust_flights", RobustFlightTest)
