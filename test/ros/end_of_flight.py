#!/usr/bin/env python3
"""Ends a roslaunch when its flight is recorded, or when one of its processes has ended.

usage: end_of_flight.py NODE...     (all on this machine)

The nodes end first, so that nodelets are unloaded while their manager is there. Then roslaunch, which started this
script, gets the signal of Ctrl-C. If the flight's own nodes were required, roslaunch would end with an error message.
"""
import os
import signal
import time
from xmlrpc.client import Fault, ServerProxy

import rosgraph
import rosnode
import rospy
from std_msgs.msg import String

POLL = 0.1  # between two looks at the processes [s]
PATIENCE = 10.0  # until nodes that do not end are left to roslaunch [s]


def roslaunch():
    """The server of the roslaunch that started this script. Several can share a master. Some may have ended, and other
    programs may have got their ports."""
    for uri in rospy.get_param("/roslaunch/uris").values():
        server = ServerProxy(uri)
        try:
            if server.get_pid()[2] == os.getppid():
                return server
        except Exception:  # whatever another program answers
            continue
    raise SystemExit("end_of_flight: must be started by roslaunch")


def interrupt(name):
    """As Ctrl-C does. A node that has ended meanwhile needs nothing."""
    try:
        _, _, pid = ServerProxy(rosnode.get_api_uri(rosgraph.Master(rospy.get_name()), name)).getPid(rospy.get_name())
        os.kill(pid, signal.SIGINT)
    except (OSError, Fault, TypeError):
        pass


def main():
    rospy.init_node("end_of_flight")
    ours = {rospy.resolve_name(name) for name in rospy.myargv()[1:]}
    recorded = []
    rospy.Subscriber("recorder/closed", String, recorded.append)
    server = roslaunch()
    while not recorded:
        _, _, (_, ended) = server.list_processes()
        if ended or rospy.is_shutdown():
            break
        time.sleep(POLL)
    if rospy.is_shutdown():
        return
    for name in sorted(ours & set(rosnode.get_node_names())):
        interrupt(name)
    end = time.monotonic() + PATIENCE
    while ours & set(rosnode.get_node_names()) and time.monotonic() < end:
        time.sleep(POLL)
    os.kill(os.getppid(), signal.SIGINT)
    # Until roslaunch ends this script, too. It is a required node, so that roslaunch also ends if this script fails.
    while not rospy.is_shutdown():
        time.sleep(POLL)


if __name__ == "__main__":
    main()
