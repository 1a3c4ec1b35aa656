#!/usr/bin/env python3
"""The parameters in force of the lateral guidance: latched topic, and a start from the text. `node` or `nodelet`."""
import unittest

import dynamic_reconfigure.client
import rospy
import rostest
import yaml
from std_msgs.msg import String

from lateral_nmpc_test import PATIENCE, VARIANT, Collector, Guidance


class LateralInForceTest(unittest.TestCase):
    def test_tells_the_parameters_in_force(self):
        guidance = Guidance("told_" + VARIANT, {"model/a0": 11.5, "provenance": "model/a0 from roll.yaml", "path/loiter_direction": -1})
        self.addCleanup(guidance.stop)
        texts = Collector(guidance.namespace + "/guidance/parameters_in_force", String)
        text = texts.wait(lambda m: True).data
        self.assertIn("  a0: 11.5  # [1/s^2] 0.1 .. 10000\n", text)
        told = yaml.safe_load(text)
        self.assertEqual((told["in_force"]["vehicle"], told["in_force"]["change"]), ("fixed_wing", "start"))
        self.assertEqual((told["provenance"], told["path"]["loiter_direction"]), ("model/a0 from roll.yaml", -1))
        client = dynamic_reconfigure.client.Client(guidance.namespace + "/guidance", timeout=PATIENCE)
        self.addCleanup(client.close)
        client.update_configuration({"weights_track": 0.02})
        changed = yaml.safe_load(texts.wait(lambda m: "reconfigure" in m.data).data)
        self.assertEqual(changed["weights"]["track"], 0.02)
        # It starts the same guidance again, without a complaint.
        again = Guidance("again_" + VARIANT, changed)
        self.addCleanup(again.stop)
        repeated = yaml.safe_load(Collector(again.namespace + "/guidance/parameters_in_force", String).wait(lambda m: True).data)
        self.assertEqual({k: v for k, v in repeated.items() if k != "in_force"},
                         {k: v for k, v in changed.items() if k != "in_force"})


if __name__ == "__main__":
    rospy.init_node("lateral_in_force_test")
    rostest.rosrun("fixedwing_lateral", "lateral_in_force_" + VARIANT, LateralInForceTest)
