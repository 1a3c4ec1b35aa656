#!/usr/bin/env python3
"""The three nodelets in one manager get messages with any stamp, and answer the true ones. By the system's clock, and by a
simulated clock beyond the year 2038. No result depends on how long anything takes."""

import os
import subprocess
import sys
import unittest

import rospkg
import rospy
import rostest
from fixedwing_lateral.msg import LateralStatus, Mission
from geometry_msgs.msg import Pose, PoseStamped, TwistWithCovarianceStamped
from mav_msgs.msg import RollPitchYawrateThrust
from mavros_msgs.msg import VFR_HUD, ExtendedState, State
from nav_msgs.msg import Odometry
from online_controller.msg import CommandFilterStatus, ControllerStatus
from roslib.packages import find_node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, Joy
from trajectory_msgs.msg import MultiDOFJointTrajectory

# The partners for topics are those of the packages' own tests.
sys.path.insert(0, os.path.join(rospkg.RosPack().get_path("online_controller"), "test", "ros"))
from controller_process import HOVER, MapsFixture, pose_at  # noqa: E402
from node_or_nodelet import PATIENCE, RETRY, Collector, Program  # noqa: E402

NODELET = find_node("nodelet", "nodelet")[0]
HOSTILE = (4294967295, 0, 2147483647, 2147483648)  # [s]
PERIOD = 0.1  # of the guidance [s]
AIRSPEED = 14.0  # [m/s]


class Nodelets(Program):
    """A manager with the three nodelets, and a publisher for each of their topics with a stamp."""

    def __init__(self, namespace, maps, fence):
        super().__init__([NODELET, "manager"], namespace, "manager")
        self.loaders = []
        self.load("controller", "online_controller/ExplicitMpc",
                  dict({"maps/" + axis: path for axis, path in maps.items()}, **{
                      "controller/stale_periods": 10000, "controller/solve_outside": False, "use_rc_teleop": False}))
        self.load("filter", "online_controller/SafetyFilter",
                  {"maps/x": fence, "silence_periods": 100.0, "stale_periods": 100.0})
        self.load("guidance", "fixedwing_lateral/LateralNmpc", {"safety/state_timeout": 10.0})
        kinds = {"odometry": Odometry, "command/trajectory": MultiDOFJointTrajectory, "command/pose": PoseStamped, "rc": Joy,
                 "mavros/state": State, "mavros/extended_state": ExtendedState, "mavros/local_position/odom": Odometry,
                 "mavros/imu/data": Imu, "mavros/vfr_hud": VFR_HUD, "mission": Mission,
                 "mavros/wind_estimation": TwistWithCovarianceStamped,
                 "wished/roll_pitch_yawrate_thrust": RollPitchYawrateThrust}
        self.kinds = kinds
        self.publishers = {topic: self.publisher(topic, kind) for topic, kind in kinds.items()}
        self.statuses = {topic: self.collector(topic, kind) for topic, kind in (
            ("controller_status", ControllerStatus), ("filter_status", CommandFilterStatus),
            ("lateral_status", LateralStatus))}
        self.east = 0.0  # of the aircraft [m]

    def load(self, name, kind, parameters):
        for key, value in parameters.items():
            rospy.set_param("/".join((self.namespace, name, key)), value)
        self.loaders.append(subprocess.Popen(
            [NODELET, "load", kind, self.namespace + "/manager", "__ns:=" + self.namespace, "__name:=" + name]))

    def stop(self):
        for loader in self.loaders:
            loader.terminate()
            loader.wait(PATIENCE)
        super().stop()

    def message(self, topic, stamp):
        """One that a vehicle at rest, or an aircraft on its way, could send."""
        message = self.kinds[topic]()
        message.header.stamp = stamp
        if topic == "odometry":
            message.header.frame_id = "world"
            message.pose.pose.orientation.w = 1.0
        elif topic == "mavros/local_position/odom":
            message.pose.pose.position.x = self.east
            message.pose.pose.orientation.w = 1.0
            message.twist.twist.linear.x = AIRSPEED
        elif topic == "mavros/vfr_hud":
            message.airspeed = AIRSPEED
        elif topic.startswith("wished"):
            message.thrust.z = HOVER
        elif topic == "command/pose":
            message = pose_at(0.0, 0.0, 0.0)
            message.header.stamp = stamp
        elif topic == "mission":
            for east in (0.0, 2000.0):
                pose = Pose()
                pose.position.x = east
                pose.orientation.w = 1.0
                message.waypoints.append(pose)
        return message

    def send(self, topics, stamp):
        for topic in topics:
            self.publishers[topic].publish(self.message(topic, stamp))

    def connected(self):
        return all(p.get_num_connections() > 0 for p in self.publishers.values())


class HostileStampsTest(MapsFixture):
    VEHICLE = ("odometry", "wished/roll_pitch_yawrate_thrust")
    AIRCRAFT = ("mavros/imu/data", "mavros/vfr_hud", "mavros/wind_estimation", "mavros/local_position/odom")

    def fly(self, namespace, now):
        """`now` gives the true time, which goes on with each call."""
        nodelets = Nodelets(namespace, self.maps, os.path.join(self.folder.name, "fence.map"))
        self.addCleanup(nodelets.stop)

        start = now()

        def answered(wanted):
            def ask():
                self.assertIsNone(nodelets.process.poll(), "the manager has ended")
                if not nodelets.connected():
                    now()
                    rospy.sleep(0.05)
                    return None
                stamp = now()
                nodelets.east = AIRSPEED * (stamp - start).to_sec()
                nodelets.send(self.AIRCRAFT + self.VEHICLE, stamp)
                statuses = [nodelets.statuses[topic].wait(lambda m: m.header.stamp == stamp, RETRY) for topic in sorted(
                    nodelets.statuses)]
                return all(s is not None for s in statuses) and wanted(*statuses)

            nodelets.answer(ask)

        def well(controller, filtered, guidance):
            return (controller.status == ControllerStatus.OPTIMAL and filtered.status == CommandFilterStatus.PASSED and
                    guidance.mode == LateralStatus.TRACKING)

        deadline = rospy.Time.now() + rospy.Duration(PATIENCE)
        while not nodelets.connected() and rospy.Time.now() < deadline:
            now()
            rospy.sleep(0.05)
        # The very first message of each topic is wrong.
        nodelets.send(nodelets.kinds, rospy.Time(HOSTILE[0]))
        nodelets.send(("command/pose", "mission"), rospy.Time(0))
        answered(well)
        for seconds in HOSTILE:
            nodelets.send(nodelets.kinds, rospy.Time(seconds))
            nodelets.send(("command/pose", "mission"), rospy.Time(0))
            answered(well)
        nodelets.process.terminate()
        self.assertNotIn("out of dual 32-bit range", nodelets.output_at_end())

    def test_by_the_clock_of_the_system(self):
        self.fly("by_system", rospy.Time.now)

    def test_by_a_clock_beyond_2038(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.set_param, "/use_sim_time", False)
        clock = rospy.Publisher("/clock", Clock, queue_size=1)
        steps = [0]

        def now():
            steps[0] += 1
            time = rospy.Time(3000000000) + rospy.Duration(PERIOD * steps[0])
            clock.publish(time)
            return time

        self.fly("beyond", now)


if __name__ == "__main__":
    rospy.init_node("hostile_stamps_test")
    rostest.rosrun("polyfly_test", "hostile_stamps", HostileStampsTest, sys.argv)
