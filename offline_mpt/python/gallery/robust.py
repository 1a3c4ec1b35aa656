"""Robust altitude: the least peak of the error that is guaranteed for every wind in a range, proven in fractions."""
import pathlib
import sys

import polyfly as pf

PROBLEMS = pathlib.Path(__file__).resolve().parents[3] / "region_maps/problems"

problem = pf.load(PROBLEMS / "robust/aslquad_vertical.yaml")
law = problem.solve()
proof = law.certify()
wind = problem.disturbances[0]
print(f"{len(law.regions)} regions for all winds of {wind.lower} to {wind.upper} {wind.unit}")
print("every bound holds for each of them, now and later" if proof.recursively_feasible else "feasibility may be lost")

# The same law by linear programs, solved where it is asked for.
theta = [1.0, 0.2, 0.0, 0.0]
print(f"map {law(theta)[0]:.6f}, linear programs {problem.online()(theta):.6f} {law.inputs[0].unit}")

law.plot("e_p_z", "e_v_z", output=sys.argv[1])
