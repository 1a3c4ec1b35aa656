#!/usr/bin/env python3
"""Tests how `./run bench offline` puts figures together, with a stand-in for the measuring tool and for the peer.

With GTEST_OUTPUT=xml:FOLDER/ the cases are left in FOLDER/bench_test.xml.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import run_test

BENCH = os.path.join(run_test.ROOT, "test", "bench")
sys.path.insert(0, BENCH)
import fixedwing  # noqa: E402
import offline_peer  # noqa: E402
import offline_score as score  # noqa: E402

# Answers as bench_offline does, each time with half the seconds that the problem's name ends in.
TOOL = """#!/usr/bin/env python3
import json, os, sys
if sys.argv[1] == "calibrate":
    print(json.dumps({"cpu_seconds": 6.4e-7}))
    sys.exit(0)
name = os.path.splitext(os.path.basename(sys.argv[2]))[0]
if name == "breaks":
    sys.exit("bench_offline: breaks")
seconds = float(name.split("_")[-1]) / 2 if name.split("_")[-1].replace(".", "").isdigit() else 0.5
print(json.dumps({"problem": name, "status": "complete", "parameters": 4, "regions": 5000, "cpu_seconds": seconds,
                  "wall_seconds": seconds, "threads": 2, "peak_bytes": 5e6, "feasible_samples": 60, "missed": 0,
                  "infeasible_samples": 20, "false_inside": 0, "u_error": 1e-9}))
"""

# Takes as many seconds as the name ends in; `unpruned` is three times slower.
PEER = """#!/usr/bin/env python3
import json, os, sys
for line in sys.stdin:
    path, limit = line.split()
    name = os.path.splitext(os.path.basename(path))[0]
    rows = []
    for variant, factor in (("default", 1), ("unpruned", 3)):
        rows.append({"problem": name, "tool": "stand-in", "variant": variant, "regions": 7, "missed": 0,
                     "cpu_seconds": factor * float(name.split("_")[-1]), "feasible_samples": 60,
                     "limit_reached": False})
    if name.startswith("lost"):
        rows[0]["missed"] = 5
    print(json.dumps(rows), flush=True)
