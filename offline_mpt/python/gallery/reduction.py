"""Reduction: fewer regions, the same answers, and a proof of it before the map is handed out."""
import pathlib
import sys

import numpy as np
import polyfly as pf

PROBLEMS = pathlib.Path(__file__).resolve().parents[3] / "region_maps/problems"

law = pf.load(PROBLEMS / "multirotor_vertical.yaml").solve()
joined = law.reduce()
shortened = law.reduce(tree="small")
for name, one in (("solved", law), ("joined", joined), ("shortened", shortened)):
    print(f"{name}: {len(one.regions)} regions, {one.bytes} bytes")

lower, upper = zip(*((signal.lower, signal.upper) for signal in law.parameters))
thetas = np.random.default_rng(1).uniform(lower, upper, (100_000, len(lower)))
difference = np.abs(law.evaluate(thetas, threads=2) - shortened.evaluate(thetas, threads=2)).max()
assert difference < 1e-7, difference

joined.plot("e_p_z", "e_v_z", output=sys.argv[1])
