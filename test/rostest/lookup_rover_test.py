#!/usr/bin/env python3
"""A rover turns by the look-up node alone: its map is solved, its heading simulated, and every number goes over topics.
Launched by lookup_rover.test."""

import math
import os
import subprocess
import sys
import tempfile
import threading
import unittest

import rospy
import rostest
from online_controller.msg import LookupStatus
from roslib.packages import find_node
from std_msgs.msg import Float64

LAG, LIMIT = 0.3, 0.8  # of the turn rate [s]; of its command [rad/s]
PERIOD = 0.1           # [s]
TURN = math.pi / 2
STEPS = 80
PATIENCE = 20.0
PROBLEM = """polyfly_problem: 1
name: rover_heading
type: tracking_mpc
model:
  states: [{name: psi, unit: rad}, {name: r, unit: rad/s}]
  inputs: [{name: r_cmd, unit: rad/s, range: [-%(limit)r, %(limit)r]}]
  A: [[0, 1], [0, %(pole)r]]
  B: [[0], [%(gain)r]]
  C: [[1, 0]]
sampling_time: %(period)r
horizon: 8
weights: {Q: [8, 0.5], R: [0.5], R_delta: [2], terminal: riccati}
parameters:
  - {name: e_psi, role: error, of: psi, unit: rad, range: [-3.2, 3.2]}
  - {name: e_r, role: error, of: r, unit: rad/s, range: [-1, 1]}
  - {name: r_cmd_prev, role: previous_input, of: r_cmd, unit: rad/s, range: [-%(limit)r, %(limit)r]}
""" % {"limit": LIMIT, "pole": -1 / LAG, "gain": 1 / LAG, "period": PERIOD}


class RoverTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        problem, chart = (os.path.join(self.folder.name, "rover." + end) for end in ("yaml", "map"))
        with open(problem, "w") as file:
            file.write(PROBLEM)
        subprocess.run([find_node("offline_mpt", "offline_mpt")[0], "solve", problem, "-o", chart], check=True)
        rospy.set_param("/rover/lookup", {"map": chart, "stale_periods": 1000.0, "sources": {"r_cmd_prev": "last/r_cmd"}})
        node = subprocess.Popen([find_node("online_controller", "lookup_node")[0], "__ns:=/rover", "__name:=lookup"])
        self.addCleanup(node.wait)
        self.addCleanup(node.terminate)
        self.heading = rospy.Publisher("/rover/e_psi", Float64, queue_size=1)
        self.rate = rospy.Publisher("/rover/e_r", Float64, queue_size=1)
        self.came = threading.Condition()
        self.status = None
        rospy.Subscriber("/rover/lookup_status", LookupStatus, self.take)

    def take(self, status):
        with self.came:
            self.status = status
            self.came.notify_all()

    def command(self, psi, r):
        """Of the map at these numbers; the rate is sent first, and both again until the answer is theirs."""
        def is_theirs():
            return self.status is not None and tuple(self.status.parameters[:2]) == (psi - TURN, r)

        end = rospy.Time.now() + rospy.Duration.from_sec(PATIENCE)
        while rospy.Time.now() < end:
            self.rate.publish(Float64(r))
            rospy.sleep(0.002)
            self.heading.publish(Float64(psi - TURN))
            with self.came:
                if self.came.wait_for(is_theirs, 0.2):
                    self.assertEqual(self.status.status, LookupStatus.INSIDE)
                    return self.status.inputs[0]
        self.fail("no answer")

    def test_turns_within_its_limit(self):
        decay = math.exp(-PERIOD / LAG)
        psi = r = 0.0
        for _ in range(STEPS):
            u = self.command(psi, r)
            self.assertLessEqual(abs(u), LIMIT)
            psi += PERIOD * u + LAG * (1 - decay) * (r - u)
            r = u + decay * (r - u)
        self.assertAlmostEqual(psi, TURN, delta=0.01)
        self.assertAlmostEqual(r, 0.0, delta=0.01)


if __name__ == "__main__":
    rospy.init_node("lookup_rover_test")
    rostest.rosrun("polyfly_test", "lookup_rover", RoverTest, sys.argv)
