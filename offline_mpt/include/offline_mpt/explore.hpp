#pragma once

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/explore_options.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly {

/// Partitions the parameter set of a convex program into critical regions.
///
/// H positive definite: the law is unique and continuous. H zero: of several optima, the shortest z is taken. It is
/// unique and, where the cost does not depend on theta, continuous. Where such a program has solutions but its cost
/// falls without end, the partition says so (kUnbounded, unbounded_at). Rows may repeat, depend on each other or hold
/// with equality everywhere. Inequalities that differ by less than 1e-10, relative, count as one. Throws Error when H
/// is neither zero nor positive definite where the equalities leave z free, decided exactly. It throws when the
/// parameter set is unbounded, or the parameters that admit a solution form a lower-dimensional set. Also when rounding would decide what an equality fixes. Then its
/// unit row is nearer to the span of the others than 1e-6, but not within rounding.
///
/// Active sets are described in the order in which they are found, so the result depends neither on threads nor on
/// processes. An exploration that was stopped and resumed from its checkpoint ends with the regions of one that was
/// not. A limit on regions cuts at the same region each time. Throws Error when the checkpoint is damaged, belongs to
/// another problem or other tolerances, comes from another build of the solver, or holds a region that is not that of its
/// active set. It also throws when that of a stopped exploration cannot be written at the end, and when a process of the
/// group cannot assist. A process of the group that is lost interrupts (ExploreStats::lost_process).
Partition explore(const ParametricProgram& program, const ExploreOptions& options = {});

}  // namespace polyfly
