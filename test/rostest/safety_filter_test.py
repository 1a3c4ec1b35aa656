#!/usr/bin/env python3
"""The node of the safety filter between a controller that runs into the fence and a plant, and the replay of that flight.

The partner is plant and controller: it steps when the command of the step before has come, so no result depends on time.
"""

import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import rosbag
import rospy
import rosunit
from mav_msgs.msg import RollPitchYawrateThrust
from nav_msgs.msg import Odometry
from online_controller.msg import CommandFilterStatus
from roslib.packages import find_node

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import flight  # noqa: E402

PERIOD = 0.05  # of the map [s]
STEPS = 200
MASS, GRAVITY = 1.52, 9.8066
POSITION_LIMIT, SPEED_LIMIT = 4.0, 2.0  # of fence_x.yaml [m], [m/s]
POSITION_ERROR, SPEED_ERROR, WIND = 0.01, 0.02, 0.8  # that it allows for [m], [m/s], [m/s^2]
PITCH = 0.25  # that is wished, forward and then backward [rad]
PATIENCE = 60.0  # for one step [s]
RETRY = 0.5  # until messages count as lost, while connections are being made [s]
SPACE = "/fenced"


class Partner:
    """Sends odometry and wish, and waits for the node's answer to both."""

    def __init__(self):
        self.changed = threading.Condition()
        self.answers = {}  # command and status by stamp
        self.tries = 0
        self.odometry = rospy.Publisher(SPACE + "/odometry", Odometry, queue_size=10)
        self.wish = rospy.Publisher(SPACE + "/wished/roll_pitch_yawrate_thrust", RollPitchYawrateThrust, queue_size=10)
        rospy.Subscriber(SPACE + "/command/roll_pitch_yawrate_thrust", RollPitchYawrateThrust, self.take)
        rospy.Subscriber(SPACE + "/filter_status", CommandFilterStatus, self.take)

    def take(self, message):
        with self.changed:
            self.answers.setdefault(message.header.stamp, {})[type(message)] = message
            self.changed.notify_all()

    def exchange(self, position, velocity, pitch):
        """The messages of the step. Of two topics any may come first: asked again until the filter used this odometry."""
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            self.tries += 1
            stamp = rospy.Time.from_sec(100.0) + rospy.Duration.from_sec(PERIOD) * self.tries
            odometry, wish = Odometry(), RollPitchYawrateThrust()
            odometry.header.stamp = wish.header.stamp = stamp
            odometry.pose.pose.orientation.w = 1.0
            odometry.pose.pose.position.x, odometry.twist.twist.linear.x = position, velocity
            wish.pitch, wish.thrust.z = pitch, MASS * GRAVITY / math.cos(pitch)
            self.odometry.publish(odometry)
            self.wish.publish(wish)
            with self.changed:
                self.changed.wait_for(lambda: len(self.answers.get(stamp, {})) == 2, RETRY)
            answer = self.answers.get(stamp, {})
            if len(answer) == 2:
                status = answer[CommandFilterStatus]
                if (status.x.position, status.x.velocity) == (position, velocity):
                    return odometry, wish, answer[RollPitchYawrateThrust], status
        raise AssertionError("no answer to odometry and wish")


class SafetyFilterLoopTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("safety_filter_test")
        cls.folder = tempfile.mkdtemp(prefix="polyfly_filter_")
        cls.map = os.path.join(cls.folder, "fence_x.map")
        problem = flight.problem_path("safety/fence_x")
        subprocess.run([find_node("offline_mpt", "offline_mpt")[0], "solve", problem, "-o", cls.map], check=True)
        rospy.set_param(SPACE + "/safety_filter", {"maps": {"x": cls.map}, "silence_periods": 100.0, "stale_periods": 100.0})
        cls.node = subprocess.Popen([find_node("online_controller", "safety_filter_node")[0], "__ns:=" + SPACE, "__name:=safety_filter"])

    @classmethod
    def tearDownClass(cls):
        cls.node.terminate()
        cls.node.wait()
        shutil.rmtree(cls.folder)

    def fly(self, bag):
        """Position and speed after each step, and the messages' statuses. Wind and errors are as great as the map allows for."""
        partner, source = Partner(), random.Random(3)
        p = v = 0.0
        states, statuses = [], []
        for k in range(STEPS):
            messages = partner.exchange(p + POSITION_ERROR * source.choice((-1, 1)), v + SPEED_ERROR * source.choice((-1, 1)),
                                        PITCH if k < STEPS // 2 else -PITCH)
            _, _, command, status = messages
            for topic, message in zip(("odometry", "wished/roll_pitch_yawrate_thrust", "command/roll_pitch_yawrate_thrust", "filter_status"),
                                      messages):
                bag.write(SPACE + "/" + topic, message, rospy.Time.from_sec(100.0) + rospy.Duration.from_sec(PERIOD) * k)
            a = command.thrust.z / MASS * math.sin(command.pitch) + WIND * source.choice((-1, 1))
            p, v = p + PERIOD * v + 0.5 * PERIOD * PERIOD * a, v + PERIOD * a
            states.append((p, v))
            statuses.append(status.status)
        return states, statuses

    def test_stays_inside_and_is_replayed_as_it_flew(self):
        path = os.path.join(self.folder, "flight.bag")
        with rosbag.Bag(path, "w") as bag:
            states, statuses = self.fly(bag)
        self.assertLessEqual(max(abs(p) for p, _ in states), POSITION_LIMIT)
        self.assertLessEqual(max(abs(v) for _, v in states), SPEED_LIMIT)
        # It went to both ends, and did not get there by itself.
        self.assertGreater(max(p for p, _ in states), 0.7 * POSITION_LIMIT)
        self.assertLessEqual(set(statuses), {CommandFilterStatus.PASSED, CommandFilterStatus.CHANGED})
        self.assertGreater(statuses.count(CommandFilterStatus.CHANGED), 50)
        replay = subprocess.run([find_node("calibration", "validate_filter")[0], "--strict", "--bag", path, "--map", self.map],
                                stdout=subprocess.PIPE, universal_newlines=True)
        self.assertIn("0  recorded answers that differ, of %d\n" % STEPS, replay.stdout)
        self.assertEqual(replay.returncode, 0, replay.stdout)


if __name__ == "__main__":
    rosunit.unitrun("polyfly_test", "safety_filter_loop", SafetyFilterLoopTest, sys.argv)
