#!/usr/bin/env python3
"""The exciting node on a fixed wing in simulated time: from the plan to the roll loop that `calibrate` finds."""
import math
import os
import shutil
import subprocess
import tempfile
import threading
import unittest

import rosbag
import rospy
import rostest
import yaml
from mavros_msgs.msg import AttitudeTarget
from nav_msgs.msg import Odometry
from roslib.packages import find_node
from sensor_msgs.msg import Joy
from std_msgs.msg import String

PATIENCE = 40.0  # for a whole flight, in wall time [s]
AMPLITUDES = (0.15, 0.25)
PLAN = """rest: 2
manoeuvres:
  - {shape: 2-1-1, channels: roll, amplitudes: [0.15, 0.25], unit_time: 0.5}
  - {shape: multisine, channels: roll, amplitudes: 0.2, both_signs: false, length: 15, frequency_from: 0.2,
     frequency_to: 2, tones: 8}
"""
# The plant's roll loop (RoughOptions): p'' = 25 (0.96 command - roll) - 2 * 0.75 * 5 p', delayed.
TRUTH = {"a0": 25.0, "a1": 7.5, "b0": 24.0, "delay": 0.1}
GAIN = TRUTH["b0"] / TRUTH["a0"]


def roll_of(q):
    return math.atan2(2.0 * (q.w * q.x + q.y * q.z), 1.0 - 2.0 * (q.x * q.x + q.y * q.y))


class Recorder:
    """Everything that is said in a namespace, in the order of arrival."""

    KINDS = {"mavros/local_position/odom": Odometry, "mavros/setpoint_raw/attitude": AttitudeTarget,
             "excitation/state": String}

    def __init__(self, space):
        self.messages = {topic: [] for topic in self.KINDS}
        self.changed = threading.Condition()
        self.subscribers = [rospy.Subscriber(space + "/" + topic, kind, self.take, topic, tcp_nodelay=True)
                            for topic, kind in self.KINDS.items()]

    def take(self, message, topic):
        with self.changed:
            self.messages[topic].append(message)
            self.changed.notify_all()

    def wait(self, topic, condition):
        with self.changed:
            return self.changed.wait_for(lambda: any(condition(m) for m in self.messages[topic]), PATIENCE)

    def end(self):
        for subscriber in self.subscribers:
            subscriber.unregister()

    def write(self, path):
        with rosbag.Bag(path, "w") as bag:
            for topic in list(self.KINDS)[:2]:
                for message in self.messages[topic]:
                    bag.write("/" + topic, message, message.header.stamp)


class ExciteWing(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="polyfly_excite_wing_")
        self.addCleanup(shutil.rmtree, self.folder)
        self.plan = os.path.join(self.folder, "plan.yaml")
        with open(self.plan, "w") as file:
            file.write(PLAN)

    def run_program(self, command):
        process = subprocess.Popen(command)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        return process

    def fly(self, space, until):
        """A flight in this namespace as far as `until(recorder)` waits."""
        parameters = {"plan": self.plan, "vehicle": {"wing": True}, "input": {"require_engaged": False},
                      "limits": {"distance_max": 1000.0, "height_max": 50.0}}
        rospy.set_param(space + "/excite", parameters)
        recorder = Recorder(space)
        programs = [self.run_program([find_node("calibration", "excite")[0], "__ns:=" + space, "__name:=excite"]),
                    self.run_program([find_node("fixedwing_lateral", "lateral_plant_node")[0], "__ns:=" + space])]
        try:
            self.assertTrue(until(recorder), [m.data for m in recorder.messages["excitation/state"]])
        finally:
            for program in reversed(programs):  # two plants must not both keep the time
                program.terminate()
                program.wait()
            recorder.end()
        return recorder

    def test_the_bag_is_complete_and_gives_the_roll_loop(self):
        recorder = self.fly("/whole", lambda r: r.wait("excitation/state", lambda m: m.data == "done"))
        states = [m.data for m in recorder.messages["excitation/state"]]
        self.assertEqual(sum("roll 2-1-1" in state for state in states), 2 * len(AMPLITUDES))
        self.assertIn("running: roll multisine 0.2 rad (5 of 5)", states)
        answered = {m.header.stamp for m in recorder.messages["mavros/local_position/odom"]}
        commands = recorder.messages["mavros/setpoint_raw/attitude"]
        self.assertTrue({m.header.stamp for m in commands} <= answered)
        self.assertGreater(len(commands), 700)  # 35 s at 20 Hz
        rolls = [roll_of(m.orientation) for m in commands]
        jumps = [abs(after - before) for before, after in zip(rolls, rolls[1:])]
        for amplitude in AMPLITUDES:  # from one pulse to the next, twice in each 2-1-1
            self.assertGreaterEqual(sum(abs(jump - 2.0 * amplitude) < 1e-6 for jump in jumps), 4)
        self.assertLessEqual(max(map(abs, rolls)), 0.5 + 1e-9)  # while it turns back too
        flown = [roll_of(m.pose.pose.orientation) for m in recorder.messages["mavros/local_position/odom"]]
        self.assertGreater(max(flown) - min(flown), 2.0 * AMPLITUDES[0])
        self.assertLess(max(map(abs, flown)), 0.6)  # the limit of the flight

        bag, result = os.path.join(self.folder, "wing.bag"), os.path.join(self.folder, "roll.yaml")
        recorder.write(bag)
        told = subprocess.run([find_node("calibration", "calibrate")[0], "attitude", bag, "--axis", "roll",
                               "--vehicle", "fixed_wing", "-o", result],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=PATIENCE)
        self.assertEqual(told.returncode, 0, told.stdout)
        with open(result) as file:
            roll = yaml.safe_load(file)["axes"]["roll"]
        self.assertTrue(roll["supported"])
        model = roll["model_second_order"]
        for name, true in TRUTH.items():  # the plant integrates in steps, which moves its constants by 2 %
            self.assertAlmostEqual(model[name], true, delta=0.03 * true, msg=told.stdout)
        self.assertAlmostEqual(model["b0"] / model["a0"], GAIN, delta=0.005)

    def test_a_stick_ends_all_commands(self):
        sticks = rospy.Publisher("/stick/joy", Joy, queue_size=10)

        def push(recorder):
            if not recorder.wait("excitation/state", lambda m: "2-1-1" in m.data):
                return False
            sticks.publish(Joy(axes=[0.1, 0.0, 0.0, 0.0]))
            sticks.publish(Joy(axes=[0.1, 0.0, 0.4, 0.0]))
            if not recorder.wait("excitation/state", lambda m: m.data == "handed over: a stick was moved"):
                return False
            rospy.rostime.wallsleep(0.5)  # what was under way has arrived
            self.commands = len(recorder.messages["mavros/setpoint_raw/attitude"])
            states = len(recorder.messages["mavros/local_position/odom"])
            # The plant flies on by itself.
            return recorder.wait("mavros/local_position/odom",
                                 lambda _: len(recorder.messages["mavros/local_position/odom"]) > states + 3)

        recorder = self.fly("/stick", push)
        self.assertEqual(len(recorder.messages["mavros/setpoint_raw/attitude"]), self.commands)


if __name__ == "__main__":
    rospy.init_node("excite_wing_test")
    rostest.rosrun("calibration", "excite_wing", ExciteWing)
