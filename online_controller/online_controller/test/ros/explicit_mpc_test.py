#!/usr/bin/env python3
"""The controller on real topics, as node and as nodelet. Launched by explicit_mpc.test with the argument node or nodelet."""

import hashlib
import math
import os
import subprocess
import sys
import unittest

import rospkg
import rospy
import rostest
from geometry_msgs.msg import Transform, Twist
from mav_msgs.msg import RollPitchYawrateThrust
from nav_msgs.msg import Odometry
from mavros_msgs.msg import ExtendedState
from online_controller.msg import AxisStatus, ControllerStatus
from online_controller.srv import SelectLaw
from rosgraph_msgs.msg import Clock
from roslib.packages import find_node
from std_msgs.msg import String
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint

from controller_process import AXES, HOVER, MapsFixture, pose_at
from node_or_nodelet import PATIENCE, VARIANT


def problem_files():
    folder = os.path.join(os.path.realpath(rospkg.RosPack().get_path("region_maps")), "..", "problems")
    return {"problems/" + axis: os.path.join(folder, "multirotor_%s.yaml" % axis) for axis in AXES}


def is_level(command):
    return (command.roll, command.pitch, command.yaw_rate) == (0.0, 0.0, 0.0) and abs(command.thrust.z - HOVER) < 1e-9


