#!/usr/bin/env python3
"""Measures the way from odometry to command over ROS. usage: online_ros.py FOLDER_OF_MAPS OUTPUT.json

Needs the built workspace's environment. POLYFLY_LATENCY_SAMPLES (2000) at 100 Hz for each row; a ROS master of its own."""

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
PRIORITY = int(os.environ.get("POLYFLY_LATENCY_PRIORITY", "50"))  # of SCHED_FIFO, 0: none
PATIENCE = 60.0    # beyond the time that the samples take [s]
MARKS = {"nodelet": 20.0, "node": 300.0}  # medians to reach [us]
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


def configure(master, maps, law, output):
    for axis in ("longitudinal", "lateral", "vertical"):
        master.set(**{"controller__maps__" + axis: os.path.join(maps, "multirotor_%s.map" % axis)})
    # Where it is permitted; so that what else runs on this machine is not measured.
    master.set(controller__real_time__priority=PRIORITY, probe__priority=PRIORITY)
    master.set(controller__law=law, controller__controller__stale_periods=10000, probe__samples=SAMPLES, probe__rate=RATE,
               probe__output=output, load__rate=RATE)


def start_nodelets(master):
    tool = program("nodelet", "nodelet")
    master.start([tool, "manager", "__name:=manager"])
    for name, kind in (("controller", "online_controller/ExplicitMpc"), ("probe", "polyfly_test/LatencyProbe")):
        master.start([tool, "load", kind, "manager", "__name:=" + name])


def start_nodes(master):
    master.start([program("online_controller", "explicit_mpc_node"), "__name:=controller"])
    master.start([program("polyfly_test", "latency_probe"), "__name:=probe"])


def measure(maps, law, twin, loaded):
    """What the probe left, with the number of reconfigurations and the transports of the two topics."""
    with tempfile.TemporaryDirectory() as folder:
        master = Master()
        try:
            path = os.path.join(folder, "probe.json")
            configure(master, maps, law, path)
            (start_nodelets if twin == "nodelet" else start_nodes)(master)
            load = master.start([program("polyfly_test", "reconfigure_load"), "__name:=load"]) if loaded else None
            deadline = time.time() + SAMPLES / RATE + PATIENCE
            while not os.path.exists(path):
                if time.time() > deadline:
                    raise RuntimeError("%s as %s left no figures" % (law, twin))
                time.sleep(0.1)
            with open(path) as file:
                figures = json.load(file)
            found = master.transports("/manager" if twin == "nodelet" else "/controller")
            figures["transports"] = {topic: sorted(found.get(topic, [])) for topic in (
                "/odometry", "/command/roll_pitch_yawrate_thrust")}
            if load:
                load.send_signal(signal.SIGINT)
                said = load.communicate(timeout=10.0)[0]
                figures["reconfigurations"] = [int(n) for n in re.search(r"(\d+) reconf.*?, (\d+)", said).groups()]
            return figures
        finally:
            master.stop()


def rows_of(law, twin, peace, loaded):
    """Rows of one law as nodelet or as node; AssertionError where the figures mean nothing."""
    for figures in (peace, loaded):
        if figures["samples"] + figures["missed"] != SAMPLES or figures["missed"] > SAMPLES // 1000:
            raise AssertionError("%s as %s: %d of %d odometries without a command" % (
                law, twin, SAMPLES - figures["samples"], SAMPLES))
        wanted = ["INTRAPROCESS"] if twin == "nodelet" else ["TCPROS"]
        for topic, transports in figures["transports"].items():
            if transports != wanted:
                raise AssertionError("%s as %s: %s goes by %s, not %s" % (law, twin, topic, transports, wanted))
    calls, failed = loaded["reconfigurations"]
    if failed or calls < SAMPLES // 4:
        raise AssertionError("%d reconfigurations for %d odometries, %d failed" % (calls, SAMPLES, failed))
    rows = [{"name": "%s as %s: reconfigurations that it took" % (law, twin), "value": RATE * calls / SAMPLES, "unit": "1/s"}]
    for figures, when in ((peace, ""), (loaded, ", 100 reconfigurations a second")):
        name = "%s as %s%s: odometry to command" % (law, twin, when)
        for key, label in (("median", "median"), ("p99", "99 %"), ("p999", "99.9 %")):
            row = {"name": "%s, %s" % (name, label), "value": figures["latency"][key], "unit": "us"}
            if key == "median":
                row.update(mark="at most %g" % MARKS[twin], reached=row["value"] <= MARKS[twin])
                if twin == "node":
                    row.update(peer=PEER[0], peer_value=PEER[1])
            rows.append(row)
        rows.append({"name": "%s as %s%s: of which in the controller, median" % (law, twin, when),
                     "value": figures["inside"]["median"], "unit": "us"})
        rows.append({"name": "%s as %s%s: control step alone, 99.9 %%" % (law, twin, when), "value": figures["step"]["p999"],
                     "unit": "us"})
    return rows


def main(maps, output):
    rows = []
    for law in ("explicit_linear", "linear", "nonlinear"):
        for twin in ("nodelet", "node"):
            rows += rows_of(law, twin, *(measure(os.path.abspath(maps), law, twin, loaded) for loaded in (False, True)))
    with open(output, "w") as file:
        json.dump(rows, file, indent=1)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
