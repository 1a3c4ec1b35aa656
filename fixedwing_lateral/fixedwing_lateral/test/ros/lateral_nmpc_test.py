#!/usr/bin/env python3
"""The lateral guidance over its topics: `node` or `nodelet`. By hand for single states, and against an aircraft."""
import hashlib
import math
import os
import subprocess
import sys
import tempfile
import unittest

import dynamic_reconfigure.client
import rospkg
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from fixedwing_lateral.msg import LateralStatus, Mission, PathSegment
from geometry_msgs.msg import Pose, TwistStamped, TwistWithCovarianceStamped
from mavros_msgs.msg import VFR_HUD, AttitudeTarget, State
from nav_msgs.msg import Odometry
from roslib.packages import find_node
from sensor_msgs.msg import Imu
from std_msgs.msg import Bool, Header
from visualization_msgs.msg import MarkerArray

# The partner for topics is the one of the multirotor's tests.
sys.path.insert(0, os.path.join(rospkg.RosPack().get_path("online_controller"), "test", "ros"))
from node_or_nodelet import PATIENCE, RETRY, VARIANT, Collector, Program, command_line  # noqa: E402

AIRSPEED = 14.0


class Guidance(Program):
    """The node or nodelet, with a partner for its topics."""

    def __init__(self, namespace, parameters=None):
        super().__init__(command_line("fixedwing_lateral", "lateral_nmpc_node", "LateralNmpc"), namespace, "guidance",
                         parameters)

    def connect(self):
        self.sent = 0
        self.odometry = self.publisher("mavros/local_position/odom", Odometry)
        self.imu = self.publisher("mavros/imu/data", Imu)
        self.hud = self.publisher("mavros/vfr_hud", VFR_HUD)
        self.wind = self.publisher("mavros/wind_estimation", TwistWithCovarianceStamped)
        self.mission = self.publisher("mission", Mission, latch=True)
        self.state = self.publisher("mavros/state", State, latch=True)
        self.engaged = self.publisher("engaged", Bool, latch=True)
        self.commands = self.collector("mavros/setpoint_attitude/cmd_vel", TwistStamped)
        self.attitudes = self.collector("mavros/setpoint_raw/attitude", AttitudeTarget)
        self.statuses = self.collector("lateral_status", LateralStatus)
        return self

    def send(self, change=lambda odometry: None):
        """An aircraft 20 m to the right of a line to the north, flying north; the stamp of its odometry."""
        stamp = rospy.Time.now()
        hud, wind, odometry = VFR_HUD(), TwistWithCovarianceStamped(), Odometry()
        hud.header.stamp = wind.header.stamp = odometry.header.stamp = stamp
        hud.airspeed = AIRSPEED
        odometry.header.frame_id = "map"
        self.sent += 1  # an estimate that repeats itself would count as none
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = 20.0, 50.0 + 1e-4 * self.sent
        odometry.pose.pose.orientation.w = odometry.pose.pose.orientation.z = math.sqrt(0.5)
        odometry.twist.twist.linear.x = AIRSPEED
        change(odometry)
        self.hud.publish(hud)
        self.wind.publish(wind)
        self.odometry.publish(odometry)
        return stamp

    def exchange(self, change=lambda odometry: None, accept=lambda status: True):
        """Sends odometry until a status with its stamp has arrived and is accepted. Airspeed and wind come on topics of
        their own: a status that assumes one was made before it was there."""
        def ask():
            stamp = self.send(change)
            status = self.statuses.wait(lambda m: m.header.stamp == stamp, RETRY)
            assumed = (LateralStatus.REASON_AIRSPEED_ASSUMED, LateralStatus.REASON_WIND_ASSUMED)
            return status if status and status.reason not in assumed and accept(status) else None

        return self.answer(ask)

    def command_of(self, status):
        return self.commands.wait(lambda m: m.header.stamp == status.header.stamp)


def northward(length=2000.0):
    mission = Mission()
    for north in (0.0, length):
        pose = Pose()
        pose.position.y = north
        pose.orientation.w = pose.orientation.z = math.sqrt(0.5)
        mission.waypoints.append(pose)
    return mission


