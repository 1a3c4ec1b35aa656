#!/usr/bin/env python3
"""The parameters in force: the latched topic, at each change, and a start from the text. Launched by
parameters_in_force.test with the argument node or nodelet."""

import os
import subprocess
import unittest

import rospy
import rostest
import yaml
from dynamic_reconfigure.client import Client
from online_controller.srv import SelectLaw, SwapMaps
from std_msgs.msg import String

from controller_process import AXES, Controller, MapsFixture
from node_or_nodelet import PATIENCE, VARIANT, Collector

PROVENANCE = "vehicle/mass from mass.yaml (xxh64:1) of hover.bag (xxh64:2, 2026-01-02)"


def without_node(text):
    """All but the line that tells the node, which is another one's."""
    return [line for line in text.splitlines() if not line.startswith("  node:")]


class ParametersInForceTest(MapsFixture):
    def told(self, controller):
        return self.texts(controller).wait(lambda m: True).data

    def texts(self, controller):
        return Collector(controller.namespace + "/controller/parameters_in_force", String)

    def test_all_that_flies_is_told_with_ranges_and_sources(self):
        controller = self.fly({"vehicle/mass": 1.6, "provenance": PROVENANCE, "use_rc_teleop": True})
        text = self.told(controller)
        self.assertIn("  mass: 1.6  # [kg] 0.01 .. 1000\n", text)
        self.assertIn("  q_attitude: 1.0e-08  # [rad^2] 0 .. 10\n", text)
        parameters = yaml.safe_load(text)
        self.assertEqual(parameters["provenance"], PROVENANCE)
        self.assertEqual(parameters["law"], "explicit_linear")
        self.assertEqual(parameters["maps"], self.maps)
        self.assertIs(parameters["use_rc_teleop"], True)
        self.assertEqual(parameters["KF_observer"]["q_attitude"], 1e-8)
        told = parameters["in_force"]
        self.assertEqual((told["node"], told["vehicle"], told["change"], told["law"]),
                         (controller.namespace + "/controller", "multirotor", "start", "explicit_linear"))
        self.assertEqual(sorted(told["maps"]), sorted(AXES))
        lateral = told["maps"]["lateral"]
        self.assertEqual(lateral["name"], "made")
        self.assertRegex(lateral["problem"], "^xxh64:[0-9a-f]{16}$")
        self.assertEqual(len(lateral["A"]), len(lateral["B"]))
        self.assertNotIn("robust_maps", told)

    def test_each_change_is_published(self):
        controller = self.fly({"law": "linear"})
        texts = self.texts(controller)
        self.assertIn("change: \"start\"", texts.wait(lambda m: True).data)
        options = Client(controller.namespace + "/controller", timeout=PATIENCE)
        self.addCleanup(options.close)
        options.update_configuration({"controller/yaw_gain": 2.5})
        changed = texts.wait(lambda m: "change: \"reconfigure\"" in m.data).data
        self.assertEqual(yaml.safe_load(changed)["controller"]["yaw_gain"], 2.5)
        # Refused as a whole, so nothing is in force that was not.
        options.update_configuration({"controller/thrust_min": 15.0, "controller/yaw_gain": 2.0})
        select = rospy.ServiceProxy(controller.namespace + "/select_law", SelectLaw)
        self.assertTrue(select(law="explicit_linear").success)
        other = yaml.safe_load(texts.wait(lambda m: "change: \"law\"" in m.data).data)
        self.assertEqual((other["law"], other["in_force"]["law"]), ("explicit_linear", "explicit_linear"))
        self.assertEqual(other["controller"]["yaw_gain"], 2.5)
        before = other["in_force"]["maps"]["lateral"]["checksum"]
        firmer = os.path.join(self.folder.name, "firmer.map")
        swap = rospy.ServiceProxy(controller.namespace + "/swap_maps", SwapMaps)
        self.assertTrue(swap(lateral=firmer).success)
        swapped = yaml.safe_load(texts.wait(lambda m: "change: \"region maps\"" in m.data).data)
        self.assertEqual(swapped["maps"]["lateral"], firmer)
        self.assertNotEqual(swapped["in_force"]["maps"]["lateral"]["checksum"], before)
        self.assertEqual(len(texts.messages), 4)

    def test_the_text_starts_the_same_flight(self):
        first = self.fly({"law": "linear", "controller/yaw_gain": 2.25, "provenance": PROVENANCE,
                          "KF_observer/q_position": 3e-7, "output/attitude_target": True,
                          "output/thrust_polynomial": [0.01, 0.03, 1e-5]})
        text = self.told(first)
        with open(os.path.join(self.folder.name, "in_force.yaml"), "w") as file:
            file.write(text)
        again = "/again_" + VARIANT
        subprocess.run(["rosparam", "load", file.name, again + "/controller"], check=True)
        second = Controller(again[1:])
        self.addCleanup(second.stop)
        second.connect()
        self.assertEqual(without_node(self.told(second)), without_node(text))
        second.process.terminate()
        self.assertNotIn("MPC does not know", second.output_at_end())


if __name__ == "__main__":
    rospy.init_node("parameters_in_force_test")
    rostest.rosrun("online_controller", "parameters_in_force_" + VARIANT, ParametersInForceTest)
