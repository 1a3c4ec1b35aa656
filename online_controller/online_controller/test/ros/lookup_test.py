#!/usr/bin/env python3
"""Any map on topics, as node and as nodelet. Launched by lookup.test with the argument node or nodelet."""

import math
import os
import sys

import rospy
import rostest
from nav_msgs.msg import Odometry
from online_controller.msg import LookupStatus
from online_controller.srv import SwapMap
from std_msgs.msg import Float64, Float64MultiArray

import node_or_nodelet
from controller_process import MapsFixture
from node_or_nodelet import VARIANT

# u = 0.3 e_p_y + 0.35 e_v_y - e_phi, of the test's lateral map.
SOURCES = {"sources/e_v_y": "odometry/v_y", "sources/e_phi": "array", "sources/phi_cmd_ref": "array",
           "sources/phi_cmd_prev": "last/phi_cmd"}


class Lookups(node_or_nodelet.Program):
    def __init__(self, namespace, parameters):
        command = node_or_nodelet.command_line("online_controller", "lookup_node", "LookupNodelet")
        super().__init__(command, namespace, "lookup", parameters)
        self.position = self.publisher("e_p_y", Float64)
        self.odometry = self.publisher("odometry", Odometry)
        self.array = self.publisher("parameters", Float64MultiArray)
        self.inputs = self.collector("phi_cmd", Float64)
        self.statuses = self.collector("lookup_status", LookupStatus)

    def exchange(self, position, velocity=0.0, rest=(0.0, 0.0), accept=lambda status: True):
        """Sends all parameters, the first one last, until a status that is accepted has come for that one."""
        def ask():
            odometry = Odometry()
            odometry.pose.pose.orientation.w = 1.0
            odometry.twist.twist.linear.y = velocity
            self.odometry.publish(odometry)
            self.array.publish(Float64MultiArray(data=rest))
            rospy.sleep(0.05)  # other topics: nothing orders them
            seen = len(self.statuses.messages)
            self.position.publish(Float64(position))
            return self.statuses.wait(accept, node_or_nodelet.RETRY, since=seen)

        return self.answer(ask)


class LookupTest(MapsFixture):
    def lookups(self, **parameters):
        # Patience with a slow machine, except where silence is the subject.
        chosen = dict(SOURCES, map=self.maps["lateral"], stale_periods=1000.0)
        chosen.update(parameters)
        program = Lookups(self.id().split(".")[-1], chosen)
        self.addCleanup(program.stop)
        return program

    def test_answers_from_all_sources(self):
        program = self.lookups()
        status = program.exchange(0.5, -0.2, (0.1, 0.0), lambda s: s.status == LookupStatus.INSIDE and s.parameters[2] == 0.1)
        self.assertEqual((status.sent, status.region, status.text), (LookupStatus.ANSWER, 0, "answered by the map"))
        self.assertAlmostEqual(status.inputs[0], 0.3 * 0.5 - 0.35 * 0.2 - 0.1)
        self.assertIsNotNone(program.inputs.wait(lambda m: m.data == status.inputs[0]))
        # The next one has that input as the previous one.
        again = program.exchange(0.5, -0.2, (0.1, 0.0))
        self.assertEqual(again.parameters[3], status.inputs[0])

    def test_without_an_answer_the_last_inputs_then_the_safe_ones(self):
        program = self.lookups(hold_periods=2, **{"safe/phi_cmd": 0.01})
        last = program.exchange(0.5, accept=lambda s: s.status == LookupStatus.INSIDE).inputs
        for kind, position in ((LookupStatus.NOT_FINITE, math.nan), (LookupStatus.OUTSIDE_BOX, 1e6)):
            status = program.exchange(position, accept=lambda s, kind=kind: s.status == kind)
            self.assertIn(status.sent, (LookupStatus.LAST, LookupStatus.SAFE))
            self.assertEqual(status.inputs, last if status.sent == LookupStatus.LAST else (0.01,))
        status = program.exchange(math.nan, accept=lambda s: s.sent == LookupStatus.SAFE)
        self.assertEqual(status.inputs, (0.01,))
        self.assertIn("not finite; the safe inputs are sent", status.text)
        self.assertEqual(program.exchange(0.1, rest=(0.0,), accept=lambda s: s.status != LookupStatus.INSIDE).status,
                         LookupStatus.NOT_FINITE)

    def test_silence_is_told_and_ends(self):
        program = self.lookups(stale_periods=3.0, hold_periods=1)
        program.exchange(0.5, accept=lambda s: s.status == LookupStatus.INSIDE)
        seen = len(program.statuses.messages)
        status = program.statuses.wait(lambda m: m.sent == LookupStatus.NOTHING, since=seen)
        self.assertEqual(status.status, LookupStatus.SILENT)
        self.assertIn("the parameter e_", status.text)
        self.assertEqual(status.inputs, ())
        program.exchange(0.5, accept=lambda s: s.status == LookupStatus.INSIDE)

    def test_before_the_first_answer_nothing_is_sent(self):
        program = self.lookups(**{"safe/phi_cmd": 0.01})
        status = program.exchange(1e6, accept=lambda s: s.status == LookupStatus.OUTSIDE_BOX)
        self.assertEqual((status.sent, status.inputs), (LookupStatus.NOTHING, ()))
        self.assertEqual(program.inputs.messages, [])

    def test_other_maps_are_swapped_in_or_refused(self):
        program = self.lookups()
        before = program.exchange(0.5, accept=lambda s: s.status == LookupStatus.INSIDE).inputs[0]
        service = program.namespace + "/swap_map"
        rospy.wait_for_service(service, node_or_nodelet.PATIENCE)
        swap = rospy.ServiceProxy(service, SwapMap)

        def named(name):
            return os.path.join(self.folder.name, name + ".map")

        for name, reason in (("wild", "would change the command"), ("slow", "period must be"), ("longitudinal", "must be those"),
                             ("limited", "solver status"), ("truncated", "truncated.map"), ("missing", "missing.map")):
            answer = swap(path=named(name))
            self.assertFalse(answer.success, name)
            self.assertIn(reason, answer.message)
            self.assertIn("the map in force stays", answer.message)
        self.assertTrue(swap(path=named("firmer")).success)
        status = program.exchange(0.5, accept=lambda s: s.inputs and s.inputs[0] != before)
        self.assertAlmostEqual(status.inputs[0], 1.2 * before)

    def test_refuses_what_it_cannot_bind(self):
        for wrong, said in (({"sources/e_phi": "odometry/speed"}, "sources/e_phi: must be topic, array"),
                            ({"sources/e_psi": "topic"}, "sources/e_psi"), ({"map": self.maps["lateral"] + "x"}, "lateral.mapx"),
                            ({"safe/phi_cmd": 9.0}, "safe/phi_cmd: must lie in")):
            program = self.lookups(**wrong)
            output = program.output_at_end()
            self.assertNotEqual(program.process.returncode, 0)
            self.assertIn(said, output)
            rospy.delete_param(program.namespace)


if __name__ == "__main__":
    rospy.init_node("lookup_test")
    rostest.rosrun("online_controller", "lookup_" + VARIANT, LookupTest, sys.argv)
