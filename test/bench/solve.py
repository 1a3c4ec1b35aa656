#!/usr/bin/env python3
"""Times `offline_mpt solve` and writes rows (test/bench/README.md).

usage: solve.py OUTPUT.json

CPU seconds of the whole process, one thread, least of three runs. The reference problems are read from
POLYFLY_DATA or ../shared/data and left out where absent. The peer's numbers were measured on another day with
ParametricDAQP 0.6.1 (solver alone, CPU seconds): a comparison of orders, not of percents.
"""
import json
import os
import resource
import subprocess
import sys
import tempfile

TOOL = "build/bin/offline_mpt"
RUNS = 3
PEER = "ParametricDAQP 0.6.1, as recorded"
PEER_SECONDS = {"di_N10": 0.038, "invpend_N5_x": 0.0676, "mass_spring4_N5": 0.0368, "multirotor_N10": 0.0339,
                "multirotor_N20": 18.2, "rnd_n10_m20_t4": 0.211}


def solve(problem, folder):
    """CPU seconds and regions of one solution."""
    target, stats = os.path.join(folder, "out.map"), os.path.join(folder, "stats.json")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([TOOL, "solve", problem, "-o", target, "--threads", "1", "--stats", stats, "--quiet"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(stats) as file:
        regions = json.load(file)["regions"]
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, regions


def rows_of(name, problem):
    with tempfile.TemporaryDirectory() as folder:
        runs = [solve(problem, folder) for _ in range(RUNS)]
    seconds = {"name": f"{name}: solve", "value": round(min(run[0] for run in runs), 6), "unit": "s"}
    if name in PEER_SECONDS:
        seconds.update(peer=PEER, peer_value=PEER_SECONDS[name])
    return [{"name": f"{name}: regions", "value": runs[0][1], "unit": ""}, seconds]


def main(output):
    rows = []
    for axis in ("longitudinal", "lateral", "vertical"):
        rows += rows_of("multirotor_" + axis, f"region_maps/problems/multirotor_{axis}.yaml")
    data = os.path.join(os.environ.get("POLYFLY_DATA", "../shared/data"), "mp_problems")
    for name in PEER_SECONDS:
        problem = os.path.join(data, name + ".json")
        if os.path.exists(problem):
            rows += rows_of(name, problem)
        else:
            print(f"left out, not at hand: {problem}")
    with open(output, "w") as file:
        json.dump(rows, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
