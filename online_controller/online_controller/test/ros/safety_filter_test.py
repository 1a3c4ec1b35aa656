#!/usr/bin/env python3
"""The safety filter on real topics, as node and as nodelet. Launched by safety_filter.test with the argument node or nodelet."""

import math
import sys

import rospy
import rostest
from mav_msgs.msg import RollPitchYawrateThrust
from nav_msgs.msg import Odometry
from online_controller.msg import CommandFilterStatus

import node_or_nodelet
from controller_process import HOVER, MapsFixture
from node_or_nodelet import VARIANT


class Filter(node_or_nodelet.Program):
    def __init__(self, namespace, parameters):
        command = node_or_nodelet.command_line("online_controller", "safety_filter_node", "SafetyFilter")
        super().__init__(command, namespace, "safety_filter", parameters)
        self.odometry = self.publisher("odometry", Odometry)
        self.wish = self.publisher("wished/roll_pitch_yawrate_thrust", RollPitchYawrateThrust)
        self.commands = self.collector("command/roll_pitch_yawrate_thrust", RollPitchYawrateThrust)
        self.statuses = self.collector("filter_status", CommandFilterStatus)

    def send_odometry(self, x):
        odometry = Odometry()
        odometry.header.frame_id = "world"
        odometry.header.stamp = rospy.Time.now()
        odometry.pose.pose.orientation.w = 1.0
        odometry.pose.pose.position.x = x
        self.odometry.publish(odometry)

    def send_wish(self, roll, pitch):
        wish = RollPitchYawrateThrust()
        wish.header.stamp = rospy.Time.now()
        wish.roll, wish.pitch, wish.yaw_rate = roll, pitch, 0.3
        wish.thrust.z = HOVER
        self.wish.publish(wish)
        return wish.header.stamp

    def exchange(self, roll=0.0, pitch=0.0, x=0.0, accept=lambda status: True):
        """Sends odometry, then a wish, until command and status with its stamp have come and the status is accepted."""
        def ask():
            if x is not None:
                self.send_odometry(x)
                rospy.sleep(0.05)  # another topic: nothing orders the two
            stamp = self.send_wish(roll, pitch)
            status = self.statuses.wait(lambda m: m.header.stamp == stamp, node_or_nodelet.RETRY)
            command = self.commands.wait(lambda m: m.header.stamp == stamp, node_or_nodelet.RETRY)
            return (command, status) if status and command and accept(status) else None

        return self.answer(ask)


class SafetyFilterTest(MapsFixture):
    def filter(self, **parameters):
        # Patience with a slow machine, except where silence is the subject.
        chosen = {"maps/x": self.folder.name + "/fence.map", "silence_periods": 100.0, "stale_periods": 100.0}
        chosen.update(parameters)
        program = Filter(self.id().split(".")[-1], chosen)
        self.addCleanup(program.stop)
        return program

    def test_passes_and_changes(self):
        program = self.filter()
        command, status = program.exchange(roll=0.01, pitch=0.02,
                                           accept=lambda s: s.status == CommandFilterStatus.PASSED)
        self.assertEqual((command.roll, command.pitch, command.yaw_rate, command.thrust.z), (0.01, 0.02, 0.3, HOVER))
        self.assertAlmostEqual(status.x.wish, 9.8066 * math.sin(0.02) * math.cos(0.01))
        self.assertEqual(status.text, "passed")

        command, status = program.exchange(pitch=0.5)
        self.assertEqual(status.status, CommandFilterStatus.CHANGED)
        self.assertEqual(status.x.input, 2.0)
        self.assertEqual(status.y.status, CommandFilterStatus.PASSED)
        self.assertAlmostEqual(command.pitch, math.atan2(2.0, 9.8066 * math.cos(0.5)))
        self.assertEqual(command.yaw_rate, 0.3)

    def test_outside_it_sends_the_least_violation_and_says_so(self):
        program = self.filter()
        command, status = program.exchange(x=3.0, accept=lambda s: s.status == CommandFilterStatus.OUTSIDE)
        self.assertAlmostEqual(status.x.input, -2.0)
        self.assertLess(command.pitch, -0.1)
        self.assertIn("least violation", status.text)

    def test_a_wish_that_is_no_number_levels(self):
        command, status = self.filter().exchange(roll=math.nan, accept=lambda s: s.status == CommandFilterStatus.NO_WISH)
        self.assertAlmostEqual(command.roll, 0.0)
        self.assertAlmostEqual(command.thrust.z, HOVER)

    def test_without_odometry_the_failsafe_policy_answers(self):
        command, status = self.filter().exchange(pitch=0.1, x=None)
        self.assertEqual(status.status, CommandFilterStatus.NO_STATE)
        self.assertEqual(status.text, "no odometry to filter by: level attitude, hover thrust")
        self.assertEqual(command.pitch, 0.0)

    def test_a_silent_controller_is_replaced(self):
        program = self.filter(silence_periods=2.0)
        program.exchange()
        seen = len(program.statuses.messages)
        status = program.statuses.wait(lambda m: m.status == CommandFilterStatus.NO_WISH, since=seen)
        self.assertIsNotNone(status)

    def test_refuses_another_map(self):
        program = self.filter(**{"maps/x": self.maps["lateral"]})
        output = program.output_at_end()
        self.assertNotEqual(program.process.returncode, 0)
        self.assertIn("must be of type safety_filter", output)


if __name__ == "__main__":
    rospy.init_node("safety_filter_test")
    rostest.rosrun("online_controller", "safety_filter_" + VARIANT, SafetyFilterTest, sys.argv)