class ExplicitMpcTest(MapsFixture):
    def test_answers_each_odometry_with_its_stamp(self):
        controller = self.fly()
        for _ in range(20):
            _, status = controller.exchange()
            self.assertEqual(status.status, ControllerStatus.NO_REFERENCE)
            self.assertIn("nothing is sent", status.text)
        self.assertEqual(controller.commands.messages, [])

        controller.pose.publish(pose_at(0.5, 0.0, 1.0))
        command, status = controller.exchange(accept=lambda s: s.status != ControllerStatus.NO_REFERENCE)
        self.assertEqual(status.status, ControllerStatus.OPTIMAL)
        self.assertEqual(status.reason, ControllerStatus.REASON_NONE)
        self.assertEqual(command.header.frame_id, "world")
        self.assertGreater(command.pitch, 0.01)   # forward
        self.assertGreater(command.thrust.z, HOVER)  # up
        self.assertAlmostEqual(status.longitudinal.theta[0], -0.5)
        self.assertEqual(len(status.lateral.theta), 5)
        self.assertEqual(len(status.vertical.theta), 4)
        self.assertEqual(status.longitudinal.lookup, AxisStatus.INSIDE)
        self.assertEqual(status.longitudinal.region, 0)
        self.assertGreater(status.step_time_ns, 0)
        self.assertGreater(status.lookup_time_ns, 0)
        self.assertGreaterEqual(status.odometry_age, 0.0)

    def test_each_law_flies_and_laws_are_switched_in_flight(self):
        controller = self.fly({"law": "nonlinear"})
        active = controller.collector("active_law", String)
        self.assertIsNotNone(active.wait(lambda m: m.data == "nonlinear"))
        controller.pose.publish(pose_at(0.5, 0.0, 1.0))
        rospy.wait_for_service(controller.namespace + "/select_law", PATIENCE)
        select = rospy.ServiceProxy(controller.namespace + "/select_law", SelectLaw)
        for law, parameters in (("nonlinear", 0), ("linear", 5), ("explicit_linear", 5), ("nonlinear", 0)):
            self.assertTrue(select(law).success)
            command, status = controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)
            self.assertEqual(len(status.longitudinal.theta), parameters)
            self.assertGreater(command.pitch, 0.01)
            self.assertGreater(command.thrust.z, HOVER)
            self.assertIsNotNone(active.wait(lambda m: m.data == law))
        refused = select("robust")
        self.assertFalse(refused.success)
        self.assertIn("must be one of explicit_linear, linear, nonlinear", refused.message)

    def test_linear_flies_without_maps(self):
        controller = self.fly(dict(problem_files(), law="linear"), maps={"lateral": ""})
        controller.pose.publish(pose_at(0.5, 0.0, 1.0))
        command, status = controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)
        self.assertGreater(command.pitch, 0.01)
        self.assertEqual(len(status.lateral.theta), 5)
        refused = rospy.ServiceProxy(controller.namespace + "/select_law", SelectLaw)("explicit_linear")
        self.assertFalse(refused.success)
        self.assertEqual(refused.message, "explicit_linear is not loaded; linear flies")

    def test_velocity_comes_from_the_body_frame(self):
        controller = self.fly()
        controller.pose.publish(pose_at(0.0, 0.0, 0.0))

        def heading_left(odometry):
            odometry.pose.pose.orientation.w = math.cos(math.pi / 4)
            odometry.pose.pose.orientation.z = math.sin(math.pi / 4)
            odometry.twist.twist.linear.x = 1.0

        _, status = controller.exchange(heading_left, lambda s: s.status != ControllerStatus.NO_REFERENCE)
        self.assertAlmostEqual(status.longitudinal.theta[1], 0.0)
        self.assertAlmostEqual(status.lateral.theta[1], 1.0)

    def test_follows_a_trajectory_and_keeps_it_when_a_bad_one_comes(self):
        controller = self.fly()
        trajectory = MultiDOFJointTrajectory()  # no stamp: starts with the next odometry
        for i in range(3):
            point = MultiDOFJointTrajectoryPoint()
            transform = Transform()
            transform.rotation.w = 1.0
            transform.translation.x = 0.1 * i
            velocity = Twist()
            velocity.linear.x = 0.1
            point.transforms, point.velocities, point.accelerations = [transform], [velocity], [Twist()]
            point.time_from_start = rospy.Duration(100.0 * i)
            trajectory.points.append(point)
        controller.trajectory.publish(trajectory)
        _, status = controller.exchange(accept=lambda s: s.status != ControllerStatus.NO_REFERENCE)
        self.assertAlmostEqual(status.longitudinal.theta[1], -0.1)

        trajectory.points[1].transforms[0].translation.x = float("nan")
        controller.trajectory.publish(trajectory)
        trajectory.points[1].transforms = []
        controller.trajectory.publish(trajectory)
        controller.pose.publish(pose_at(float("nan"), 0.0, 0.0))
        for _ in range(5):
            _, status = controller.exchange()
            self.assertEqual(status.status, ControllerStatus.OPTIMAL)

    def test_nan_odometry_gives_a_finite_command_and_a_status(self):
        controller = self.fly({"controller/hold_periods": 2})
        controller.pose.publish(pose_at(0.2, 0.1, 0.3))
        last, _ = controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)

        def poison(odometry):
            odometry.pose.pose.position.y = float("nan")

        for expected in (ControllerStatus.HOLD_LAST, ControllerStatus.HOLD_LAST, ControllerStatus.LEVEL):
            command, status = controller.exchange(poison)
            self.assertEqual(status.status, expected)
            self.assertEqual(status.reason, ControllerStatus.REASON_NOT_FINITE)
            self.assertEqual(status.lateral.lookup, AxisStatus.NOT_FINITE)
            self.assertEqual(len(status.lateral.theta), 0)
            self.assertIn("not finite", status.text)
            if expected == ControllerStatus.HOLD_LAST:
                self.assertEqual((command.roll, command.pitch, command.thrust.z), (last.roll, last.pitch, last.thrust.z))
            else:
                self.assertTrue(is_level(command))
        _, status = controller.exchange()
        self.assertEqual(status.status, ControllerStatus.OPTIMAL)

    def test_a_quaternion_that_is_none_counts_as_not_finite(self):
        controller = self.fly()
        controller.pose.publish(pose_at(0.0, 0.0, 0.0))
        controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)

        def blank(odometry):
            odometry.pose.pose.orientation.w = 0.0

        _, status = controller.exchange(blank)
        self.assertEqual(status.reason, ControllerStatus.REASON_NOT_FINITE)

    def test_outside_the_map_is_reported_with_the_parameter(self):
        controller = self.fly()
        controller.pose.publish(pose_at(50.0, 0.0, 0.0))
        _, status = controller.exchange(accept=lambda s: s.status != ControllerStatus.NO_REFERENCE)
        self.assertEqual(status.status, ControllerStatus.CLIPPED)
        self.assertEqual(status.reason, ControllerStatus.REASON_OUTSIDE_BOX)
        self.assertEqual(status.longitudinal.outside_parameter, "e_p_x")
        self.assertEqual(status.lateral.outside_parameter, "")
        self.assertIn("e_p_x", status.text)

    def test_infeasible_parameters_hold(self):
        maps = dict(self.maps, lateral=os.path.join(self.folder.name, "infeasible.map"))
        controller = self.fly({"controller/jump_distance": 0.0}, maps)
        controller.pose.publish(pose_at(0.0, 0.0, 0.0))
        controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)

        def beyond(odometry):
            odometry.pose.pose.position.y = 2.0

        _, status = controller.exchange(beyond)
        self.assertEqual(status.status, ControllerStatus.HOLD_LAST)
        self.assertEqual(status.reason, ControllerStatus.REASON_OUTSIDE_PARTITION)
        self.assertEqual(status.lateral.region, -1)

    def test_silence_levels_and_odometry_ends_it(self):
        controller = self.fly({"controller/stale_periods": 50})
        controller.pose.publish(pose_at(0.5, 0.0, 0.0))
        command, _ = controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)
        self.assertFalse(is_level(command))
        status = controller.statuses.wait(lambda m: m.reason == ControllerStatus.REASON_STALE)
        self.assertIsNotNone(status)
        self.assertEqual(status.status, ControllerStatus.LEVEL)
        self.assertGreater(status.odometry_age, 0.5)
        command = controller.commands.wait(lambda m: m.header.stamp == status.header.stamp)
        self.assertTrue(is_level(command))
        command, status = controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)
        self.assertFalse(is_level(command))

    def test_wall_time_decides_where_simulated_time_stands_and_odometry_came(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.set_param, "/use_sim_time", False)
        controller = self.fly({"controller/stale_periods": 10})
        controller.pose.publish(pose_at(0.5, 0.0, 0.0))
        command, _ = controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)
        self.assertFalse(is_level(command))
        flown = len(controller.commands.messages)
        self.assertIsNotNone(controller.statuses.wait(
            lambda m: (m.status, m.reason) == (ControllerStatus.LEVEL, ControllerStatus.REASON_STALE)))
        self.assertIsNotNone(controller.commands.wait(is_level, since=flown))
        controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)

        # A clock that stands after odometry came is a paused simulation.
        clock = rospy.Publisher("/clock", Clock, queue_size=1)
        time = rospy.Time.now()
        deadline = time + rospy.Duration(PATIENCE)
        while clock.get_num_connections() == 0 and rospy.Time.now() < deadline:
            rospy.sleep(0.01)
        for _ in range(5):
            time += rospy.Duration(0.001)
            clock.publish(time)
            rospy.sleep(0.05)
        stamp = rospy.Time.now()

        def still(odometry):
            odometry.header.stamp = stamp

        controller.exchange(still, accept=lambda s: s.status == ControllerStatus.OPTIMAL)
        paused = len(controller.commands.messages)
        rospy.sleep(0.6)
        self.assertEqual(len(controller.commands.messages), paused)
        controller.process.terminate()
        self.assertIn("wall time decides", controller.output_at_end())

    def test_refuses_maps_that_do_not_fit(self):
        def with_lateral(name):
            return dict(self.maps, lateral=os.path.join(self.folder.name, name))

        missing = self.refusal({axis: self.maps[axis] for axis in AXES if axis != "lateral"})
        self.assertIn("/controller/maps/lateral: missing", missing)
        self.assertIn("nowhere.map", self.refusal(with_lateral("nowhere.map")))
        self.assertIn("truncated.map", self.refusal(with_lateral("truncated.map")))
        self.assertIn("flipped.map", self.refusal(with_lateral("flipped.map")))
        wrong = self.refusal(with_lateral("longitudinal.map"))
        self.assertIn("longitudinal.map: as the lateral map: parameter 'e_p_x': not a signal of this axis", wrong)
        self.assertIn("must be 'complete'", self.refusal(with_lateral("limited.map")))

    def test_refuses_parameters_that_are_not_fit(self):
        self.assertIn("/controller/controller/yaw_gian: unknown", self.refusal(parameters={"controller/yaw_gian": 1.0}))
        self.assertIn("/controller/vehical: unknown group; is 'vehicle' meant?",
                      self.refusal(parameters={"vehical/mass": 3.0}))
        self.assertIn("is 'KF_observer' meant?", self.refusal(parameters={"kf_observer/q_position": 0.1}))
        self.assertIn("/controller/vehicle/mass: must lie in", self.refusal(parameters={"vehicle/mass": -1.0}))
        self.assertIn("/controller/vehicle/mass: must be a number", self.refusal(parameters={"vehicle/mass": "heavy"}))
        scalar = self.refusal(parameters={"vehicle": 1.5})
        self.assertIn("/controller/vehicle: must be a map", scalar)
        self.assertIn("FATAL", scalar)
        self.assertIn("hold_periods: must be a whole number", self.refusal(parameters={"controller/hold_periods": 2.5}))
        self.assertIn("hover", self.refusal(parameters={"controller/thrust_min": 15.0}))
        self.assertIn("law: must be one of", self.refusal(parameters={"law": "quick"}))
        self.assertIn("use control_interface/offboard_stream",
                      self.refusal(parameters={"control_interface/idle_publishes": True}))
        self.assertIn("launch-prefix", self.refusal(parameters={"real_time/priority": 10}))
        self.assertIn("/controller/nonlinear/horizon: must lie in", self.refusal(parameters={"nonlinear/horizon": 0}))

    @unittest.skipUnless("nodelet" in sys.argv, "of the nodelet only")
    def test_a_manager_survives_a_nodelet_that_does_not_start(self):
        tool = find_node("nodelet", "nodelet")[0]
        manager = subprocess.Popen([tool, "manager", "__name:=survivor"])
        self.addCleanup(manager.communicate)
        self.addCleanup(manager.terminate)
        rospy.wait_for_service("/survivor/load_nodelet", PATIENCE)
        load = [tool, "load", "online_controller/ExplicitMpc", "/survivor", "__name:=unfit"]
        self.assertNotEqual(subprocess.run(load, timeout=PATIENCE).returncode, 0)
        self.assertIsNone(manager.poll())

    def test_messages_are_those_of_mav_msgs_and_mavros(self):
        # ROS's rule for the checksum of a message, applied to the fields of the original definition.
        header, vector = Odometry().header, RollPitchYawrateThrust().thrust
        text = "%s header\nfloat64 roll\nfloat64 pitch\nfloat64 yaw_rate\n%s thrust" % (header._md5sum, vector._md5sum)
        self.assertEqual(RollPitchYawrateThrust._md5sum, hashlib.md5(text.encode()).hexdigest())
        self.assertEqual(ExtendedState._md5sum, "ae780b1800fe17b917369d21b90058bd")  # as mavros 1 has it


if __name__ == "__main__":
    rospy.init_node("explicit_mpc_test")
    rostest.rosrun("online_controller", "explicit_mpc_" + VARIANT, ExplicitMpcTest, sys.argv)