def tracks(status):
    return status.mode == LateralStatus.TRACKING


class LateralNmpcTest(unittest.TestCase):
    def start(self, parameters=None):
        return self.start_as(self.id().split(".")[-1], parameters or {})

    def start_as(self, name, parameters):
        # Patience with a slow machine, except where silence is the subject.
        chosen = {"safety/state_timeout": 10.0, "safety/airspeed_timeout": 60.0}
        chosen.update(parameters)
        guidance = Guidance(name, chosen)
        self.addCleanup(guidance.stop)
        return guidance.connect()

    def test_levels_without_a_mission_and_turns_towards_one(self):
        guidance = self.start()
        status = guidance.exchange()
        self.assertEqual((status.mode, status.reason), (LateralStatus.LEVEL, LateralStatus.REASON_NO_MISSION))
        self.assertEqual(guidance.command_of(status).twist.angular.x, 0.0)
        guidance.mission.publish(northward())
        status = guidance.exchange(accept=tracks)
        self.assertAlmostEqual(status.track_error, 20.0, places=6)  # to the right of the line
        self.assertLess(status.roll_reference, -0.01)               # so it turns left
        self.assertEqual(guidance.command_of(status).twist.angular.x, status.roll_reference)
        self.assertEqual(status.segment_count, 2)
        self.assertGreater(status.feedback_time, 0.0)
        self.assertGreaterEqual(status.state_age, 0.0)
        guidance.mission.publish(Mission())
        guidance.exchange(accept=lambda s: s.reason == LateralStatus.REASON_NO_MISSION)

    def test_keeps_its_mission_when_a_bad_one_comes(self):
        guidance = self.start()
        guidance.mission.publish(northward())
        guidance.exchange(accept=tracks)
        bad = Mission(segments=[PathSegment(type=PathSegment.ARC, radius=-1.0, direction=1)])
        guidance.mission.publish(bad)
        elsewhere = northward(500.0)
        elsewhere.header.frame_id = "odom"  # the odometry's is map
        guidance.mission.publish(elsewhere)
        for _ in range(5):
            self.assertTrue(tracks(guidance.exchange()))

    def test_a_mission_that_came_before_the_odometry_is_judged_by_its_frame(self):
        for frame, reason in (("map", LateralStatus.REASON_NONE), ("odom", LateralStatus.REASON_NO_MISSION)):
            guidance = self.start_as("early_" + frame, {})
            mission = northward()
            mission.header.frame_id = frame
            guidance.mission.publish(mission)
            deadline = rospy.Time.now() + rospy.Duration(PATIENCE)
            while guidance.mission.get_num_connections() == 0 and rospy.Time.now() < deadline:
                rospy.sleep(0.02)
            rospy.sleep(0.3)  # until it is read
            self.assertEqual(guidance.exchange().reason, reason)

    def test_turns_that_cannot_be_flown_are_told_refused_or_widened(self):
        def loiter(radius):
            return Mission(segments=[PathSegment(type=PathSegment.LOITER, radius=radius, direction=1)])

        guidance = self.start({"path/tight_turns": "refuse", "path/wind_expected": 7.0})
        guidance.mission.publish(loiter(200.0))
        self.assertEqual(guidance.exchange(accept=tracks).reason, LateralStatus.REASON_NONE)
        guidance.mission.publish(loiter(60.0))  # less than the least of about 75 m
        for _ in range(5):
            self.assertLess(guidance.exchange(accept=tracks).segment_roll, 0.2)
        keeping = self.start_as("keeping", {})
        keeping.mission.publish(loiter(20.0))  # 28.5 m is the least in calm
        status = keeping.exchange(accept=tracks)
        self.assertEqual(status.reason, LateralStatus.REASON_TOO_STEEP)
        self.assertGreater(status.segment_roll, 0.611)
        widening = self.start_as("widening", {"path/tight_turns": "widen", "model/roll_rate_max": 1.2})
        widening.mission.publish(loiter(20.0))
        status = widening.exchange(accept=tracks)
        self.assertEqual(status.reason, LateralStatus.REASON_NONE)
        # The roll that nine tenths of the greatest reference hold: phi_r b0 / a0.
        self.assertAlmostEqual(status.segment_roll, 0.9 * 0.6108652381980153 * 13.48 / 13.97, places=6)

    def test_attitude_target_by_option(self):
        guidance = self.start({"output/attitude_target": True, "output/thrust": 0.5})
        guidance.mission.publish(northward())
        status = guidance.exchange(accept=tracks)
        target = guidance.attitudes.wait(lambda m: m.header.stamp == status.header.stamp)
        self.assertEqual(target.type_mask, 7)
        self.assertAlmostEqual(target.thrust, 0.5)
        roll = 2.0 * (target.orientation.w * target.orientation.x + target.orientation.y * target.orientation.z)
        self.assertAlmostEqual(roll, math.sin(status.roll_reference), places=6)

    def test_roll_rate_comes_from_the_imu(self):
        guidance = self.start()
        guidance.mission.publish(northward())
        before = guidance.exchange(accept=tracks)

        def spin(odometry):
            imu = Imu()
            imu.header.stamp = odometry.header.stamp
            imu.angular_velocity.x = float("nan")  # seen at once
            guidance.imu.publish(imu)

        guidance.exchange(spin, lambda s: s.reason == LateralStatus.REASON_NOT_FINITE)
        self.assertTrue(tracks(before))

    def test_nan_holds_then_levels_and_ends(self):
        guidance = self.start({"safety/hold_time": 0.5})
        guidance.mission.publish(northward())
        guidance.exchange(accept=tracks)

        def poison(odometry):
            odometry.pose.pose.position.x = float("nan")

        status = guidance.exchange(poison, lambda s: s.mode == LateralStatus.LEVEL)
        self.assertEqual(status.reason, LateralStatus.REASON_NOT_FINITE)
        self.assertEqual(guidance.command_of(status).twist.angular.x, 0.0)
        self.assertIsNotNone(guidance.statuses.wait(lambda m: m.mode == LateralStatus.HOLD_HORIZON))
        guidance.exchange(accept=tracks)

    def test_silence_is_answered_too(self):
        guidance = self.start({"safety/state_timeout": 0.2, "safety/hold_time": 0.3})
        guidance.mission.publish(northward())
        guidance.exchange()
        status = guidance.statuses.wait(
            lambda m: m.reason == LateralStatus.REASON_STALE and m.mode == LateralStatus.LEVEL)
        self.assertIsNotNone(status)
        self.assertGreater(status.state_age, 0.2)

    def test_wall_time_decides_where_simulated_time_stands(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.set_param, "/use_sim_time", False)
        guidance = self.start({"safety/state_timeout": 0.2, "safety/hold_time": 0.3})
        guidance.mission.publish(northward())
        guidance.exchange(accept=tracks)
        self.assertIsNotNone(guidance.statuses.wait(
            lambda m: m.reason == LateralStatus.REASON_STALE and m.mode == LateralStatus.LEVEL))
        guidance.exchange(accept=tracks)

    def test_low_airspeed_levels(self):
        guidance = self.start({"safety/airspeed_min": 20.0})
        guidance.mission.publish(northward())
        status = guidance.exchange(accept=lambda s: s.reason == LateralStatus.REASON_LOW_AIRSPEED)
        self.assertEqual(status.mode, LateralStatus.LEVEL)

    def test_standby_sends_nothing(self):
        guidance = self.start({"input/require_engaged": True})
        guidance.mission.publish(northward())
        status = guidance.exchange(accept=lambda s: s.mode == LateralStatus.STANDBY)
        self.assertIsNone(guidance.commands.wait(lambda m: m.header.stamp == status.header.stamp, RETRY))
        guidance.engaged.publish(Bool(data=True))
        guidance.exchange(accept=tracks)

    def test_follows_the_modes_of_the_autopilot(self):
        guidance = self.start({"input/watch_autopilot": True, "input/engaged_modes": "OFFBOARD, GUIDED",
                               "weights/track": 0.01})  # rolls slowly: the first reference shows where it began
        guidance.mission.publish(northward())
        said = State()

        def say(**fields):
            for name, value in dict({"connected": True, "armed": True, "mode": "OFFBOARD"}, **fields).items():
                setattr(said, name, value)
            repeat()

        def repeat():
            said.header.stamp = rospy.Time.now()
            guidance.state.publish(said)

        def expect_standby():
            status = guidance.exchange(bank, lambda s: s.mode == LateralStatus.STANDBY)
            self.assertEqual(status.reason, LateralStatus.REASON_NOT_ENGAGED)
            self.assertIn("another mode", status.text)
            # what is streamed is the roll that is flown
            self.assertAlmostEqual(guidance.command_of(status).twist.angular.x, 0.2, places=6)

        def bank(odometry):
            odometry.pose.pose.orientation.w = odometry.pose.pose.orientation.z = math.sqrt(0.5) * math.cos(0.1)
            odometry.pose.pose.orientation.x = odometry.pose.pose.orientation.y = math.sqrt(0.5) * math.sin(0.1)
            if said.connected:
                repeat()  # it is silent after 3 s

        expect_standby()  # the autopilot has not said anything yet
        for mode in ("OFFBOARD", "GUIDED"):
            say(mode=mode)
            guidance.exchange(bank, accept=tracks)
            first = guidance.statuses.wait(tracks)
            self.assertTrue(first.restarted)  # it begins anew from the roll that is flown
            self.assertLess(abs(first.roll_reference - 0.2), 0.2)
            guidance.statuses.messages.clear()
            for fields in ({"mode": "AUTO.LOITER"}, {"armed": False}, {"connected": False}):
                say(**fields)
                expect_standby()
                say(mode=mode)
                guidance.exchange(bank, accept=tracks)
            say(mode="MANUAL")
            expect_standby()
            guidance.statuses.messages.clear()

    def test_a_silent_autopilot_does_not_follow(self):
        guidance = self.start({"input/watch_autopilot": True})
        guidance.mission.publish(northward())
        state = State(connected=True, armed=True, mode="OFFBOARD")
        deadline = rospy.Time.now() + rospy.Duration(PATIENCE)
        followed = False
        while not followed and rospy.Time.now() < deadline:
            state.header.stamp = rospy.Time.now()
            guidance.state.publish(state)
            followed = tracks(guidance.exchange())
        self.assertTrue(followed)
        guidance.exchange(accept=lambda s: s.mode == LateralStatus.STANDBY)

    def test_flies_a_mission_from_a_file(self):
        guidance = self.start()
        with tempfile.NamedTemporaryFile("w", suffix=".yaml", delete=False) as file:
            file.write("path:\n  - spline: [[0, 0], [400, 5], [800, 0]]\n"
                       "  - lines: [[800, 0], [1200, 0]]\n")
        self.addCleanup(os.remove, file.name)
        command = [find_node("fixedwing_lateral", "publish_mission")[0], "__ns:=" + guidance.namespace,
                   "__name:=publisher", "_file:=" + file.name]
        process = subprocess.Popen(command)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        status = guidance.exchange(accept=tracks)
        self.assertEqual(status.segment_count, 3)
        self.assertLess(status.roll_reference, -0.01)

    def test_a_bad_mission_file_is_refused_with_its_place(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml", delete=False) as file:
            file.write("path:\n  - lines: [[0, 0]]\n")
        self.addCleanup(os.remove, file.name)
        command = [find_node("fixedwing_lateral", "publish_mission")[0], "__name:=bad", "_file:=" + file.name]
        ended = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                               timeout=PATIENCE, check=False)
        self.assertEqual(ended.returncode, 1)
        self.assertIn(file.name + ":2: path[0].lines: must be at least two points", ended.stdout)

    def test_reconfigures_in_flight(self):
        guidance = self.start({"limits/roll_reference": 0.5})
        guidance.mission.publish(northward())
        guidance.exchange(accept=tracks)
        client = dynamic_reconfigure.client.Client(guidance.namespace + "/guidance", timeout=PATIENCE)
        self.assertAlmostEqual(client.get_configuration(timeout=PATIENCE)["limits_roll_reference"], 0.5)
        client.update_configuration({"limits_roll_reference": 0.05, "weights_track": 1.0})
        status = guidance.exchange(accept=lambda s: abs(s.roll_reference) <= 0.05 and tracks(s))
        self.assertAlmostEqual(status.roll_reference, -0.05, places=6)
        for track in (1e9, 100.0, float("nan")):  # refused as a whole
            refused = client.update_configuration({"weights_track": track, "weights_course": 11.0})
            self.assertEqual((refused["weights_track"], refused["weights_course"]), (1.0, 10.0))

    def test_markers_and_diagnostics(self):
        guidance = self.start()
        markers = guidance.collector("lateral_markers", MarkerArray)
        diagnostics = Collector("/diagnostics", DiagnosticArray)
        guidance.mission.publish(northward())
        guidance.exchange(accept=tracks)
        found = None
        deadline = rospy.Time.now() + rospy.Duration(PATIENCE)
        while not found and rospy.Time.now() < deadline:
            guidance.exchange(accept=tracks)
            found = markers.wait(lambda m: {marker.ns for marker in m.markers[1:]} == {"prediction", "mission"}, RETRY)
        self.assertIsNotNone(found)

        def is_ours(array):
            return any(guidance.namespace[1:] in status.name and status.message.startswith("tracking") for status in array.status)

        seen = None
        while not seen and rospy.Time.now() < deadline:
            guidance.exchange(accept=tracks)
            seen = diagnostics.wait(is_ours, RETRY)
        self.assertIsNotNone(seen)

    def test_refuses_parameters_that_are_not_fit(self):
        for parameters, sentence in (({"weights/trakc": 1.0}, "/guidance/weights/trakc: unknown"),
                                     ({"weigths/track": 1.0}, "weigths: unknown group; is 'weights' meant?"),
                                     ({"horizon/step": -1.0}, "/guidance/horizon/step: must lie in"),
                                     ({"guidance/delay": 0.1}, "guidance/delay: is removed: model/a1"),
                                     ({"path/choose_side": True}, "is removed: guidance/as_published: true")):
            name = "refusal_%d" % abs(hash(sentence))
            guidance = Guidance(name, parameters)
            self.addCleanup(guidance.stop)
            output = guidance.output_at_end()
            self.assertNotEqual(guidance.process.returncode, 0)
            self.assertIn("lateral guidance does not start", output)
            self.assertIn(sentence, output)

    def test_messages_are_those_of_mavros(self):
        # ROS's rule for the checksum of a message, applied to the fields of the original definitions.
        header = Header()._md5sum
        target = AttitudeTarget()
        constants = "uint8 IGNORE_ROLL_RATE=1\nuint8 IGNORE_PITCH_RATE=2\nuint8 IGNORE_YAW_RATE=4\nuint8 IGNORE_THRUST=64\n" \
                    "uint8 IGNORE_ATTITUDE=128\n"
        text = constants + "%s header\nuint8 type_mask\n%s orientation\n%s body_rate\nfloat32 thrust" % (
            header, target.orientation._md5sum, target.body_rate._md5sum)
        self.assertEqual(AttitudeTarget._md5sum, hashlib.md5(text.encode()).hexdigest())
        text = "%s header\nfloat32 airspeed\nfloat32 groundspeed\nint16 heading\nfloat32 throttle\nfloat32 altitude\n" \
               "float32 climb" % header
        self.assertEqual(VFR_HUD._md5sum, hashlib.md5(text.encode()).hexdigest())
        text = "%s header\nbool connected\nbool armed\nbool guided\nbool manual_input\nstring mode\nuint8 system_status" % header
        self.assertEqual(State._md5sum, hashlib.md5(text.encode()).hexdigest())
        self.assertEqual(State._md5sum, "ce783f756cab1193cb71ba9e90fece50")  # as mavros 1 has it


if __name__ == "__main__":
    rospy.init_node("lateral_nmpc_test")
    rostest.rosrun("fixedwing_lateral", "lateral_nmpc_" + VARIANT, LateralNmpcTest, sys.argv)
