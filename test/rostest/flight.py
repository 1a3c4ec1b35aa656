"""Flies the demonstration's launch file and reads the bag that it leaves."""

import math
import os
import subprocess
import tempfile

import rosbag
import rospkg
import yaml

AXES = ("longitudinal", "lateral", "vertical")
TIME_LIMIT = 120  # wall time of one launch [s]


def maps_folder():
    """The folder of region maps that the environment names; AssertionError with what to do otherwise."""
    folder = os.environ.get("POLYFLY_MAPS", "")
    if not folder:
        raise AssertionError(
            "POLYFLY_MAPS is not set: it must name the folder with multirotor_longitudinal.map, "
            "multirotor_lateral.map and multirotor_vertical.map (./run test solves them and sets it)"
        )
    for axis in AXES:
        path = os.path.join(folder, "multirotor_%s.map" % axis)
        if not os.path.isfile(path):
            raise AssertionError("POLYFLY_MAPS=%s: there is no %s" % (folder, path))
    return folder


def problem_path(name):
    """A problem file, which lies beside the package of maps."""
    return os.path.join(os.path.realpath(rospkg.RosPack().get_path("region_maps")), "..", "problems", name + ".yaml")


class Launch:
    """One run of demo.launch, or another: `output` is what it said, `bag` the file if it left one."""

    def __init__(self, folder, name, overrides=None, maps=None, launch="demo.launch", **arguments):
        self.bag = os.path.join(folder, name + ".bag")
        arguments.update(maps_dir=maps or maps_folder(), bag=self.bag)
        if overrides:
            arguments["overrides"] = os.path.join(folder, name + ".yaml")
            with open(arguments["overrides"], "w") as file:
                yaml.safe_dump(overrides, file)
        command = ["roslaunch", "polyfly_launch", launch]
        command += ["%s:=%s" % item for item in sorted(arguments.items())]
        # The launch uses the master of this test. A file takes the output, since a pipe would be held open by stragglers.
        with tempfile.TemporaryFile("w+") as log:
            subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, timeout=TIME_LIMIT, check=False)
            log.seek(0)
            self.output = log.read()


class Flight:
    """The messages of a bag by topic, in the order of their stamps where they have one."""

    def __init__(self, launch):
        if not os.path.isfile(launch.bag):
            raise AssertionError("the flight left no bag; it said:\n" + launch.output)
        self.name = os.path.basename(launch.bag)
        self.output = launch.output
        self.messages = {}
        self.raw = {}
        with rosbag.Bag(launch.bag) as bag:
            for topic, message, _ in bag.read_messages():
                self.messages.setdefault(topic, []).append(message)
        with rosbag.Bag(launch.bag) as bag:
            for topic, message, _ in bag.read_messages(raw=True):
                self.raw.setdefault(topic, []).append(bytes(message[1]))
        self.trajectory = self.messages["/command/trajectory"][0]
        self.start = self.trajectory.header.stamp
        self.odometry = self.messages["/odometry"]
        self.truth = self.messages["/ground_truth/odometry"]
        self.commands = self.messages["/command/roll_pitch_yawrate_thrust"]
        self.statuses = self.messages["/controller_status"]
        self.summary = yaml.safe_load(self.messages["/flight/summary"][0].data)

    def time(self, message):
        """Seconds since the start of the flight."""
        return (message.header.stamp - self.start).to_sec()

    def between(self, messages, begin, end):
        return [m for m in messages if begin <= self.time(m) < end]

    def reference(self, time):
        """Position of the trajectory: the cubic through its points and their velocities."""
        points = self.trajectory.points
        step = points[1].time_from_start.to_sec()
        index = min(max(int(time / step + 1e-9), 0), len(points) - 2)
        s = min(max(time / step - index, 0.0), 1.0)
        first, second = points[index], points[index + 1]
        position = []
        for axis in "xyz":
            p0 = getattr(first.transforms[0].translation, axis)
            p1 = getattr(second.transforms[0].translation, axis)
            v0 = getattr(first.velocities[0].linear, axis) * step
            v1 = getattr(second.velocities[0].linear, axis) * step
            position.append(
                p0 * (1 - s * s * (3 - 2 * s))
                + p1 * s * s * (3 - 2 * s)
                + v0 * s * (1 - s) ** 2
                - v1 * s * s * (1 - s)
            )
        return position

    def errors(self, begin=0.0, end=1e9):
        """True position minus reference, for each sample in [begin, end)."""
        found = []
        for message in self.between(self.truth, begin, end):
            position = message.pose.pose.position
            wanted = self.reference(self.time(message))
            found.append([position.x - wanted[0], position.y - wanted[1], position.z - wanted[2]])
        if not found:
            raise AssertionError("no sample between %g s and %g s" % (begin, end))
        return found

    def rms(self, begin=0.0, end=1e9):
        errors = self.errors(begin, end)
        return math.sqrt(sum(x * x + y * y + z * z for x, y, z in errors) / len(errors))

    def mean_offset(self, begin, end):
        errors = self.errors(begin, end)
        return math.sqrt(sum((sum(error[i] for error in errors) / len(errors)) ** 2 for i in range(3)))
