"""Problems of the cdc24 set that take longer than the limit of a run: solved whole, on one core.

That takes long, so it is a part of its own, `whole`; what came out is remembered beside the output, and the part `cdc24`
of later runs says it of the same problem files.
"""
import hashlib
import json
import os

PROBLEMS = ("002", "024", "032", "033", "036")  # of cdc24: 180,000 regions and more
TIME_LIMIT = 6 * 3600.0  # s


def paths(folder):
    return [os.path.join(folder, "cdc24", name + ".json") for name in PROBLEMS]


def memory(output):
    return os.path.join(os.path.dirname(output), "offline_whole.json")


def fingerprint(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def read(output):
    if not os.path.exists(memory(output)):
        return []
    with open(memory(output)) as file:
        return json.load(file)


def remember(run, path, output):
    others = [other for other in read(output) if other["problem"] != run["problem"]]
    with open(memory(output) + ".part", "w") as file:
        json.dump(others + [{**run, "sha256": fingerprint(path)}], file, indent=1)
    os.replace(memory(output) + ".part", memory(output))


def known(output, paths):
    """What came out of these very files, by the name of the problem."""
    prints = {fingerprint(path) for path in paths}
    return {run["problem"]: run for run in read(output) if run["sha256"] in prints}