"""


class Bench(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        os.makedirs(self.path("mp_problems", "cdc24"))
        self.tool, self.peer = self.script("tool", TOOL), self.script("peer", PEER)
        self.write("mp_problems/reference_results.json", {"main": {"a_1": {"pdaqp": {
            "regions": 7, "cpu_seconds": 1.0, "status": "Solved", "samples_feasible": 60, "samples_missed": 0,
            "infeasible_inside": 0, "max_u_err": 1e-9}, "pdaqp_nomask": None}}, "cdc24": {}})

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def script(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        os.chmod(self.path(name), 0o755)
        return self.path(name)

    def write(self, name, content):
        with open(self.path(name), "w") as file:
            json.dump(content, file)

    def problems(self, *names):
        for name in names:
            self.write(f"mp_problems/{name}.json", {})

    def run_bench(self, **environment):
        output = self.path("offline.json")
        environment = {"PATH": "/usr/bin:/bin", "POLYFLY_DATA": self.folder, "POLYFLY_BENCH_TOOL": self.tool,
                       "POLYFLY_BENCH_PARTS": "base", "PYTHONDONTWRITEBYTECODE": "1", **environment}
        result = subprocess.run([sys.executable, os.path.join(BENCH, "offline.py"), output], env=environment,
                                cwd=run_test.ROOT, capture_output=True, text=True)
        if result.returncode != 0:
            return result, [], ""
        shown = subprocess.run([sys.executable, os.path.join(run_test.SCRIPTS, "show_table.py"), output],
                               capture_output=True, text=True)
        self.assertEqual(shown.returncode, 0, shown.stderr)
        with open(output) as file, open(self.path("offline.txt")) as table:
            return result, json.load(file), table.read()

    def value(self, rows, text):
        found = [row for row in rows if text in row["name"]]
        self.assertEqual(len(found), 1, f"{text}: {[row['name'] for row in rows]}")
        return found[0]

    def test_the_peer_is_measured_problem_by_problem(self):
        self.problems("a_1", "b_4")
        result, rows, table = self.run_bench(POLYFLY_PEER_COMMAND=self.peer)
        self.assertEqual(result.returncode, 0, result.stderr)
        mean = self.value(rows, "times faster than 'default', geometric mean of the 2 problems that it solves")
        self.assertAlmostEqual(mean["value"], 2.0)
        self.assertFalse(mean["reached"])
        mean = self.value(rows, "times faster than 'unpruned', geometric mean")
        self.assertAlmostEqual(mean["value"], 6.0)
        self.assertTrue(mean["reached"])
        self.assertIn("stand-in", json.dumps(rows))
        self.assertIn("b_4", table)
        self.assertIn("MISSED", table)

    def test_what_the_peer_gets_wrong_is_not_counted(self):
        self.problems("a_1", "lost_100")
        _, rows, _ = self.run_bench(POLYFLY_PEER_COMMAND=self.peer)
        self.value(rows, "'default', geometric mean of the 1 problems that it solves")
        self.assertNotIn("mark", self.value(rows, "'default', least of the 1 over 1 ms that it gets wrong (lost_100)"))

    def test_figures_are_read_from_a_file(self):
        self.problems("a_1")
        self.write("peer.json", [{"problem": "a_1", "tool": "stand-in", "variant": "default", "regions": 3,
                                  "cpu_seconds": 4.5, "missed": 0, "feasible_samples": 60}])
        _, rows, table = self.run_bench(POLYFLY_PEER_RESULTS=self.path("peer.json"))
        self.assertAlmostEqual(self.value(rows, "geometric mean")["value"], 9.0)
        self.assertIn("read from", table)

    def test_without_a_peer_the_noted_figures_are_scaled(self):
        self.problems("a_1")
        _, rows, table = self.run_bench()
        self.assertAlmostEqual(self.value(rows, "geometric mean")["value"], 0.88 / 0.5)
        self.assertIn("scaled by 0.88", table)

    def test_wrong_figures_are_refused(self):
        self.problems("a_1")
        good = {"problem": "a_1", "tool": "stand-in", "variant": "default", "regions": 3, "cpu_seconds": 4.5}
        for change in ({"variant": "other"}, {"cpu_seconds": "4.5"}, {"cpu_seconds": -1.0}, {"tool": None}):
            self.write("peer.json", [{**good, **change}])
            result, _, _ = self.run_bench(POLYFLY_PEER_RESULTS=self.path("peer.json"))
            self.assertEqual(result.returncode, 1, change)
            self.assertIn("must be", result.stderr)
        result, _, _ = self.run_bench(POLYFLY_PEER_COMMAND="true")
        self.assertIn("the peer ended at a_1", result.stderr)
        result, _, _ = self.run_bench(POLYFLY_BENCH_PARTS="base,all")
        self.assertIn("'all' is none of", result.stderr)

    def test_a_failed_measurement_is_a_row_that_misses(self):
        self.problems("a_1", "breaks")
        result, rows, _ = self.run_bench()
        self.assertEqual(result.returncode, 0)
        self.assertIn("bench_offline: breaks", result.stderr)
        self.assertFalse(self.value(rows, "failed: solve")["reached"])

    def test_what_was_solved_without_the_limit_is_said_of_that_file_only(self):
        self.write("mp_problems/cdc24/036.json", {})
        limited = self.script("limited", TOOL.replace('"complete"', '"limited"'))
        missing = self.script("missing", TOOL.replace('"missed": 0', '"missed": 2'))
        for tool in (limited, missing):
            _, rows, _ = self.run_bench(POLYFLY_BENCH_PARTS="whole", POLYFLY_BENCH_TOOL=tool)
            marks = [self.value(rows, name)["reached"] for name in ("complete (1: yes)", ": missed samples")]
            self.assertEqual(marks, [tool != limited, tool != missing])
            _, rows, _ = self.run_bench(POLYFLY_BENCH_PARTS="cdc24", POLYFLY_BENCH_TOOL=limited)
            self.assertEqual(self.value(rows, "not solved without the limit (036)")["value"], 1)

        _, rows, _ = self.run_bench(POLYFLY_BENCH_PARTS="whole")
        self.assertEqual(self.value(rows, "036, without the limit, 2 threads: regions")["value"], 5000)
        _, rows, table = self.run_bench(POLYFLY_BENCH_PARTS="cdc24", POLYFLY_BENCH_TOOL=limited)
        self.assertEqual(self.value(rows, "not solved without the limit")["value"], 0)
        self.assertTrue(self.value(rows, "without the limit, 2 threads: missed samples")["reached"])
        self.assertIn("036, without the limit", table)

        self.write("mp_problems/cdc24/036.json", {"changed": 1})
        _, rows, _ = self.run_bench(POLYFLY_BENCH_PARTS="cdc24", POLYFLY_BENCH_TOOL=limited)
        self.assertEqual(self.value(rows, "not solved without the limit (036)")["value"], 1)

    def test_without_the_data_it_says_what_is_left_out(self):
        result, rows, table = self.run_bench(POLYFLY_DATA=self.path("nowhere"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("left out", result.stdout)
        self.assertIn("left out", table)
        self.value(rows, "lateral_asl: regions")


class Score(unittest.TestCase):
    RUN = {"problem": "p", "status": "complete", "regions": 10, "cpu_seconds": 1.0, "parameters": 2, "missed": 0,
           "false_inside": 0, "u_error": 1e-7}

    def test_our_run_counts_only_when_complete_and_right(self):
        self.assertTrue(score.ours(self.RUN))
        for change in ({"status": "limited"}, {"missed": 1}, {"false_inside": 1}, {"u_error": 2e-6}):
            self.assertFalse(score.ours({**self.RUN, **change}), change)

    def test_the_peer_is_right_only_when_it_ended_and_agrees(self):
        figure = {"problem": "p", "variant": "default", "tool": "t", "regions": 9, "cpu_seconds": 2.0, "missed": 0,
                  "feasible_samples": 60}
        self.assertTrue(score.right(figure))
        for change in ({"limit_reached": True}, {"missed": 1}, {"false_inside": 1}, {"u_error": 1.0},
                       {"objective_error": 0.5}):
            self.assertFalse(score.right({**figure, **change}), change)

    def test_a_variant_with_fewer_regions_than_the_other_loses_some(self):
        default = {"problem": "p", "variant": "default", "tool": "t", "regions": 9, "cpu_seconds": 2.0}
        unpruned = {**default, "variant": "unpruned", "regions": 10}
        self.assertTrue(score.losesRegions(default, [default, unpruned]))
        self.assertFalse(score.losesRegions(unpruned, [default, unpruned]))
        self.assertFalse(score.losesRegions(default, [default, {**unpruned, "limit_reached": True}]))

    def test_what_is_slower_is_named(self):
        slow = {"problem": "p", "variant": "default", "tool": "t", "regions": 9, "cpu_seconds": 0.5}
        rows = score.ratioRows([(self.RUN, [slow])], "default")
        least = [row for row in rows if "least" in row["name"]]
        self.assertEqual(len(least), 1)
        self.assertIn("(p 0.50)", least[0]["name"])
        self.assertFalse(least[0]["reached"])

    def test_marks_include_their_bound(self):
        self.assertTrue(score.row("a", 3.0, "", None, (">=", 3.0))["reached"])
        self.assertTrue(score.row("a", 3.0, "", None, ("<=", 3.0))["reached"])
        self.assertFalse(score.row("a", 2.9, "", None, (">=", 3.0))["reached"])
        self.assertFalse(score.row("a", 3.1, "", None, ("<=", 3.0))["reached"])

    def test_a_rate_is_of_the_whole_set(self):
        runs = [{"regions": 100, "cpu_seconds": 1.0}, {"regions": 300, "cpu_seconds": 1.0}]
        self.assertEqual(score.rate(runs, "cpu_seconds"), 200.0)

    def test_the_rate_of_all_problems_solved_whole_is_told_when_all_are(self):
        stopped = {**self.RUN, "problem": "q", "status": "limited"}
        whole = {**self.RUN, "problem": "q", "threads": 2, "wall_seconds": 1.0, "peak_bytes": 1.0, "regions": 90, "cpu_seconds": 4.0,
                 "feasible_samples": 1, "infeasible_samples": 1}
        pairs = [(self.RUN, []), (stopped, [])]
        for known, told in (({}, []), ({"q": {**whole, "missed": 1}}, []), ({"q": whole}, [20.0])):
            rows = score.setRows(pairs, [], 20.0, known)
            self.assertEqual([r["value"] for r in rows if "per CPU second, each solved whole" in r["name"]], told)

    def test_leaves_count_as_nodes_of_a_tree(self):
        self.assertEqual(score.treeSize({"nodes": 13}), 27)


class FixedWing(unittest.TestCase):
    def test_noted_times_of_peers_are_scaled_to_this_machine(self):
        rows = [{"name": "a", "value": 7.0, "unit": "us", "peer": "acados (noted)", "peer_value": 74}, {"name": "b", "value": 1.0, "unit": "us"}]
        slow = fixedwing.scaled(rows, 2.0 * offline_peer.CALIBRATION_SECONDS)
        self.assertEqual(slow[0]["value"], 2.0 * offline_peer.CALIBRATION_SECONDS)
        self.assertAlmostEqual(slow[1]["peer_value"], 74 * 2.0 * offline_peer.PEER_TO_NOTED, places=1)
        self.assertIn("scaled by 1.76", slow[1]["peer"])
        self.assertNotIn("peer", slow[2])


if __name__ == "__main__":
    run_test.main("bench_test")
