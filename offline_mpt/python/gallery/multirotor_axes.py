"""The three axes of a multirotor: problem files to maps, as `offline_mpt solve` makes them, with what look-ups cost."""
import pathlib
import sys

import numpy as np
import polyfly as pf

PROBLEMS = pathlib.Path(__file__).resolve().parents[3] / "region_maps/problems"

maps = {axis: pf.load(PROBLEMS / f"multirotor_{axis}.yaml").solve() for axis in ("longitudinal", "lateral", "vertical")}
for axis, law in maps.items():
    cost = law.cost
    print(f"{axis}: {len(law.regions)} regions, a look-up passes {cost['depth']} nodes and tests "
          f"{cost['region_checks']} half-spaces at most")

# All laws at once, for a vehicle that is 1 m off in each direction.
for law in maps.values():
    error = np.zeros(len(law.parameters))
    error[0] = 1.0
    assert np.all(np.isfinite(law.evaluate([error])))

maps["lateral"].plot("e_p_y", "e_v_y", output=sys.argv[1])
