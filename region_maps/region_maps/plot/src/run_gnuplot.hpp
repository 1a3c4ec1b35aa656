#pragma once

#include <string>

namespace polyfly {

/// Runs `gnuplot` without a shell on the commands in `script` and returns what it writes to its standard
/// output. Throws Error when it cannot be started, reports an error or writes nothing.
std::string runGnuplot(const std::string& script);

}  // namespace polyfly
