#!/usr/bin/env python3
"""Measures the module `polyfly` for Python; prints rows as JSON. PYTHONPATH names the folder of the package."""
import json
import pathlib
import subprocess
import sys
import time

import numpy as np
import polyfly as pf

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LATERAL = ROOT / "region_maps/problems/reference/lateral_asl.yaml"
IMPORT = "import time, numpy; start = time.perf_counter(); import polyfly; print(time.perf_counter() - start)"
RUNS, THETAS, THREADS = 20, 2_000_000, 2


def least(measure):
    """The least of several measurements: what the machine's other work adds is not the module's."""
    return min(measure() for _ in range(RUNS))


def seconds(work):
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def import_time():
    return float(subprocess.run([sys.executable, "-c", IMPORT], check=True, capture_output=True, text=True).stdout)


def small_problem():
    """Bemporad, Morari, Dua and Pistikopoulos (2002), Sect. 7.1."""
    H, F = np.array([[1.5064, 0.4838], [0.4838, 1.5258]]), np.array([[9.6652, 5.2115], [7.0732, -7.0879]])
    A = np.vstack([np.eye(2), -np.eye(2)])
    limit = np.full(2, 1.5)
    return pf.MPQP(H, np.zeros(2), F, A, np.full(4, 2.0), np.zeros((4, 2)), -limit, limit).solve(threads=1)


def main():
    law = pf.load(LATERAL).solve()
    lower, upper = zip(*((signal.lower, signal.upper) for signal in law.parameters))
    thetas = np.random.default_rng(1).uniform(lower, upper, (THETAS, len(lower)))
    rate = THETAS / least(lambda: seconds(lambda: law.evaluate(thetas, threads=THREADS)))
    start = time.process_time()
    law.evaluate(thetas, threads=THREADS)
    cpu = (time.process_time() - start) / THETAS
    rows = [("import, beyond numpy", 1e3 * least(import_time), "ms"),
            ("bemporad2002: from matrices to the map", 1e3 * least(lambda: seconds(small_problem)), "ms"),
            (f"lateral_asl: evaluations of one call, {THREADS} threads", rate / 1e6, "million/s"),
            ("lateral_asl: CPU time of one evaluation", 1e9 * cpu, "ns"),
            ("lateral_asl: one call for one parameter", 1e6 * least(lambda: seconds(lambda: law(thetas[0]))), "us")]
    print(json.dumps([{"name": name, "value": round(value, 3), "unit": unit} for name, value, unit in rows]))


if __name__ == "__main__":
    main()
