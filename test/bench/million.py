"""Solves a program whose map has 1,198,843 regions of four parameters, and looks answers up in the map.

usage: million.py OUTPUT.json

The program is a seeded random one: 45 variables, 90 rows. Wall time, by all processors.
"""
import json
import os
import random
import resource
import subprocess
import sys
import tempfile
import time

TOOL = "build/bin/offline_mpt"
VARIABLES, ROWS, PARAMETERS, SEED = 45, 90, 4, 1
SAMPLES = 300
SECONDS, GIGABYTES = 600.0, 4.294967296  # at most: 10 minutes, 4 GiB


def program():
    """H = M'M/n + 0.1 I; every other entry is normal, scaled such that rows are active in most of the box."""
    draw = random.Random(SEED)

    def matrix(rows, columns, scale):
        return [[scale * draw.gauss(0.0, 1.0) for _ in range(columns)] for _ in range(rows)]

    factor = matrix(VARIABLES, VARIABLES, 1.0)
    columns = list(zip(*factor))
    hessian = [[sum(a * b for a, b in zip(left, right)) / VARIABLES + (0.1 if i == j else 0.0)
                for j, right in enumerate(columns)] for i, left in enumerate(columns)]
    return {"name": "million", "type": "mpQP", "n": VARIABLES, "m": ROWS, "n_theta": PARAMETERS, "out": [0], "eq_ids": [],
            "H": hessian, "f": [0.0] * VARIABLES, "F": matrix(VARIABLES, PARAMETERS, 1.0),
            "A": matrix(ROWS, VARIABLES, VARIABLES**-0.5), "b": [0.3 + draw.random() for _ in range(ROWS)],
            "B": matrix(ROWS, PARAMETERS, 0.3), "lb": [-1.0] * PARAMETERS, "ub": [1.0] * PARAMETERS,
            "A_theta": [], "b_theta": []}


def measure(folder):
    """The statistics of `solve`, its wall seconds and its peak memory in GB."""
    problem, statistics = os.path.join(folder, "million.json"), os.path.join(folder, "stats.json")
    with open(problem, "w") as file:
        json.dump(program(), file)
    begin = time.monotonic()
    subprocess.run([TOOL, "solve", problem, "-o", os.path.join(folder, "million.map"), "--stats", statistics], check=True)
    seconds = time.monotonic() - begin
    with open(statistics) as file:
        return json.load(file), seconds, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024e-9


def agree(folder):
    """Whether random look-ups agree with direct solutions. `verify` tells what differs."""
    command = [TOOL, "verify", os.path.join(folder, "million.map"), "--problem", os.path.join(folder, "million.json"),
               "--samples", str(SAMPLES), "--seed", "1"]
    return subprocess.run(command, check=False).returncode == 0


def main(output):
    with tempfile.TemporaryDirectory(dir=os.path.dirname(output)) as folder:
        statistics, seconds, gigabytes = measure(folder)
        complete = statistics["status"] == "complete"
        rows = [{"name": "million: regions", "value": statistics["regions"], "unit": "", "mark": "complete, a million or more",
                 "reached": complete and statistics["regions"] >= 1_000_000},
                {"name": "million: solve", "value": round(seconds, 1), "unit": "s", "mark": SECONDS, "reached": seconds < SECONDS},
                {"name": "million: memory", "value": round(gigabytes, 2), "unit": "GB", "mark": GIGABYTES,
                 "reached": gigabytes < GIGABYTES},
                {"name": "million: map", "value": round(statistics["bytes"] * 1e-9, 3), "unit": "GB"},
                {"name": "million: look-up, greatest multiply-adds", "value": statistics["multiply_adds"], "unit": ""},
                {"name": f"million: {SAMPLES} random look-ups agree with direct solutions", "value": int(agree(folder)),
                 "unit": "", "mark": 1}]
    rows[-1]["reached"] = rows[-1]["value"] == 1
    with open(output, "w") as file:
        json.dump(rows, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
