"""The peer beside which `./run bench offline` measures: where its figures come from.

A figure is a dict: problem, tool, variant, regions, cpu_seconds, missed, feasible_samples, false_inside, u_error,
objective_error, limit_reached (README.md says what each means; what is unknown is left out).
"""
import json
import os
import shlex
import subprocess
import sys

VARIANTS = ("default", "unpruned")  # unpruned: without the pruning of pairs of constraints, which loses regions

# Noted figures are scaled to this machine by the time that `bench_offline calibrate` takes here. Where the peer was last
# measured beside it, the calibration took CALIBRATION_SECONDS and the peer PEER_TO_NOTED times its noted times: the
# geometric mean over 37 runs of more than 1 ms. Single problems were between 0.65 and 1.31, most within 12 % of the mean.
CALIBRATION_SECONDS = 6.4e-7
PEER_TO_NOTED = 0.88


class Measured:
    """A command that is started once; it reads one line `FILE SECONDS` a problem and answers with one line of JSON."""

    def __init__(self, command):
        self.text = f"measured beside ours by {command}"
        self.process = subprocess.Popen(shlex.split(command), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def figures(self, name, path, limit):
        try:
            self.process.stdin.write(f"{os.path.abspath(path)} {limit:g}\n")
            self.process.stdin.flush()
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer:
            sys.exit(f"POLYFLY_PEER_COMMAND: the peer ended at {name}")
        return [check(row, "POLYFLY_PEER_COMMAND", name) for row in json.loads(answer)]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Listed:
    """Figures from a file: a list of rows, each naming its problem."""

    def __init__(self, path):
        with open(path) as file:
            rows = json.load(file)
        self.text = f"read from {path}"
        self.rows = [check(row, path, row.get("problem")) for row in rows]

    def figures(self, name, _path, _limit):
        return [row for row in self.rows if row["problem"] == name]

    def close(self):
        pass


class Noted:
    """The figures that come with the reference problems, scaled to this machine."""

    def __init__(self, folder, calibration_seconds):
        self.scale = PEER_TO_NOTED * calibration_seconds / CALIBRATION_SECONDS
        self.text = f"noted on another machine, times scaled by {self.scale:.2f} (calibration; one problem may be 35 % off)"
        with open(os.path.join(folder, "reference_results.json")) as file:
            results = json.load(file)
        self.results = {**results["main"], **results["cdc24"]}

    def figures(self, name, _path, _limit):
        figures = []
        for variant, key in zip(VARIANTS, ("pdaqp", "pdaqp_nomask")):
            noted = self.results.get(name, {}).get(key)
            if not noted or not isinstance(noted.get("cpu_seconds"), float):
                continue
            figure = {"problem": name, "tool": "ParametricDAQP 0.6.1 (noted)", "variant": variant,
                      "regions": noted["regions"], "cpu_seconds": noted["cpu_seconds"] * self.scale,
                      "limit_reached": noted["status"] != "Solved"}
            if noted["samples_feasible"] >= 0:
                figure.update(missed=noted["samples_missed"], feasible_samples=noted["samples_feasible"],
                              false_inside=noted["infeasible_inside"])
            for key_here, key_there in (("u_error", "max_u_err"), ("objective_error", "max_obj_relerr")):
                if isinstance(noted.get(key_there), float):
                    figure[key_here] = noted[key_there]
            figures.append(figure)
        return figures

    def close(self):
        pass


def check(row, source, name):
    """Returns the figure, or ends the program where it breaks the form."""
    if row.get("variant") not in VARIANTS or row.get("problem") != name or not isinstance(row.get("tool"), str):
        sys.exit(f"{source}: {row}: 'problem', 'tool' and 'variant' ({' or '.join(VARIANTS)}) must be given")
    if "error" in row:
        row["limit_reached"] = True  # it has no answer: counted as not solved
        return row
    for key in ("regions", "cpu_seconds"):
        if not isinstance(row.get(key), (int, float)) or row[key] < 0:
            sys.exit(f"{source}: {row}: '{key}' must be a number >= 0")
    return row


def findPeer(folder, calibration_seconds):
    """The peer that the environment names, or the noted one."""
    command, results = os.environ.get("POLYFLY_PEER_COMMAND"), os.environ.get("POLYFLY_PEER_RESULTS")
    if command:
        return Measured(command)
    return Listed(results) if results else Noted(folder, calibration_seconds)
