#!/usr/bin/env python3
"""What changes and what is shown while the controller flies: options, maps, messages for autopilots and for people, and
the names of mav_control_rw. Launched by in_flight.test with the argument node or nodelet."""

import math
import os
import shutil
import subprocess
import sys
import unittest

import rospkg
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.client import Client
from mavros_msgs.msg import AttitudeTarget
from online_controller.msg import ControllerStatus, FoundModel
from online_controller.srv import SelectLaw, SwapMaps
from roslib.packages import find_node
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import MultiDOFJointTrajectory
from visualization_msgs.msg import Marker

from controller_process import HOVER, Controller, MapsFixture, pose_at
from node_or_nodelet import PATIENCE, VARIANT, Collector

HALF = math.sqrt(0.5)


def heading_left(odometry):
    odometry.pose.pose.orientation.w = odometry.pose.pose.orientation.z = HALF


def is_optimal(status):
    return status.status == ControllerStatus.OPTIMAL


class InFlightTest(MapsFixture):
    def options(self, controller):
        client = Client(controller.namespace + "/controller", timeout=PATIENCE)
        self.addCleanup(client.close)
        return client

    def test_options_change_in_flight(self):
        controller = self.fly({"law": "linear", "controller/offset_free": False})  # the vehicle does not move
        options = self.options(controller)
        # Before the first command the whole range is open.
        for mass in (900.0, 1.52):
            self.assertEqual(options.update_configuration({"vehicle/mass": mass})["vehicle/mass"], mass)
        turned = pose_at(0.0, 0.3, 0.0)
        turned.pose.orientation.w, turned.pose.orientation.z = math.cos(0.1), math.sin(0.1)
        controller.pose.publish(turned)
        controller.exchange(accept=is_optimal)
        for _ in range(5):  # until the command depends on the one before no more
            first, _ = controller.exchange()
        described = {p["name"]: p for p in options.get_parameter_descriptions(PATIENCE)}
        self.assertEqual(described["controller/yaw_gain"]["max"], 20.0)
        self.assertEqual(described["controller/hold_periods"]["type"], "int")
        self.assertNotIn("nonlinear/horizon", described)

        answer = options.update_configuration({"controller/yaw_gain": 3.6})
        self.assertEqual(answer["controller/yaw_gain"], 3.6)
        faster, _ = controller.exchange(accept=lambda s: s.law == "linear")
        faster, _ = controller.exchange()  # laws are exchanged after a command is out
        self.assertAlmostEqual(faster.yaw_rate, 2.0 * first.yaw_rate)
        self.assertAlmostEqual(faster.roll, first.roll, places=6)

        options.update_configuration({"linear/position_weight_y": 4.0})
        controller.exchange()
        softer, _ = controller.exchange()
        self.assertLess(abs(softer.roll), 0.8 * abs(first.roll))
        # Clamped to its range; refused as a whole, because hover thrust would be out of the limits.
        self.assertEqual(options.update_configuration({"controller/angle_max": 7.0})["controller/angle_max"], 1.0)
        refused = options.update_configuration({"controller/thrust_min": 15.0, "controller/yaw_gain": 1.0})
        self.assertEqual((refused["controller/thrust_min"], refused["controller/yaw_gain"]), (5.0, 3.6))
        command, _ = controller.exchange()
        self.assertAlmostEqual(command.yaw_rate, faster.yaw_rate)
        # Refused as a whole, because the thrust would follow the mass in the next command.
        thrust = command.thrust.z
        for mass in (1e9, 3.0, 1e-9, -1.0):
            refused = options.update_configuration({"vehicle/mass": mass, "controller/yaw_gain": 4.0})
            self.assertEqual((refused["vehicle/mass"], refused["controller/yaw_gain"]), (1.52, 3.6))
        self.assertEqual(options.update_configuration({"vehicle/mass": float("nan")})["vehicle/mass"], 1.52)
        controller.exchange()
        self.assertAlmostEqual(controller.exchange()[0].thrust.z, thrust)
        mass = 1.52
        for _ in range(20):  # in a row they go no further than one
            mass = options.update_configuration({"vehicle/mass": 1.1 * mass})["vehicle/mass"]
        self.assertAlmostEqual(mass, 1.52 * 1.1)
        deadline = rospy.Time.now() + rospy.Duration(PATIENCE)
        name = controller.namespace + "/controller/controller/yaw_gain"
        while rospy.get_param(name, 0.0) != 3.6 and rospy.Time.now() < deadline:
            rospy.sleep(0.05)
        self.assertEqual(rospy.get_param(name), 3.6)

    def test_maps_are_swapped_only_for_good_ones(self):
        controller = self.fly({"controller/offset_free": False})  # the vehicle does not move
        controller.pose.publish(pose_at(0.0, 0.3, 0.0))
        before, _ = controller.exchange(accept=is_optimal)
        rospy.wait_for_service(controller.namespace + "/swap_maps", PATIENCE)
        swap = rospy.ServiceProxy(controller.namespace + "/swap_maps", SwapMaps)
        rospy.sleep(0.2)  # until the last sample has been looked at

        def lateral(name, most_change=0.0):
            return swap(lateral=os.path.join(self.folder.name, name), most_change=most_change)

        for name, rule in (
                ("nowhere.map", "nowhere.map"), ("truncated.map", "truncated.map"), ("flipped.map", "flipped.map"),
                ("limited.map", "must be 'complete'"), ("longitudinal.map", "not a signal of this axis"),
                ("wild.map", "would change the command"), ("restless.map", "must command nothing at rest"),
                ("slow.map", "period must be that of the map in force")):
            answer = lateral(name)
            self.assertFalse(answer.success, name)
            self.assertIn(rule, answer.message)
            self.assertIn("the maps in force stay", answer.message)
            command, _ = controller.exchange(accept=is_optimal)
            self.assertEqual(command.roll, before.roll)
        self.assertFalse(swap(lateral="", most_change=float("nan")).success)
        self.assertFalse(swap(robust=True).success)

        for name, gain in (("firmer.map", 1.2), ("lateral.map", 1.0)):
            answer = lateral(name)
            self.assertTrue(answer.success, answer.message)
            self.assertTrue(math.isnan(answer.change[0]) or answer.change[0] == 0.0)
            controller.exchange()
            command, status = controller.exchange(accept=is_optimal)
            self.assertAlmostEqual(status.lateral.input, gain * 0.3 * -0.3, places=9)
        self.assertFalse(lateral("firmer.map", most_change=0.001).success)

    def test_maps_in_force_stay_whatever_happens_to_their_files(self):
        maps = {axis: shutil.copy(path, os.path.join(self.folder.name, "flown_%s.map" % axis))
                for axis, path in self.maps.items()}
        controller = self.fly({"controller/offset_free": False}, maps)  # the vehicle does not move
        controller.pose.publish(pose_at(0.0, 0.3, 0.0))
        before, _ = controller.exchange(accept=is_optimal)
        good, firmer = (open(os.path.join(self.folder.name, name + ".map"), "rb").read() for name in ("lateral", "firmer"))
        swap = rospy.ServiceProxy(controller.namespace + "/swap_maps", SwapMaps)
        swap.wait_for_service(PATIENCE)
        huge = os.path.join(self.folder.name, "huge.map")
        with open(huge, "wb") as file:
            file.write(good)
            file.truncate(20 * 10**9)  # of which the disk holds little
        # As `cp` over it does, in each of its states: another map, half of it, nothing, garbage.
        for content in (firmer, firmer[:len(firmer) // 2], b"", b"\xff" * len(good)):
            with open(maps["lateral"], "r+b") as file:
                file.truncate(len(content))
                file.write(content)
            for _ in range(3):
                command, status = controller.exchange()
                self.assertEqual((status.status, command.roll), (ControllerStatus.OPTIMAL, before.roll))
            if content != firmer:
                answer = swap(lateral=maps["lateral"])
                self.assertFalse(answer.success)
                self.assertIn("the maps in force stay", answer.message)
        for path, rule in ((huge, "is too long: 20000000000 bytes"), (self.folder.name, "is a directory"),
                           ("/dev/zero", "is not a regular file")):
            self.assertIn(rule, swap(lateral=path).message)
        with open(maps["lateral"], "wb") as file:
            file.write(firmer)
        self.assertTrue(swap(lateral=maps["lateral"]).success)
        self.assertIsNone(controller.process.poll())

    def test_robust_maps_are_swapped_and_outside_of_them_the_violation_is_least(self):
        def at(name):
            return os.path.join(self.folder.name, name + ".map")

        def exchange_at(wanted):  # the robust law decides each 0.08 s
            return controller.exchange(accept=lambda s: abs(s.lateral.input - wanted) < 1e-9)

        parameters = {"robust_maps/" + axis: at("robust_" + axis) for axis in ("longitudinal", "lateral", "vertical")}
        parameters["law"] = "robust_explicit"
        controller = self.fly(parameters)
        diagnostics = Collector("/diagnostics", DiagnosticArray)
        services = {name: rospy.ServiceProxy(controller.namespace + "/" + name, kind)
                    for name, kind in (("swap_maps", SwapMaps), ("select_law", SelectLaw))}
        for service in services.values():
            service.wait_for_service(PATIENCE)
        swap = services["swap_maps"]
        controller.pose.publish(pose_at(0.0, 0.3, 0.0))
        _, status = exchange_at(0.3 * -0.3)
        self.assertEqual((status.law, status.status), ("robust_explicit", ControllerStatus.OPTIMAL))
        for name, gain in (("robust_firmer", 1.2), ("robust_lateral", 1.0)):
            answer = swap(law="robust_explicit", lateral=at(name))
            self.assertTrue(answer.success, answer.message)
            exchange_at(gain * 0.3 * -0.3)
        refused = swap(law="robust_explicit", lateral=at("lateral"))
        self.assertIn("must be of type robust_mpc", refused.message)
        for law in ("explicit_linear", "robust_explicit"):
            self.assertTrue(services["select_law"](law).success)
            controller.exchange(accept=lambda s, law=law: s.law == law and s.status == ControllerStatus.OPTIMAL)

        self.assertTrue(swap(law="robust_explicit", lateral=at("robust_narrow")).success)
        controller.pose.publish(pose_at(0.0, -0.3, 0.0))
        _, status = exchange_at(0.3 * 0.1)  # that of the nearest error with a plan
        self.assertEqual(status.status, ControllerStatus.LEAST_VIOLATION)
        self.assertEqual(status.reason, ControllerStatus.REASON_OUTSIDE_PARTITION)
        self.assertAlmostEqual(status.lateral.theta[0], 0.3)
        counted = diagnostics.wait(lambda m: any(
            v.key == "samples without a plan" and int(v.value) > 0 for s in m.status for v in s.values))
        self.assertIsNotNone(counted)
        values = {v.key: v.value for s in counted.status for v in s.values}
        self.assertEqual(values["samples clipped to the maps"], "0")
        self.assertGreaterEqual(int(values["samples outside the maps"]), int(values["samples without a plan"]))

    def test_attitude_target_for_an_autopilot(self):
        controller = self.fly({"output/attitude_target": True, "output/hover_thrust": 0.4})
        targets = controller.collector("mavros/setpoint_raw/attitude", AttitudeTarget)
        controller.pose.publish(pose_at(0.1, -0.1, 0.05))
        command, status = controller.exchange(heading_left, is_optimal)
        target = targets.wait(lambda m: m.header.stamp == status.header.stamp)
        self.assertEqual(target.type_mask, AttitudeTarget.IGNORE_ROLL_RATE | AttitudeTarget.IGNORE_PITCH_RATE)
        self.assertEqual(target.body_rate.z, command.yaw_rate)
        self.assertAlmostEqual(target.thrust, 0.4 * command.thrust.z / HOVER, places=6)
        # Body z of q = (w, x, y, z) in the world; at yaw 90 degrees pitch leans to +y and roll to +x.
        q = target.orientation
        up = (2.0 * (q.x * q.z + q.w * q.y), 2.0 * (q.y * q.z - q.w * q.x), 1.0 - 2.0 * (q.x ** 2 + q.y ** 2))
        self.assertAlmostEqual(up[0], math.sin(command.roll), places=9)
        self.assertAlmostEqual(up[1], math.cos(command.roll) * math.sin(command.pitch), places=9)
        self.assertAlmostEqual(2.0 * math.atan2(q.z, q.w), math.pi / 2.0, delta=0.05)

    def test_a_thrust_curve_that_cannot_be_flown_is_refused(self):
        self.assertIn("output/thrust: must increase", self.refusal(
            parameters={"output/attitude_target": True, "output/thrust_polynomial": [0.0, 0.05, -0.002]}))
        self.assertIn("output: one of", self.refusal(parameters={"output/roll_pitch_yawrate_thrust": False}))

    def test_status_display_and_diagnostics(self):
        controller = self.fly({"law": "nonlinear"})
        markers = {name: controller.collector(name, Marker)
                   for name in ("reference_trajectory", "predicted_state")}
        models = controller.collector("found_model", FoundModel)
        plans = Collector(controller.namespace + "/full_predicted_state", MultiDOFJointTrajectory)
        frames = Collector("/tf", TFMessage)
        diagnostics = Collector("/diagnostics", DiagnosticArray)
        controller.pose.publish(pose_at(0.2, 0.1, 0.3))
        wanted = controller.namespace[1:] + "/current_reference"
        frame, shown = None, {}
        deadline = rospy.Time.now() + rospy.Duration(PATIENCE)
        while (frame is None or len(shown) < 2) and rospy.Time.now() < deadline:
            _, status = controller.exchange(accept=is_optimal)
            frame = frame or frames.wait(lambda m: m.transforms[0].child_frame_id == wanted, 0.02)
            for name, collector in markers.items():
                marker = collector.wait(lambda m: len(m.points) == 21, 0.02)
                if marker:
                    shown[name] = marker
        self.assertAlmostEqual(frame.transforms[0].transform.translation.z, 0.3)
        self.assertAlmostEqual(shown["reference_trajectory"].points[20].x, 0.2)
        self.assertAlmostEqual(shown["predicted_state"].points[0].x, 0.0)
        self.assertAlmostEqual(shown["predicted_state"].points[20].x, 0.2, delta=0.1)
        controller.exchange()
        plan = plans.wait(lambda m: len(m.points) == 21)  # as mav_control_rw publishes it
        self.assertAlmostEqual(plan.points[20].time_from_start.to_sec(), 2.0)
        self.assertAlmostEqual(plan.points[0].transforms[0].translation.x, 0.0)
        self.assertAlmostEqual(plan.points[20].transforms[0].translation.x, 0.2, delta=0.1)
        self.assertAlmostEqual(plan.points[20].transforms[0].rotation.w, 1.0)
        _, status = controller.exchange()  # with times of the one before
        # What is estimated of the model's errors; nothing of it while the reference rests.
        model = models.wait(lambda m: m.header == status.header)
        self.assertAlmostEqual(model.roll_gain, 0.9, delta=0.01)
        self.assertAlmostEqual(model.roll_time, 0.25, delta=0.01)
        self.assertAlmostEqual(model.pitch_gain, 0.9, delta=0.01)
        self.assertAlmostEqual(model.pitch_time, 0.25, delta=0.01)
        self.assertEqual(model.drag, (0.0, 0.0))
        self.assertEqual(status.law, "nonlinear")
        self.assertGreater(status.iterations, 0)
        self.assertLess(status.kkt_residual, 1e-6)
        self.assertGreaterEqual(status.kkt_residual, 0.0)
        for time in (status.input_time_ns, status.step_time_ns, status.output_time_ns, status.prepare_time_ns):
            self.assertGreater(time, 0)
        name = controller.namespace + "/controller: control"
        said = diagnostics.wait(lambda m: any(
            s.name.endswith(name[1:]) and any(v.key == "commands swing" for v in s.values) for s in m.status))
        self.assertIsNotNone(said)
        values = {v.key: v.value for s in said.status for v in s.values}
        self.assertGreater(int(values["steps"]), 0)
        self.assertEqual(values["commands swing"], "False")
        self.assertEqual(float(values["constant force not removed [N]"]), 0.0)
        self.assertGreaterEqual(float(values["odometry to command, greatest [us]"]),
                                float(values["control law, greatest [us]"]))

    @unittest.skipIf("nodelet" in sys.argv, "nodes only")
    def test_launch_files_of_mav_control_rw_need_another_package_name_only(self):
        resources = os.path.join(rospkg.RosPack().get_path("online_controller"), "resources")
        for node, law in (("mav_linear_mpc_node", "linear"), ("nonlinear_mpc_node", "nonlinear")):
            namespace = "/peer_" + law
            name = "mav_%s_mpc" % law
            subprocess.run(["rosparam", "load", os.path.join(
                resources, "%s_mpc_firefly.yaml" % law), namespace + "/" + name], check=True)
            rospy.set_param(namespace + "/" + name + "/controller/stale_periods", 10000)
            for theirs, value in (("KF_observer/q_position", 0.01), ("KF_observer/q_force", 0.0001), ("KF_observer/P0_force", 0.1),
                                  ("verbose", True)):
                rospy.set_param(namespace + "/" + name + "/" + theirs, value)
            controller = Controller(namespace[1:], name=name, command=[find_node("online_controller", node)[0]])
            self.addCleanup(controller.stop)
            controller.connect()
            controller.pose.publish(pose_at(0.5, 0.0, 0.0))
            command, status = controller.exchange(accept=is_optimal)
            self.assertEqual(status.law, law)
            self.assertGreater(command.pitch, 0.03)
            self.assertLessEqual(command.pitch, math.radians(25.0) + 1e-12)
            mass = 1.52 if law == "linear" else 1.56
            self.assertAlmostEqual(command.thrust.z, mass * 9.8066, delta=1.0)

            # What scripts and rqt change there has the same names here.
            options = Client(namespace + "/" + name, timeout=PATIENCE)
            self.addCleanup(options.close)
            described = {p["name"] for p in options.get_parameter_descriptions(PATIENCE)}
            self.assertLessEqual({"q_x", "q_vz", "r_thrust", "roll_max", "thrust_max", "K_yaw", "Ki_altitude",
                                  "enable_integrator"}, described)
            start = options.get_configuration(PATIENCE)
            self.assertEqual(start["vehicle/mass"], mass)
            self.assertEqual(start["nonlinear/drag_y"], 0.01)
            self.assertAlmostEqual(start["controller/disturbance_drift"], 0.01)
            answer = options.update_configuration({"q_x": 55.0, "roll_max": 0.3, "enable_integrator": False})
            self.assertEqual((answer["q_x"], answer[law + "/position_weight_x"]), (55.0, 55.0))
            self.assertEqual((answer["roll_max"], answer["enable_integrator"]), (0.3, False))
            self.assertFalse(answer["controller/integrator"])
            self.assertEqual(answer["KF_observer/q_position"], 0.01)
            answer = options.update_configuration({"KF_observer/q_force": 0.0004, "KF_observer/r_position": 0.001})
            self.assertAlmostEqual(answer["controller/disturbance_drift"], 0.02)
            self.assertEqual(answer["KF_observer/r_position"], 0.001)
            if law == "linear":
                self.assertEqual((answer["linear/roll_command_max"], answer["linear/roll_command_min"]), (0.3, -0.3))
                self.assertAlmostEqual(answer["controller/angle_max"], math.radians(25.0))
                answer = options.update_configuration({"thrust_min": 6.0})
                self.assertAlmostEqual(answer["linear/thrust_command_min"], 6.0 - 9.8066)
            # A client that sends everything back changes what it changed, and nothing else.
            answer["linear/position_weight_y"] = 44.0
            sent = {key: value for key, value in answer.items() if key in described}
            everything = options.update_configuration(sent)
            self.assertEqual((everything["linear/position_weight_y"], everything["q_x"]), (44.0, 55.0))
            controller.process.terminate()
            said = controller.output_at_end()
            self.assertIn("not read: KF_observer/P0_force: the observers have the gains of the steady state", said)
            self.assertIn("verbose: what is logged is chosen by rosconsole's levels", said)

    @unittest.skipIf("nodelet" in sys.argv, "nodes only")
    def test_names_of_mav_control_rw_count_at_each_start_unless_ours_are_given(self):
        # The parameter server outlives the node; a launch file need not clear its parameters.
        name = "/peer_again/mav_nonlinear_mpc"
        executable = find_node("online_controller", "nonlinear_mpc_node")[0]

        def start():
            return subprocess.Popen([executable, "__ns:=/peer_again", "__name:=mav_nonlinear_mpc"],
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)

        def flown():
            node = start()
            client = Client(name, timeout=PATIENCE)
            configuration = client.get_configuration(PATIENCE)
            client.close()
            node.terminate()
            node.communicate(timeout=PATIENCE)
            return configuration["vehicle/mass"], configuration["controller/angle_max"]

        rospy.set_param(name, {"mass": 1.5, "K_yaw": 1.0, "roll_max": 0.3, "pitch_max": 0.4})
        self.assertEqual(flown(), (1.5, 0.4))
        rospy.set_param(name + "/mass", 2.0)
        self.assertEqual(flown()[0], 2.0)
        rospy.set_param(name + "/vehicle/mass", 2.5)
        self.assertEqual(flown()[0], 2.5)
        rospy.delete_param(name + "/vehicle/mass")
        rospy.set_param(name + "/mass", "heavy")
        node = start()
        said, _ = node.communicate(timeout=PATIENCE)
        self.assertEqual(node.returncode, 1)
        self.assertIn("MPC does not start: parameter " + name + "/mass: must be a number", said)


if __name__ == "__main__":
    rospy.init_node("in_flight_test")
    rostest.rosrun("online_controller", "in_flight_" + VARIANT, InFlightTest, sys.argv)
