#!/usr/bin/env python3
"""Measures the way from odometry to command over ROS. usage: online_ros.py FOLDER_OF_MAPS OUTPUT.json

Needs the built workspace's environment. A ROS master of its own. Shorter by the environment: POLYFLY_LATENCY_SAMPLES (2000;
three times as many as nodelet) at 100 Hz for each row, POLYFLY_LATENCY_LAWS (names, separated by
commas) and POLYFLY_LATENCY_WAYS (by semicolons)."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import xmlrpc.client

from roslib.packages import find_node

SAMPLES = int(os.environ.get("POLYFLY_LATENCY_SAMPLES", "2000"))
RATE = 100.0       # of odometry, and of reconfigurations where there are any [1/s]
TURN = 5.0         # calm and under load in turn, so that both see the same machine; the first fifth counts for neither [s]
PATIENCE = 60.0    # beyond the time that the samples take [s]
LAWS = os.environ.get("POLYFLY_LATENCY_LAWS", "explicit_linear,linear,nonlinear").split(",")
# How controller and probe live together. "mark": the median to reach [us].
WAYS = {
    "nodelet": dict(mark=50.0, times=3),
    "node": dict(),
}
MEASURED = os.environ.get("POLYFLY_LATENCY_WAYS", ";".join(WAYS)).split(";")
UNCHANGED = 1.5    # a 99.9 % that grows by less with reconfigurations counts as unchanged: so far apart are two runs
RANKS = (("median", "median"), ("p99", "99 %"), ("p999", "99.9 %"))
PEER = ("mav_nonlinear_mpc as node, as recorded", 344.0)


def free_port():
    with socket.socket() as chosen:
        chosen.bind(("127.0.0.1", 0))
        return chosen.getsockname()[1]


def program(package, name):
    return find_node(package, name)[0]


class Master:
    """A ROS master of its own, and what was started under it."""

    def __init__(self):
        os.environ.update(ROS_MASTER_URI="http://127.0.0.1:%d" % free_port(), ROS_IP="127.0.0.1")
        os.environ.pop("ROS_HOSTNAME", None)
        self.server = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"])
        self.processes = []
        self.start(["rosmaster", "--core", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]])
        self.await_answer(lambda: self.server.getPid("/bench"))

    def await_answer(self, ask):
        deadline = time.time() + PATIENCE
        while True:
            try:
                return ask()
            except OSError:
                if time.time() > deadline:
                    raise
                time.sleep(0.05)

    def set(self, **parameters):
        for name, value in parameters.items():
            self.server.setParam("/bench", "/" + name.replace("__", "/"), value)

    def start(self, command):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self.processes.append(process)
        return process

    def stop(self):
        for process in reversed(self.processes):
            process.terminate()
        for process in reversed(self.processes):
            try:
                process.communicate(timeout=10.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()

    def transports(self, node):
        """Topic -> transports of its connections, as the node itself tells them."""
        uri = self.server.lookupNode("/bench", node)[2]
        found = {}
        for connection in xmlrpc.client.ServerProxy(uri).getBusInfo("/bench")[2]:
            found.setdefault(connection[4], set()).add(connection[3])
        return found


def is_node(way):
    return way.split()[0] == "node"


def samples(way):
    """Of each kind, calm and under load."""
    return SAMPLES * WAYS[way].get("times", 1)


def configure(master, maps, law, way, output):
    for axis in ("longitudinal", "lateral", "vertical"):
        master.set(**{"controller__maps__" + axis: os.path.join(maps, "multirotor_%s.map" % axis)})
    master.set(probe__samples=samples(way), probe__rate=RATE, probe__output=output,
               probe__turn=TURN, load__rate=RATE, load__turn=TURN, controller__law=law,
               controller__controller__stale_periods=10000)


def start_nodelets(master):
    tool = program("nodelet", "nodelet")
    master.start([tool, "manager", "__name:=manager"])
    for name, kind in (("controller", "online_controller/ExplicitMpc"), ("probe", "polyfly_test/LatencyProbe")):
        master.start([tool, "load", kind, "manager", "__name:=" + name])


def start_nodes(master):
    master.start([program("online_controller", "explicit_mpc_node"), "__name:=controller"])
    master.start([program("polyfly_test", "latency_probe"), "__name:=probe"])


def read_figures(path, odometries, who):
    """What the probe leaves once it has published so many."""
    deadline = time.time() + odometries / RATE + PATIENCE
    while not os.path.exists(path):
        if time.time() > deadline:
            raise RuntimeError("%s left no figures" % who)
        time.sleep(0.1)
    with open(path) as file:
        return json.load(file)


def measure(maps, law, way):
    """What the probe left, with the reconfigurations and the transports of the two topics."""
    with tempfile.TemporaryDirectory() as folder:
        master = Master()
        try:
            path = os.path.join(folder, "probe.json")
            configure(master, maps, law, way, path)
            (start_nodes if is_node(way) else start_nodelets)(master)
            load = master.start([program("polyfly_test", "reconfigure_load"), "__name:=load"])
            figures = read_figures(path, 3 * samples(way), "%s as %s" % (law, way))
            found = master.transports("/controller" if is_node(way) else "/manager")
            figures["transports"] = {topic: sorted(found.get(topic, [])) for topic in (
                "/odometry", "/command/roll_pitch_yawrate_thrust")}
            load.send_signal(signal.SIGINT)
            said = load.communicate(timeout=10.0)[0]
            figures["reconfigurations"] = [float(n) for n in re.search(
                r"(\d+) reconfigurations in ([\d.]+) s, (\d+) failed", said).groups()]
            return figures
        finally:
            master.stop()


def measure_echo():
    """What a node of roscpp takes that answers at once, without a controller: the machine's share."""
    with tempfile.TemporaryDirectory() as folder:
        master = Master()
        try:
            path = os.path.join(folder, "probe.json")
            master.set(probe__samples=SAMPLES, probe__rate=RATE, probe__output=path)
            master.start([program("polyfly_test", "command_echo"), "__name:=echo"])
            master.start([program("polyfly_test", "latency_probe"), "__name:=probe"])
            latency = read_figures(path, SAMPLES, "who computes nothing")["calm"]["latency"]
        finally:
            master.stop()
    return [{"name": "nothing computed, as node: odometry to command, %s" % label, "value": latency[key], "unit": "us"}
            for key, label in RANKS]


