"""One flight of Betaflight's SITL, in wall time: plays mavros and the vehicle, sends the references, and judges.

usage: betaflight_flight.py RESULT.json. SITL and multirotor_mavros.launch run already. Exits with 3 where SITL did not arm.
"""

import json
import math
import sys
import threading
import time

import rospy
from geometry_msgs.msg import PoseStamped, Transform, Twist
from mavros_msgs.msg import AttitudeTarget
from nav_msgs.msg import Odometry
from std_srvs.srv import Empty
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint

from betaflight_link import GREATEST_GAP, LIMITS, SETTLED, Link, NotArmed, conjugate, roll_pitch, rotated

HEIGHT, STEP = 1.5, 1.25  # [m]
WIND = (0.8, -0.5, 0.0)  # [m/s^2]
COURSE_STEP = 250  # samples of the state between two rows (time [s], distance [m]) of the result
EIGHT_PERIOD, EIGHT_SIZE = 8.0, (1.2, 0.6)  # [s], [m]
# Time since take-off at which each part begins [s]; the last one is the end.
PARTS = (("take-off", 0.0), ("hover", 7.0), ("step", 13.0), ("eight", 19.0), ("wind", 30.0),
         ("loss", 52.0), ("after", 53.0), ("end", 68.0))
START = dict(PARTS)


def eight(since):
    """Position, velocity and acceleration. It starts from rest by a smooth phase, and stays at the end."""
    s = max(0.0, min(1.0, since / EIGHT_PERIOD))
    phase = 2.0 * math.pi * (s ** 3 * (10.0 - 15.0 * s + 6.0 * s * s))
    rate = 2.0 * math.pi * 30.0 * s * s * (1.0 - s) ** 2 / EIGHT_PERIOD
    change = 2.0 * math.pi * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / EIGHT_PERIOD ** 2
    rows = [(STEP, 0.0, 0.0)]
    for size, n in zip(EIGHT_SIZE, (1, 2)):
        sine, cosine = math.sin(n * phase), math.cos(n * phase)
        rows.append((size * sine, size * n * cosine * rate, size * n * (cosine * change - n * sine * rate * rate)))
    return [(rows[0][i] + rows[1][i], rows[2][i], HEIGHT if i == 0 else 0.0) for i in range(3)]


def eight_message():
    message = MultiDOFJointTrajectory()
    for i in range(int(EIGHT_PERIOD / 0.05) + 1):
        (x, y, z), velocity, acceleration = eight(0.05 * i)
        point = MultiDOFJointTrajectoryPoint(time_from_start=rospy.Duration(0.05 * i))
        transform = Transform()
        transform.translation.x, transform.translation.y, transform.translation.z = x, y, z
        transform.rotation.w = 1.0
        twists = (Twist(), Twist())
        for twist, (a, b, c) in zip(twists, (velocity, acceleration)):
            twist.linear.x, twist.linear.y, twist.linear.z = a, b, c
        point.transforms, point.velocities, point.accelerations = [transform], [twists[0]], [twists[1]]
        message.points.append(point)
    message.header.frame_id = "map"
    return message


class Bridge(Link):
    """Between SITL, the vehicle and the node."""

    def __init__(self):
        super().__init__()
        self.command_time, self.greatest_gap = None, 0.0
        self.counts_gaps, self.silent = False, False
        self.odometry = rospy.Publisher("mavros/local_position/odom", Odometry, queue_size=1, tcp_nodelay=True)
        rospy.Subscriber("mavros/setpoint_raw/attitude", AttitudeTarget, self.on_target, queue_size=1, tcp_nodelay=True)

    def on_target(self, message):
        now = time.monotonic()
        if self.command_time is not None and self.counts_gaps:
            self.greatest_gap = max(self.greatest_gap, now - self.command_time)
        q = message.orientation
        self.command_time = now
        self.command = (*roll_pitch((q.w, q.x, q.y, q.z)), message.body_rate.z, message.thrust)

    def on_odometry(self, now):
        if self.silent:
            return
        message, plant = Odometry(), self.plant
        message.header.stamp = rospy.Time.now()
        message.header.frame_id, message.child_frame_id = "map", "base_link"
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x, pose.position.y, pose.position.z = plant.position
        pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z = plant.attitude
        twist.linear.x, twist.linear.y, twist.linear.z = rotated(conjugate(plant.attitude), plant.velocity)
        twist.angular.x, twist.angular.y, twist.angular.z = plant.rates
        self.odometry.publish(message)


class Flight:
    """Sends the references by PARTS, and keeps the distance from them."""

    def __init__(self):
        self.bridge = Bridge()
        self.pose = rospy.Publisher("command/pose", PoseStamped, queue_size=1, latch=True)
        self.trajectory = rospy.Publisher("command/trajectory", MultiDOFJointTrajectory, queue_size=1)
        self.take_off = rospy.ServiceProxy("takeoff", Empty)
        self.part, self.errors = None, {name: [] for name in LIMITS}

    def send_pose(self, x):
        message = PoseStamped()
        message.header.frame_id, message.pose.orientation.w = "map", 1.0
        message.pose.position.x, message.pose.position.z = x, HEIGHT
        self.pose.publish(message)

    def begin(self, part):
        bridge = self.bridge
        if part == "take-off":
            # The answer of the service must not stop the vehicle's time.
            threading.Thread(target=self.take_off, daemon=True).start()
        elif part in ("hover", "step"):
            self.send_pose(STEP if part == "step" else 0.0)
        elif part == "eight":
            self.trajectory.publish(eight_message())
        bridge.plant.wind = WIND if part == "wind" else (0.0, 0.0, 0.0)
        bridge.silent = part == "loss"
        # Silence is a gap of its own: nothing is sent until odometry counts as silent.
        bridge.counts_gaps = part not in ("take-off", "loss")
        bridge.command_time = None
        self.part = part

    def on_time(self, now):
        if rospy.is_shutdown():
            return False
        since = self.bridge.since_take_off(now)
        part = next((name for name, start in reversed(PARTS) if since >= start), None)
        if part == "end":
            return False
        if part != self.part:
            self.begin(part)
        if part in LIMITS:
            target = eight(since - START["eight"])[0] if since >= START["eight"] else (STEP if part == "step" else 0.0, 0.0, HEIGHT)
            self.errors[part].append((since, math.dist(self.bridge.plant.position, target)))
        return True

    def result(self):
        numbers = {}
        for part, rows in self.errors.items():
            if part == "eight":
                numbers[part] = math.sqrt(sum(e * e for _, e in rows) / len(rows))
            else:
                numbers[part] = max(e for t, e in rows if part == "loss" or t >= rows[-1][0] - SETTLED)
        gap = self.bridge.greatest_gap
        well = all(numbers[part] <= limit for part, limit in LIMITS.items())
        rows = [row for part in self.errors.values() for row in part]
        course = [[round(t, 2), round(e, 4)] for t, e in rows[::COURSE_STEP]]
        return {"distance_m": numbers, "course": course, "greatest_gap_s": gap, "counts": gap < GREATEST_GAP, "well": well}


def main(path):
    rospy.init_node("betaflight")
    rospy.wait_for_service("takeoff", 30.0)
    flight = Flight()
    flight.bridge.run(flight.on_time)
    result = flight.result()
    with open(path, "w") as file:
        json.dump(result, file, indent=2)
    print(json.dumps(result["distance_m"]), "greatest gap %.3f s" % result["greatest_gap_s"])


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except NotArmed as error:
        print(error)
        sys.exit(3)
