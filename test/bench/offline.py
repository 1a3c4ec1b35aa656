#!/usr/bin/env python3
"""Measures the offline toolchain beside a peer; rows go to OUTPUT, a table for people to OUTPUT with .txt for .json.

usage: offline.py OUTPUT

README.md tells of the environment variables POLYFLY_PEER_COMMAND, POLYFLY_PEER_RESULTS, POLYFLY_BENCH_PARTS,
POLYFLY_BENCH_LIMIT and POLYFLY_DATA. Every measurement is a process of its own (build/bin/bench_offline).
"""
import json
import os
import subprocess
import sys
import time

import offline_peer
import offline_score as score
import offline_table
import offline_whole

TOOL = os.environ.get("POLYFLY_BENCH_TOOL", "build/bin/bench_offline")
LATERAL = "region_maps/problems/reference/lateral_asl.yaml"  # 655 regions, 5 parameters
DEMO = [f"region_maps/problems/multirotor_{axis}.yaml" for axis in ("longitudinal", "lateral", "vertical")]
PARTS = ("base", "cdc24", "lookup", "certificates")
LONG_PARTS = ("whole",)  # only where they are named
BASE_LIMIT = 60.0  # s
CERTIFICATE_LIMIT = 600.0  # s
PATIENCE = 120.0  # s: for solving before, and for ending after the limit
LATERAL_MARK = 60.0  # s for the exact certificate of LATERAL
LARGEST = 5  # base problems that are certified
PRIOR = 60.0  # s: how long the expected times are trusted more than those seen
WHOLE_TIME = 900.0  # s: two processors
OUR_RATE = 5000.0  # regions per second, to tell how long it takes
PEER_NODES, PEER_DEPTH = 20689, 20  # the peer's tree of mass_spring4_N5


class Work:
    """The list of what is to be measured: says what is going on and about how long the rest takes."""

    def __init__(self):
        self.tasks = []

    def add(self, text, seconds, action):
        self.tasks.append((text, seconds, action))

    def run(self):
        spent = expected = 0.0
        for i, (text, seconds, action) in enumerate(self.tasks):
            ratio = (spent + PRIOR) / (expected + PRIOR)  # of the time taken to the time expected
            left = ratio * sum(task[1] for task in self.tasks[i:])
            print(f"[{i + 1}/{len(self.tasks)}] {text} (about {left:.0f} s left)", flush=True)
            start = time.monotonic()
            action()
            spent += time.monotonic() - start
            expected += seconds


def measure(*arguments, timeout=None):
    """The answer of the measuring tool, or None where it failed or took too long; it says why itself."""
    try:
        run = subprocess.run([TOOL, *map(str, arguments)], stdout=subprocess.PIPE, text=True, check=False,
                             timeout=timeout)
    except subprocess.TimeoutExpired:
        print(f"    {' '.join(map(str, arguments))}: did not end after {timeout:g} s", flush=True)
        return None
    return json.loads(run.stdout) if run.returncode == 0 else None