def rows_of(law, way, figures):
    """Rows of one law lived with in one way; AssertionError where the figures mean nothing."""
    peace, loaded = figures["calm"], figures["loaded"]
    for turn in (peace, loaded):
        if turn["samples"] + turn["missed"] < samples(way) or turn["missed"] > samples(way) // 1000:
            raise AssertionError("%s as %s: %d of %d odometries without a command" % (
                law, way, turn["missed"], turn["samples"] + turn["missed"]))
    wanted = ["TCPROS"] if is_node(way) else ["INTRAPROCESS"]
    for topic, transports in figures["transports"].items():
        if transports != wanted:
            raise AssertionError("%s as %s: %s goes by %s, not %s" % (law, way, topic, transports, wanted))
    calls, seconds, failed = figures["reconfigurations"]
    if failed or calls < samples(way) // 4:
        raise AssertionError("%d reconfigurations for %d odometries, %d failed" % (calls, samples(way), failed))
    rows = [{"name": "%s as %s: reconfigurations that it took" % (law, way), "value": calls / seconds, "unit": "1/s"}]
    for turn, when in ((peace, ""), (loaded, ", 100 reconfigurations a second")):
        name = "%s as %s%s: odometry to command" % (law, way, when)
        for key, label in RANKS:
            row = {"name": "%s, %s" % (name, label), "value": turn["latency"][key], "unit": "us"}
            mark = WAYS[way].get("mark")
            if key == "median" and mark:
                row.update(mark="at most %g" % mark, reached=row["value"] <= mark)
            if key == "median" and is_node(way):
                row.update(peer=PEER[0], peer_value=PEER[1])
            rows.append(row)
        for key, label in (("inside", "of which in the controller, command published"), ("step", "of which the control step"),
                           ("held", "publish(odometry) lasts")):
            for rank, said in (("median", "median"), ("p999", "99.9 %")):
                rows.append({"name": "%s as %s%s: %s, %s" % (law, way, when, label, said), "value": turn[key][rank],
                             "unit": "us"})
    growth = loaded["latency"]["p999"] / peace["latency"]["p999"]
    rows.append({"name": "%s as %s: odometry to command, 99.9 %% with reconfigurations over that without" % (law, way),
                 "value": growth, "unit": "", "mark": "at most %g" % UNCHANGED, "reached": growth <= UNCHANGED})
    return rows


def main(maps, output):
    rows = measure_echo() if any(is_node(way) for way in MEASURED) else []
    for law in LAWS:
        for way in MEASURED:
            rows += rows_of(law, way, measure(os.path.abspath(maps), law, way))
    with open(output, "w") as file:
        json.dump(rows, file, indent=1)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
