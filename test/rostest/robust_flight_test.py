#!/usr/bin/env python3
"""The minimum-peak robust MPC of the ASLquad over real topics: robust.launch."""

import os
import shutil
import sys
import tempfile
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import flight  # noqa: E402

OPTIMAL = 0  # ControllerStatus.status
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

    def test_a_period_that_does_not_divide_the_sampling_time_is_refused(self):
        launch = self.launch("period", {"controller": {"controller": {"control_period": 0.03}}})
        self.assertFalse(os.path.exists(launch.bag), "it flew")
        self.assertIn("does not start", launch.output)
        self.assertIn("controller/control_period", launch.output)


if __name__ == "__main__":
    rosunit.unitrun("polyfly_test", "robust_flights", RobustFlightTest)
