#!/usr/bin/env python3
"""Take-off, landing, remote control and observer over their services and topics, on a vehicle that stands on a floor."""

import math
import sys

import rospy
import rostest
from mavros_msgs.msg import ExtendedState, State
from online_controller.msg import ControllerStatus, FlightStatus, ObserverState
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Joy
from std_msgs.msg import Header, String
from std_srvs.srv import Empty, Trigger
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint
from geometry_msgs.msg import Transform

from controller_process import Controller, MapsFixture, pose_at
from node_or_nodelet import PATIENCE, Collector

MASS, GRAVITY, PERIOD = 1.52, 9.8066, 0.01
MANUAL, POSITION = -1.0, 1.0  # of the mode axis


class Vehicle:
    """A point mass that leans at once. Its time is that of the stamps, and goes as fast as the answers come."""

    def __init__(self, controller):
        self.controller = controller
        self.time = rospy.Time.now().to_sec()
        self.position, self.velocity = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        self.frame = "world"
        self.roll = self.pitch = 0.0

    def fill(self, odometry):
        odometry.header.stamp = rospy.Time.from_sec(self.time)
        odometry.header.frame_id = self.frame
        position, twist = odometry.pose.pose.position, odometry.twist.twist.linear
        position.x, position.y, position.z = self.position
        orientation = odometry.pose.pose.orientation
        cr, sr, cp, sp = (f(0.5 * a) for a in (self.roll, self.pitch) for f in (math.cos, math.sin))
        orientation.w, orientation.x, orientation.y, orientation.z = cp * cr, cp * sr, sp * cr, -sp * sr
        # Angles stay small here: the body's axes are those of the world, to the accuracy that a hover needs.
        vx, vy, vz = self.velocity
        twist.x, twist.y, twist.z = vx - self.pitch * vz, vy + self.roll * vz, vz + self.pitch * vx - self.roll * vy

    def step(self):
        def change(odometry):
            self.time += PERIOD
            self.fill(odometry)

        command, status = self.controller.exchange(change)
        if command is None:
            return command, status
        self.roll, self.pitch = command.roll, command.pitch
        thrust = command.thrust.z / MASS
        pull = (thrust * self.pitch, -thrust * self.roll, thrust * math.cos(self.roll) * math.cos(self.pitch) - GRAVITY)
        for i in range(3):
            self.velocity[i] += PERIOD * pull[i]
            self.position[i] += PERIOD * self.velocity[i]
        if self.position[2] <= 0.0:
            self.position[2] = 0.0
            self.velocity = [0.0, 0.0, 0.0]
        return command, status

    def fly(self, until, most):
        """Steps until the condition holds, at most so many seconds."""
        for _ in range(int(most / PERIOD)):
            answer = self.step()
            if until():
                return answer
        raise AssertionError("not reached in %g s" % most)


