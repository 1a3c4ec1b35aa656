"""The multirotor's controller under test, with a partner for its topics and maps to fly."""

import os
import subprocess
import tempfile
import unittest

import rospkg
import rospy
from geometry_msgs.msg import PoseStamped
from mav_msgs.msg import RollPitchYawrateThrust
from nav_msgs.msg import Odometry
from online_controller.msg import ControllerStatus
from roslib.packages import find_node
from trajectory_msgs.msg import MultiDOFJointTrajectory

import node_or_nodelet

HOVER = 1.52 * 9.8066
AXES = ("longitudinal", "lateral", "vertical")


def make_maps(folder):
    package = os.path.realpath(rospkg.RosPack().get_path("region_maps"))
    environment = dict(os.environ, POLYFLY_ROOT=os.path.dirname(os.path.dirname(package)))
    subprocess.run([find_node("online_controller", "make_test_maps")[0], folder], env=environment, check=True)


def pose_at(x, y, z):
    pose = PoseStamped()
    pose.header.frame_id = "world"
    pose.pose.position.x, pose.pose.position.y, pose.pose.position.z = x, y, z
    pose.pose.orientation.w = 1.0
    return pose


class Controller(node_or_nodelet.Program):
    """Runs `command`, or without one the node or nodelet that is tested."""

    def __init__(self, namespace, maps=None, parameters=None, name="controller", command=None):
        chosen = {"maps/" + axis: path for axis, path in (maps or {}).items() if path}
        chosen.update(parameters or {})
        super().__init__(command or node_or_nodelet.command_line("online_controller", "explicit_mpc_node", "ExplicitMpc"), namespace,
                         name, chosen)

    def connect(self):
        self.odometry = self.publisher("odometry", Odometry)
        self.pose = self.publisher("command/pose", PoseStamped, latch=True)
        self.trajectory = self.publisher("command/trajectory", MultiDOFJointTrajectory, latch=True)
        self.commands = self.collector("command/roll_pitch_yawrate_thrust", RollPitchYawrateThrust)
        self.statuses = self.collector("controller_status", ControllerStatus)
        return self

    def exchange(self, change=lambda odometry: None, accept=lambda status: True):
        """Sends odometry until command and status with its stamp have arrived and the status is accepted. Without a reference
        there is no command."""
        def ask():
            odometry = Odometry()
            odometry.header.frame_id = "world"
            odometry.pose.pose.orientation.w = 1.0
            odometry.header.stamp = rospy.Time.now()
            change(odometry)
            stamp = odometry.header.stamp
            self.odometry.publish(odometry)
            status = self.statuses.wait(lambda m: m.header.stamp == stamp, node_or_nodelet.RETRY)
            if not status or not accept(status):
                return None
            if status.status == ControllerStatus.NO_REFERENCE:
                return None, status
            command = self.commands.wait(lambda m: m.header.stamp == stamp, node_or_nodelet.RETRY)
            return (command, status) if command else None

        return self.answer(ask)


class MapsFixture(unittest.TestCase):
    """Tests with maps of the three axes."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        make_maps(cls.folder.name)
        cls.maps = {axis: os.path.join(cls.folder.name, axis + ".map") for axis in AXES}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def fly(self, parameters=None, maps=None):
        # Patience with a slow machine, except where silence is the subject.
        # The maps' laws are not the optimum of their problems, so nothing is solved where they end.
        chosen = {"controller/stale_periods": 10000, "controller/solve_outside": False}
        chosen.update(parameters or {})
        controller = Controller(self.id().split(".")[-1], maps or self.maps, chosen)
        self.addCleanup(controller.stop)
        return controller.connect()

    def refusal(self, maps=None, parameters=None):
        """What it says when it must not start."""
        controller = Controller("refusal_" + self.id().split(".")[-1], self.maps if maps is None else maps, parameters)
        output = controller.output_at_end()
        self.assertNotEqual(controller.process.returncode, 0)
        rospy.delete_param(controller.namespace)
        self.assertEqual(output.count("MPC does not start"), 1, output)
        return output
