#!/usr/bin/env python3
"""The fixed wing's rows, with the peer's noted times scaled to this machine: fixedwing.py OUTPUT [--append].

Where the peers were measured the fixed piece of arithmetic was not timed; but ParametricDAQP was, there and beside
`bench_offline calibrate`, so its ratio serves (offline_peer.py).
"""
import json
import subprocess
import sys

from offline_peer import CALIBRATION_SECONDS, PEER_TO_NOTED


def read(*command):
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout)


def scaled(rows, seconds):
    """The rows, and one for the calibration; `seconds` is what it takes here."""
    scale = PEER_TO_NOTED * seconds / CALIBRATION_SECONDS
    for row in rows:
        if "peer_value" in row:
            row["peer_value"] = float("%.4g" % (scale * row["peer_value"]))
            row["peer"] += ", times scaled by %.2f" % scale
    return [{"name": "calibration, CPU time", "value": seconds, "unit": "s"}] + rows


def main(output, *options):
    before = []
    if "--append" in options:
        with open(output) as file:
            before = json.load(file)
    seconds = read("build/bin/bench_offline", "calibrate")["cpu_seconds"]
    with open(output, "w") as file:
        json.dump(before + scaled(read("build/bin/bench_fixedwing"), seconds), file, indent=1)


if __name__ == "__main__":
    main(*sys.argv[1:])
