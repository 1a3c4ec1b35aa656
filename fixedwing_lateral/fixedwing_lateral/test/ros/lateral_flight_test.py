#!/usr/bin/env python3
"""A flight in simulated time: `node` or `nodelet` against an aircraft that it does not know, in lock step."""
import os
import subprocess
import sys
import threading
import unittest

import rospkg
import rospy
import rostest
from fixedwing_lateral.msg import LateralStatus, Mission
from geometry_msgs.msg import Pose
from roslib.packages import find_node

sys.path.insert(0, os.path.join(rospkg.RosPack().get_path("online_controller"), "test", "ros"))
from node_or_nodelet import VARIANT, command_line  # noqa: E402

PATIENCE = 120.0  # for the whole flight, in wall time [s]


class Flight(unittest.TestCase):
    def run_program(self, command):
        process = subprocess.Popen(command)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        return process

    def test_a_corner_and_a_loiter_in_wind(self):
        self.fly("/flight", rigid=False)

    def test_the_same_in_six_degrees_of_freedom_and_gusts(self):
        self.fly("/rigid_flight", rigid=True)

    def fly(self, space, rigid):
        statuses = []
        over = threading.Event()
        loitering = []

        def take(status):
            statuses.append(status)
            if status.loitering and not loitering:
                loitering.append(status.header.stamp)
            if loitering and status.header.stamp > loitering[0] + rospy.Duration(60.0):
                over.set()

        mission = Mission()
        for east, north in ((0.0, 0.0), (0.0, 250.0), (250.0, 250.0)):
            pose = Pose()
            pose.position.x, pose.position.y, pose.orientation.w = east, north, 1.0
            mission.waypoints.append(pose)
        rospy.set_param(space + "/guidance/path/loiter_radius", 80.0)
        subscriber = rospy.Subscriber(space + "/lateral_status", LateralStatus, take)
        publisher = rospy.Publisher(space + "/mission", Mission, queue_size=1, latch=True)
        publisher.publish(mission)
        guidance = self.run_program(command_line("fixedwing_lateral", "lateral_nmpc_node", "LateralNmpc") +
                                    ["__ns:=" + space, "__name:=guidance"])
        plant = self.run_program([find_node("fixedwing_lateral", "lateral_plant_node")[0], "__ns:=" + space,
                                  "_rigid:=%s" % str(rigid).lower()])
        self.assertTrue(over.wait(PATIENCE), "the flight did not come to its end")
        subscriber.unregister()
        for program in (plant, guidance):  # two plants must not both keep the time
            program.terminate()
            program.wait()

        flown = [status.segment for status in statuses if status.mode == LateralStatus.TRACKING]
        self.assertEqual(sorted(set(flown)), [0, 1, 2])
        self.assertEqual(flown, sorted(flown))
        self.assertTrue(all(abs(status.roll_reference) < 0.611 for status in statuses))
        settled = loitering[0] + rospy.Duration(30.0)
        errors = [abs(status.track_error) for status in statuses if status.header.stamp > settled]
        self.assertLess(max(errors), 4.0)


if __name__ == "__main__":
    rospy.init_node("lateral_flight_test")
    rostest.rosrun("fixedwing_lateral", "lateral_flight_" + VARIANT, Flight, sys.argv)
