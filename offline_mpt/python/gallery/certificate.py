"""A certificate: the map of Bemporad, Morari, Dua and Pistikopoulos (2002) from matrices, proven for every parameter."""
import sys

import numpy as np
import polyfly as pf

H = [[1.5064, 0.4838], [0.4838, 1.5258]]
F = [[9.6652, 5.2115], [7.0732, -7.0879]]
A = [[1, 0], [-1, 0], [0, 1], [0, -1]]
program = pf.MPQP(H, np.zeros(2), F, A, np.full(4, 2.0), np.zeros((4, 2)), [-1.5, -1.5], [1.5, 1.5], out=[0],
                  name="bemporad2002")
law = program.solve()

report = law.certify()
print(f"{report.regions} regions, {report.facets} facets: {'proven' if report.passed else 'refuted'}")
print(f"the certificate has {len(report.certificate.splitlines())} lines; check_certificate reads it")

# Half of the law is no proof.
part = program.solve(region_limit=5).certify()
print(f"of 5 regions alone: {part.defects[0]}")

law.plot("theta_0", "theta_1", output=sys.argv[1])
