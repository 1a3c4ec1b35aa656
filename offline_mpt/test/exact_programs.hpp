#pragma once

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// A double integrator with bounds on input and both states, condensed: its feasible set has edges inside the
/// box, and rows become dependent on them.
ParametricProgram doubleIntegrator(int horizon);

/// A plant that turns by 60 degrees and grows by half in a step; |u| <= 1, |x| <= 0.5 at the end of the horizon. Rows
/// that bound its feasible set nearly depend on each other, and regions are as narrow as rounding.
ParametricProgram unstableRotation(int horizon);

/// Rows that depend on others but for `distance`.
ParametricProgram nearlyDependent(double distance, unsigned seed);

/// All rows are tight, but for `distance`, at the same parameter, at the unconstrained minimiser: so many
/// regions meet there that some have facets in common which are narrower than maps tell.
ParametricProgram nearlyMeeting(int n, int p, double distance, unsigned seed);

/// Outputs without bounds, so that laws count as one only where they differ by little.
void withoutBounds(ParametricProgram& program);

/// H has eigenvalues from 1e-6 to 1, and z is bounded: planes of the partition nearly coincide, and trees
/// meet slivers.
ParametricProgram illConditioned(int n, int m, int p, unsigned seed);

/// Its last row touches the unconstrained minimiser everywhere, up to rounding.
ParametricProgram touching(unsigned seed);

/// Two equalities, and two that are combinations of them: with `whole` numbers but for b, where rounding
/// makes them contradict each other, else with rows that rounding makes independent.
ParametricProgram redundantEqualities(unsigned seed, bool whole);

/// min |z|_1-like linear program: H = 0, with cost multipliers, ties and a cost that does not depend on theta.
ParametricProgram smallLinearProgram();

/// The double integrator with the sum of |state| and |input| / 2 as cost: H = 0, z holds inputs, bounds of
/// |state| and of |input|. Its rows are sums of others in many ways.
ParametricProgram normControl(int horizon);

}  // namespace polyfly
