#!/usr/bin/env python3
"""The exciting node against the plant, and the coverage that is kept while flying."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import rosbag
import roslib.packages
import rospy
import rosunit
from diagnostic_msgs.msg import DiagnosticArray
from mav_msgs.msg import RollPitchYawrateThrust
from sensor_msgs.msg import Joy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import flight  # noqa: E402

PLAN = """rest: 2
manoeuvres:
  - {shape: 2-1-1, channels: [roll, pitch], amplitudes: 0.15}
  - {shape: 2-1-1, channels: yaw_rate, amplitudes: 0.4, both_signs: false, unit_time: 0.2}
"""
DURATION = 6 * 2.0 + 4 * 1.6 + 0.8  # of the plan [s]


class CalibrationTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("calibration_test")
        cls.folder = tempfile.mkdtemp(prefix="polyfly_calibration_")
        cls.plan = os.path.join(cls.folder, "plan.yaml")
        with open(cls.plan, "w") as file:
            file.write(PLAN)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def excite(self, name, **arguments):
        """The messages of a flight by topic; `arguments` go to excite_demo.launch."""
        bag = os.path.join(self.folder, name + ".bag")
        command = ["roslaunch", "polyfly_launch", "excite_demo.launch", "bag:=" + bag, "plan:=" + self.plan]
        arguments.setdefault("duration", DURATION + 1.0)
        command += ["%s:=%s" % item for item in sorted(arguments.items())]
        result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=100, text=True)
        self.assertTrue(os.path.isfile(bag), result.stdout)
        messages = {}
        with rosbag.Bag(bag) as opened:
            for topic, message, _ in opened.read_messages():
                messages.setdefault(topic, []).append(message)
        return messages

    def test_excites_by_the_plan_and_the_bag_is_complete(self):
        flown = self.excite("plan")
        states = [message.data for message in flown["/excitation/state"]]
        self.assertEqual(states[-1], "done")
        self.assertEqual(len([s for s in states if "roll 2-1-1" in s or "pitch 2-1-1" in s]), 4)
        self.assertIn("running: yaw_rate 2-1-1 0.4 rad/s (5 of 5)", states)
        stamps = [message.header.stamp for message in flown["/odometry"]]
        commands = flown["/command/roll_pitch_yawrate_thrust"]
        self.assertEqual(stamps, [message.header.stamp for message in commands])
        start = stamps[0]
        # 2-1-1 of roll: the level of the pulses differs by twice the amplitude.
        at = {round((m.header.stamp - start).to_sec(), 2): m for m in commands}
        self.assertAlmostEqual(at[2.4].roll - at[3.0].roll, 0.3, places=6)
        self.assertAlmostEqual(at[2.4].roll, at[3.4].roll, places=9)
        heights = [m.pose.pose.position.z for m in flown["/odometry"]]
        self.assertLess(max(heights) - min(heights), 0.4)

    def test_aborts_at_a_limit(self):
        overrides = os.path.join(self.folder, "narrow.yaml")
        with open(overrides, "w") as file:
            file.write("excite: {limits: {attitude_max: 0.08}}\n")
        flown = self.excite("narrow", overrides=overrides, duration=8)
        self.assertEqual(flown["/excitation/state"][-1].data, "aborted: attitude")
        last = flown["/command/roll_pitch_yawrate_thrust"][-1]
        self.assertLess(abs(last.roll), 0.1)

    def test_a_stick_takes_the_vehicle_over(self):
        # At rest until the first command, then moved to and fro: whichever the node hears first, the next one differs.
        sticks = rospy.Publisher("joy", Joy, queue_size=1)
        flying = threading.Event()
        command = rospy.Subscriber("command/roll_pitch_yawrate_thrust", RollPitchYawrateThrust, lambda _: flying.set())
        overrides = os.path.join(self.folder, "slow.yaml")
        with open(overrides, "w") as file:
            file.write("plant: {real_time_factor: 2.0, command_timeout: 0.02, start_timeout: 30}\n")
        over = threading.Event()

        def push():
            moved = False
            while not over.wait(0.05):
                moved = flying.is_set() and not moved
                sticks.publish(Joy(axes=[0.0, 0.8 if moved else 0.0, 0.0, 0.0]))

        thread = threading.Thread(target=push)
        thread.start()
        try:
            flown = self.excite("stick", overrides=overrides, duration=14)
        finally:
            over.set()
            thread.join()
            command.unregister()
        self.assertEqual(flown["/excitation/state"][-1].data, "handed over: a stick was moved")
        self.assertLess(len(flown["/command/roll_pitch_yawrate_thrust"]), len(flown["/odometry"]))

    def test_coverage_is_kept_while_flying(self):
        maps = {axis: os.path.join(flight.maps_folder(), "multirotor_%s.map" % axis) for axis in flight.AXES}
        rospy.set_param("coverage", {"maps": maps, "period": 0.1})
        told = []
        subscriber = rospy.Subscriber("coverage", DiagnosticArray, told.append)
        program = roslib.packages.find_node("calibration", "coverage")[0]
        node = subprocess.Popen([program, "__name:=coverage"])
        try:
            launch = flight.Launch(self.folder, "covered", {"plant": {"real_time_factor": 8.0}})
            flown = flight.Flight(launch)
            time.sleep(1.0)
        finally:
            node.send_signal(signal.SIGINT)
            node.wait(20)
            subscriber.unregister()
        for axis, status in zip(flight.AXES, told[-1].status):
            kept = {pair.key: float(pair.value) for pair in status.values if pair.key != "edge_parameter"}
            regions = {getattr(status, axis).region for status in flown.statuses}
            self.assertEqual(status.name, "coverage: " + axis)
            self.assertGreaterEqual(kept["samples"], 0.98 * len(flown.statuses))
            self.assertLessEqual(kept["samples"], len(flown.statuses))
            self.assertEqual(kept["share_inside"], 1.0)
            self.assertTrue(1 <= kept["regions_visited"] <= min(kept["regions"], len(regions)))


if __name__ == "__main__":
    rosunit.unitrun("polyfly_test", "calibration", CalibrationTest)
