#pragma once

#include <set>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {

// Parts of a tracking problem's file. All throw Error.

/// Name and unit of a signal. The name must not be in `taken`, and is added to it.
Signal readSignal(const YamlField& field, std::set<std::string>* taken);

/// Reads `constraints`, which may be absent. The signals of the problem have been read.
void readConstraints(const YamlField& root, MpcProblem* problem);

/// Reads `terminal_set`, which may be absent.
void readTerminalSet(const YamlField& root, MpcProblem* problem);

/// Reads `parameters`, those with a value among the fixed ones.
void readParameters(const YamlField& parameters, MpcProblem* problem);

/// Parameters that constraints need: the previous input for bounds on its change, and x_ref for bounds on x itself where
/// u_ref is a parameter.
void checkNeededParameters(const YamlField& root, const MpcProblem& problem);

}  // namespace polyfly