class FlightStatesTest(MapsFixture):
    def begin(self, parameters=None):
        chosen = {"controller/solve_outside": True, "control_interface/takeoff_time": 1.0,
                  "KF_observer/calibration_duration": 0.5}
        chosen.update(parameters or {})
        controller = self.fly(chosen)
        self.states = controller.collector("flight_status", FlightStatus)
        self.names = controller.collector("state_machine/state_info", String)
        self.assertIsNotNone(self.names.wait(lambda m: m.data == "Inactive"))
        return controller, Vehicle(controller)

    def state(self):
        return self.states.messages[-1].name if self.states.messages else ""

    def call(self, controller, name, kind=Empty):
        rospy.wait_for_service(controller.namespace + "/" + name, PATIENCE)
        return rospy.ServiceProxy(controller.namespace + "/" + name, kind)()

    def assert_refused(self, controller, name):
        with self.assertRaises(rospy.ServiceException):
            self.call(controller, name)

    def test_takes_off_calibrates_and_lands_by_service(self):
        controller, vehicle = self.begin()
        observer = controller.collector("controller/KF_observer/observer_state", ObserverState)
        self.assert_refused(controller, "takeoff")  # no odometry yet
        vehicle.step()
        self.assert_refused(controller, "back_to_position_hold")
        self.assert_refused(controller, "controller/KF_observer/StartCalibrateKF")
        refused = self.call(controller, "land", Trigger)
        self.assertFalse(refused.success)
        self.assertEqual(refused.message, "it does not fly")

        self.call(controller, "takeoff")
        vehicle.fly(lambda: self.state() == "TakeOff", 0.2)
        vehicle.fly(lambda: self.state() == "PositionHold", 4.0)
        self.assertAlmostEqual(vehicle.position[2], 1.0, delta=0.15)
        self.assertEqual(self.states.messages[-1].reason, "the take-off height is reached")
        vehicle.fly(lambda: max(map(abs, vehicle.velocity)) < 0.1, 3.0)
        self.call(controller, "controller/KF_observer/StartCalibrateKF")
        self.call(controller, "reset_integrator")
        self.call(controller, "back_to_position_hold")
        for _ in range(60):
            vehicle.step()
        last = observer.messages[-1]
        self.assertAlmostEqual(last.position[2], vehicle.position[2], delta=0.05)
        self.assertNotEqual(tuple(last.forces_offset), (0.0, 0.0, 0.0))

        self.assertTrue(self.call(controller, "land", Trigger).success)
        vehicle.fly(lambda: self.state() == "Landing", 0.2)
        vehicle.fly(lambda: self.state() == "Landed", 6.0)
        command, status = vehicle.step()
        self.assertEqual(command.thrust.z, 0.0)
        self.assertEqual(status.status, ControllerStatus.MOTORS_OFF)
        self.assertIsNotNone(self.names.wait(lambda m: m.data == "Landed"))
        self.assertEqual([m.data for m in self.names.messages],
                         ["Inactive", "TakeOff", "PositionHold", "Landing", "Landed"])
        controller.pose.publish(pose_at(0.0, 0.0, 1.0))
        self.assertIsNotNone(self.states.wait(lambda m: "take off first" in m.reference))

    def autopilot(self, controller, vehicle):
        """A function that tells what the autopilot does until a status is accepted."""
        states = controller.publisher("mavros/state", State)
        places = controller.publisher("mavros/extended_state", ExtendedState)

        def told(armed, guided, place, accept):
            def ask():
                stamp = rospy.Time.now()
                states.publish(State(header=Header(stamp=stamp), connected=True, armed=armed, guided=guided))
                places.publish(ExtendedState(header=Header(stamp=stamp), landed_state=place))
                status = vehicle.step()[1]
                return status if accept(status) else None

            return controller.answer(ask)

        return told

    def test_a_node_that_begins_in_flight_holds_while_guided(self):
        log = Collector("/rosout", Log)
        controller, vehicle = self.begin()
        vehicle.position[2] = 5.0
        told = self.autopilot(controller, vehicle)

        def is_warned():
            self.assertEqual(vehicle.step()[1].status, ControllerStatus.NO_REFERENCE)
            return any("MPC sends nothing" in message.msg for message in log.messages)

        controller.answer(is_warned)
        self.assertEqual(controller.commands.messages, [])
        for _ in range(2):
            told(True, True, ExtendedState.LANDED_STATE_IN_AIR, lambda s: s.status == ControllerStatus.OPTIMAL)
            self.assertIsNotNone(self.states.wait(lambda m: m.name == "PositionHold"))
            told(True, False, ExtendedState.LANDED_STATE_IN_AIR, lambda s: s.status == ControllerStatus.NO_REFERENCE)
            sent = len(controller.commands.messages)
            vehicle.step()
            self.assertEqual(len(controller.commands.messages), sent)

    def test_the_stream_before_offboard_is_zero_thrust_on_the_ground(self):
        controller, vehicle = self.begin({"control_interface/offboard_stream": True})
        told = self.autopilot(controller, vehicle)
        vehicle.step()
        self.assertEqual(controller.commands.messages, [])  # nothing is known yet
        for armed in (False, True):
            status = told(armed, True, ExtendedState.LANDED_STATE_ON_GROUND,
                          lambda s: s.reason == ControllerStatus.REASON_ON_GROUND)
            self.assertEqual(status.status, ControllerStatus.NO_REFERENCE)
            command = controller.commands.wait(lambda m: m.header.stamp == status.header.stamp)
            self.assertEqual((command.roll, command.pitch, command.yaw_rate, command.thrust.z), (0.0, 0.0, 0.0, 0.0))

    def test_remote_control_takes_the_vehicle_and_gives_it_back(self):
        controller, vehicle = self.begin({"control_interface/rc_timeout": 0.0})
        sticks = rospy.Publisher(controller.namespace + "/rc", Joy, queue_size=1)
        vehicle.position[2] = 1.0
        vehicle.step()

        def hold(mode, reached, forward=0.0):
            joy = Joy(axes=[forward, 0.0, 0.25, 0.0, mode, 1.0, 0.0], buttons=[1])
            if mode == POSITION:
                joy.axes[2] = 0.0
            for _ in range(100):
                sticks.publish(joy)
                vehicle.step()
                if self.state() == reached:
                    return
            self.fail("%s is not reached, it is %s" % (reached, self.state()))

        hold(MANUAL, "RemoteControl", 0.1)
        command, status = vehicle.step()
        self.assertEqual(status.status, ControllerStatus.MANUAL)
        self.assertAlmostEqual(command.pitch, 0.1 * math.pi / 4.0, places=6)
        self.assertAlmostEqual(command.thrust.z, MASS * GRAVITY, places=6)
        before = len(controller.commands.messages)
        sticks.publish(Joy(axes=[0.2, 0.0, 0.25, 0.0, MANUAL, 1.0, 0.0], buttons=[1]))  # answered without odometry
        self.assertIsNotNone(controller.commands.wait(lambda m: abs(m.pitch - 0.2 * math.pi / 4.0) < 1e-6))
        self.assertGreater(len(controller.commands.messages), before)
        self.assert_refused(controller, "takeoff")
        hold(POSITION, "PositionHold")
        hold(POSITION, "RcTeleOp", 1.0)
        hold(MANUAL, "RemoteControl")

    def test_says_what_it_computed_and_refuses_another_frame(self):
        controller, vehicle = self.begin()
        vehicle.position[2] = 1.0
        vehicle.step()
        trajectory = MultiDOFJointTrajectory()
        for i in range(4):
            transform = Transform()
            transform.translation.x, transform.translation.z, transform.rotation.w = 0.01 * i, 1.0, 1.0
            point = MultiDOFJointTrajectoryPoint(transforms=[transform])
            point.time_from_start = rospy.Duration(1.0 * i)
            trajectory.points.append(point)
        controller.trajectory.publish(trajectory)
        status = self.states.wait(lambda m: m.reference.startswith("trajectory of 4 points"))
        self.assertIn("computed: velocities of 4, accelerations of 4", status.reference)
        self.assertEqual(status.state, FlightStatus.TRAJECTORY)
        vehicle.step()
        for ahead, said in ((1e6, "; it begins in "), (-1e6, "; it was over ")):  # of another clock, perhaps
            trajectory.header.stamp = rospy.Time.now() + rospy.Duration(ahead)
            controller.trajectory.publish(trajectory)
            self.assertIsNotNone(self.states.wait(lambda m: said in m.reference), said)
        vehicle.step()

        # What is refused leaves the reference in force.
        def refused(send, sentence):
            before = vehicle.step()[1].longitudinal.theta[0]
            send()
            self.assertIsNotNone(self.states.wait(lambda m: m.reference.startswith("refused") and sentence in m.reference),
                                 sentence)
            self.assertAlmostEqual(vehicle.step()[1].longitudinal.theta[0], before, delta=0.1)

        def pose(x, z, frame):
            message = pose_at(x, 0.0, z)
            message.header.frame_id = frame
            controller.pose.publish(message)

        refused(lambda: pose(0.5, 1.0, "map"), "frame 'map' is not that of the odometry, 'world'")
        refused(lambda: pose(1e5, 1.0, "world"), "more than reference_limits/distance, 1000 m")
        refused(lambda: pose(0.5, 1700.0, ""), "more than reference_limits/distance, 1000 m")
        trajectory.header.stamp, trajectory.header.frame_id = rospy.Time(), "map"
        refused(lambda: controller.trajectory.publish(trajectory), "command/trajectory: frame 'map' is not")
        trajectory.header.frame_id = ""
        trajectory.points[3].transforms[0].translation.x = 900.0
        refused(lambda: controller.trajectory.publish(trajectory), "more than reference_limits/speed, 30 m/s")
        vehicle.step()
        vehicle.frame = "odom"
        _, status = vehicle.step()
        self.assertEqual((status.status, status.reason),
                         (ControllerStatus.HOLD_LAST, ControllerStatus.REASON_WRONG_FRAME))
        for _ in range(10):
            _, status = vehicle.step()
        self.assertEqual(status.status, ControllerStatus.LEVEL)
        self.assertIsNotNone(self.states.wait(lambda m: m.state == FlightStatus.FAILSAFE))
        vehicle.frame = "world"
        _, status = vehicle.step()
        self.assertEqual(status.status, ControllerStatus.OPTIMAL)


    def test_references_that_came_before_the_odometry_are_judged_by_it(self):
        for x, frame, sentence in ((1e5, "world", "reference_limits/distance"), (0.0, "map", "frame 'map'")):
            controller = Controller("early_" + frame, self.maps, {"controller/stale_periods": 10000})
            self.addCleanup(controller.stop)
            controller.connect()
            states = controller.collector("flight_status", FlightStatus)
            early = pose_at(x, 0.0, 0.0)
            early.header.frame_id = frame
            controller.pose.publish(early)
            self.assertIsNotNone(states.wait(lambda m: m.reference == "pose"))
            _, status = controller.exchange()
            self.assertEqual(status.status, ControllerStatus.NO_REFERENCE)
            self.assertIsNotNone(states.wait(lambda m: sentence in m.reference and m.state == FlightStatus.INACTIVE))
            controller.pose.publish(pose_at(0.0, 0.0, 0.0))
            controller.exchange(accept=lambda s: s.status == ControllerStatus.OPTIMAL)


if __name__ == "__main__":
    rospy.init_node("flight_states_test")
    rostest.rosrun("online_controller", "flight_states", FlightStatesTest, sys.argv)
