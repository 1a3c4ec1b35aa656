"""What the tests of nodes on real topics share: a node or its nodelet in a namespace of its own, and a partner that waits
for its messages."""

import subprocess
import sys
import threading

import rospy
from roslib.packages import find_node

PATIENCE = 30.0  # until something must have happened [s]
RETRY = 0.5      # until a message counts as lost, while connections are being made [s]
VARIANT = "nodelet" if "nodelet" in sys.argv else "node"  # under test


def command_line(package, node, nodelet):
    """Program and arguments of what is tested: the node, or the nodelet of the same class."""
    if VARIANT == "nodelet":
        return [find_node("nodelet", "nodelet")[0], "standalone", package + "/" + nodelet]
    return [find_node(package, node)[0]]


class Collector:
    """Messages of a topic, to be waited for."""

    def __init__(self, topic, kind):
        self.messages = []
        self.changed = threading.Condition()
        self.subscriber = rospy.Subscriber(topic, kind, self.take)

    def take(self, message):
        with self.changed:
            self.messages.append(message)
            self.changed.notify_all()

    def wait(self, condition, timeout=PATIENCE, since=0):
        """The first message from number `since` on that meets the condition, None after the time-out."""
        found = []

        def arrived():
            found.extend(m for m in self.messages[since:] if condition(m))
            return bool(found)

        with self.changed:
            self.changed.wait_for(arrived, timeout)
        return found[0] if found else None


class Program:
    """A running program under `/namespace` as the node `name`, whose parameters are set before."""

    def __init__(self, command, namespace, name, parameters=None):
        self.namespace = "/" + namespace
        self.collectors = {}
        for key, value in (parameters or {}).items():
            rospy.set_param("/".join((self.namespace, name, key)), value)
        self.process = subprocess.Popen(command + ["__ns:=" + self.namespace, "__name:=" + name], stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, universal_newlines=True)

    def publisher(self, topic, kind, latch=False):
        return rospy.Publisher(self.namespace + "/" + topic, kind, queue_size=10, latch=latch)

    def collector(self, topic, kind):
        self.collectors[topic] = Collector(self.namespace + "/" + topic, kind)
        return self.collectors[topic]

    def answer(self, ask):
        """What `ask` returns once it is something; asked again until patience ends. Then the error tells each topic's last message."""
        deadline = rospy.Time.now() + rospy.Duration(PATIENCE)
        while rospy.Time.now() < deadline:
            found = ask()
            if found:
                return found
        last = {topic: collector.messages[-1:] for topic, collector in self.collectors.items()}
        raise AssertionError("no answer in %g s, but %s" % (PATIENCE, last))

    def output_at_end(self):
        output, _ = self.process.communicate(timeout=PATIENCE)
        return output

    def stop(self):
        if self.process.poll() is None:
            self.process.terminate()
        self.process.communicate(timeout=PATIENCE)
