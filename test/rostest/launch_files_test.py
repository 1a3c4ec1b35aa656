#!/usr/bin/env python3
"""The launch files of the multirotor: each names programs, files and parameters that are there, and starts its law."""

import os
import subprocess
import tempfile
import unittest

import rospkg
import rospy
import rostest
from roslib.packages import find_node
from roslaunch.config import load_config_default
from std_msgs.msg import String

from flight import Flight, Launch, maps_folder

LAUNCH = rospkg.RosPack().get_path("polyfly_launch")
PATIENCE = 20.0  # [s]


def load(name, **arguments):
    arguments = ["%s:=%s" % item for item in arguments.items()]
    return load_config_default([(os.path.join(LAUNCH, name), arguments)], None, verbose=False)


class LaunchFilesTest(unittest.TestCase):
    def check(self, name, **arguments):
        config = load(name, **arguments)
        self.assertEqual(config.config_errors, [], name)
        for node in config.nodes:
            self.assertTrue(find_node(node.package, node.type), "%s: %s/%s" % (name, node.package, node.type))
        return {key: parameter.value for key, parameter in config.params.items()}

    def test_each_file_names_what_is_there(self):
        maps = maps_folder()
        parameters = self.check("multirotor_explicit.launch", maps_dir=maps)
        self.assertEqual(parameters["/controller/maps/lateral"], maps + "/multirotor_lateral.map")
        self.assertEqual(self.check("multirotor_linear.launch")["/controller/law"], "linear")
        self.assertNotIn("/controller/maps/lateral", self.check("multirotor_nonlinear.launch"))
        parameters = self.check("multirotor_mavros.launch", hover_thrust=0.42, thrust_polynomial="[0.0, 0.02]")
        self.assertEqual(parameters["/controller/output/thrust_polynomial"], [0.0, 0.02])
        self.assertEqual(parameters["/controller/output/hover_thrust"], 0.42)
        self.check("demo.launch", maps_dir=maps)
        self.check("compare_laws.launch", maps_dir=maps)

    def test_each_law_starts(self):
        for name, arguments, law in (
                ("multirotor_explicit.launch", {"maps_dir": maps_folder()}, "explicit_linear"),
                ("multirotor_linear.launch", {}, "linear"), ("multirotor_nonlinear.launch", {}, "nonlinear"),
                ("multirotor_mavros.launch", {"law": "linear", "hover_thrust": 0.4}, "linear")):
            command = ["roslaunch", "polyfly_launch", name] + ["%s:=%s" % item for item in arguments.items()]
            with tempfile.TemporaryFile("w+") as log:
                process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
                try:
                    active = rospy.wait_for_message("/active_law", String, PATIENCE).data
                    self.assertEqual(active, law, name)
                finally:
                    process.terminate()
                    process.wait(PATIENCE)

    def test_all_laws_say_what_they_would_command_on_the_same_flight(self):
        with tempfile.TemporaryDirectory() as folder:
            flight = Flight(Launch(folder, "compare", launch="compare_laws.launch", real_time_factor=10))
            flown = {c.header.stamp: c for c in flight.commands}
            self.assertGreater(len(flown), 4000)
            for law in ("explicit_linear", "linear", "nonlinear"):
                said = flight.messages["/beside/%s/command/roll_pitch_yawrate_thrust" % law]
                self.assertGreater(len(said), 0.8 * len(flown), law)
                apart = sorted(abs(c.pitch - flown[c.header.stamp].pitch) for c in said if c.header.stamp in flown)
                self.assertLess(apart[len(apart) // 2], 0.1, law)
            self.assertEqual({s.law for s in flight.messages["/beside/nonlinear/controller_status"]}, {"nonlinear"})


if __name__ == "__main__":
    rospy.init_node("launch_files_test", disable_rostime=True)
    rostest.rosrun("polyfly_test", "launch_files", LaunchFilesTest)