class Bench:
    def __init__(self, parts, limit, output):
        self.limit, self.parts, self.output = limit, parts, output
        self.base, self.set, self.doubles, self.demo = [], [], [], []
        self.rows, self.failed = {part: [] for part in PARTS + LONG_PARTS}, []
        self.work = Work()
        self.calibration = measure("calibrate")["cpu_seconds"]
        data = os.path.join(os.environ.get("POLYFLY_DATA", "../shared/data"), "mp_problems")
        self.folder = data if os.path.isdir(data) else None
        self.peer = offline_peer.findPeer(data, self.calibration) if self.folder else None
        self.noted = offline_peer.Noted(data, self.calibration) if self.folder else None

    def problems(self, folder):
        if not self.folder:
            return []
        path = os.path.join(self.folder, folder)
        return [os.path.join(path, name) for name in sorted(os.listdir(path))
                if name.endswith(".json") and not name.startswith("reference")]

    def done(self, answer, what):
        if answer is None:
            self.failed.append(what)
        return answer is not None

    def solveBeside(self, path, limit, pairs):
        run = measure("solve", path, "--time-limit", limit)
        if self.done(run, f"solve {path}"):
            peer = self.peer if path.endswith(".json") else None  # peers do not read the demo's problems
            pairs.append((run, peer.figures(run["problem"], path, limit) if peer else []))
            print("    " + "  ".join(offline_table.line(*pairs[-1])), flush=True)

    def solveTwice(self, path, limit):
        run = measure("solve", path, "--time-limit", limit, "--threads", 2)
        if self.done(run, f"solve {path} with two threads"):
            self.doubles.append(run)

    def look(self, path, rows_of):
        run = measure("lookup", path)
        if self.done(run, f"look up in {path}"):
            self.rows["lookup"] += rows_of(run)

    def certify(self, path, mark):
        run = measure("certify", path, "--threads", 2, "--time-limit", CERTIFICATE_LIMIT,
                      timeout=CERTIFICATE_LIMIT + PATIENCE)
        if self.done(run, f"certify {path}"):
            if run["first_defect"]:
                print(f"    first defect of {run['problem']}: {run['first_defect']}", flush=True)
            self.rows["certificates"] += score.certificateRows(run, mark)

    def certifyLargest(self):
        """The largest base problems that are not degenerate on purpose."""
        runs = [run for run, _ in self.base if not run["problem"].startswith(("deg_", "mplp_"))]
        for run in sorted(runs, key=lambda r: -r["regions"])[:LARGEST]:
            print(f"    certifying {run['problem']}: {run['regions']} regions", flush=True)
            self.certify(os.path.join(self.folder, run["problem"] + ".json"), CERTIFICATE_LIMIT)

    def expected(self, path, limit):
        """Seconds for us and for the peer, going by the noted figures."""
        name = os.path.splitext(os.path.basename(path))[0]
        figures = self.noted.figures("cdc24_" + name if os.path.dirname(path).endswith("cdc24") else name, path, limit)
        ours = max([1.0] + [figure["regions"] / OUR_RATE for figure in figures])
        if not isinstance(self.peer, offline_peer.Measured):
            return min(limit, ours), 0.0
        peer = [limit if figure["limit_reached"] else figure["cpu_seconds"] for figure in figures]
        return min(limit, ours), sum(1.0 + min(limit, seconds) for seconds in peer)

    def plan(self):
        if "base" in self.parts:
            for path in DEMO + [LATERAL]:
                self.work.add(f"solving {path}", 1, lambda p=path: self.solveBeside(p, BASE_LIMIT, self.demo))
            for path in self.problems(""):
                self.work.add(f"solving {path}", sum(self.expected(path, BASE_LIMIT)),
                              lambda p=path: self.solveBeside(p, BASE_LIMIT, self.base))
        if "cdc24" in self.parts:
            for path in self.problems("cdc24"):
                ours, peer = self.expected(path, self.limit)
                self.work.add(f"solving {path}, at most {self.limit:g} s", ours + peer,
                              lambda p=path: self.solveBeside(p, self.limit, self.set))
                self.work.add(f"solving {path}, two threads", ours / 2, lambda p=path: self.solveTwice(p, self.limit))
        self.planMaps()

        if "whole" in self.parts and self.folder:
            for path in filter(os.path.exists, offline_whole.paths(self.folder)):
                self.work.add(f"solving {path} whole", WHOLE_TIME, lambda p=path: self.solveWhole(p))

    def solveWhole(self, path):
        run = measure("solve", path, "--time-limit", offline_whole.TIME_LIMIT, "--threads", 1, "--runs", 1)
        if self.done(run, f"solve {path} whole"):
            print("    " + "  ".join(offline_table.line(run, [])), flush=True)
            offline_whole.remember(run, path, self.output)
            self.rows["whole"] += score.wholeRows(run)

    def planMaps(self):
        """Look-ups and certificates."""
        if "lookup" in self.parts:
            for path in DEMO:
                self.work.add(f"look-ups in {path}", 5,
                              lambda p=path: self.look(p, lambda run: score.lookupRows(run, None, True)))
            self.work.add(f"look-ups in {LATERAL}", 5,
                          lambda: self.look(LATERAL, lambda run: score.lookupRows(run, 150.0, True)))
            if self.folder:
                for name, rows_of in (("mass_spring4_N10", lambda run: score.lookupRows(run, 300.0)),
                                      ("mass_spring4_N5", lambda run: score.springRows(run, PEER_NODES, PEER_DEPTH))):
                    self.work.add(f"tree and look-ups of {name}", 60,
                                  lambda n=name, r=rows_of: self.look(os.path.join(self.folder, n + ".json"), r))
        if "certificates" in self.parts:
            self.work.add(f"certifying {LATERAL}", 5, lambda: self.certify(LATERAL, LATERAL_MARK))
            if self.folder and "base" in self.parts:
                self.work.add(f"certifying the {LARGEST} largest base problems", 300, self.certifyLargest)

    def allRows(self):
        rows = [score.row("calibration, CPU time", self.calibration, "s")]
        for run, figures in self.demo + self.base:
            rows += score.problemRows(run, figures)
        if self.base:
            rows += score.baseRows(self.base)
            four = [run for run, _ in self.base + self.set if run["parameters"] == 4 and run["regions"] > 4000]
            rows += score.memoryRows(four)
        for run, figures in self.set:
            rows += score.problemRows(run, figures)
        if self.set:
            whole = offline_whole.known(self.output, self.problems("cdc24"))
            rows += score.setRows(self.set, self.doubles, self.limit, whole)
        for part in ("whole", "lookup", "certificates"):
            rows += self.rows[part]
        rows += [score.row(f"failed: {what}", 1, "", None, ("<=", 0)) for what in self.failed]
        return rows


def main(output):
    parts = os.environ.get("POLYFLY_BENCH_PARTS", ",".join(PARTS)).split(",")
    unknown = [part for part in parts if part not in PARTS + LONG_PARTS]
    if unknown:
        sys.exit(f"POLYFLY_BENCH_PARTS: '{unknown[0]}' is none of {', '.join(PARTS + LONG_PARTS)}")
    bench = Bench(parts, float(os.environ.get("POLYFLY_BENCH_LIMIT", "20")), output)
    print(f"the peer's figures: {bench.peer.text}" if bench.peer else
          "the reference problems are not at hand (POLYFLY_DATA): left out are the base problems, cdc24, the peer, the "
          "4-parameter look-up and tree, and all certificates but one", flush=True)
    bench.plan()
    bench.work.run()
    if bench.peer:
        bench.peer.close()
    rows = bench.allRows()
    with open(output + ".part", "w") as file:
        json.dump(rows, file, indent=1)
        file.write("\n")
    os.replace(output + ".part", output)
    offline_table.write(os.path.splitext(output)[0] + ".txt", bench, rows)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
