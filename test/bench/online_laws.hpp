#pragma once

#include <string>

namespace polyfly_bench {

/// Flies the laws that solve online on the plant: times of their steps and how well they track. `problems` is
/// the folder of the axes' problem files.
void measureLaws(const std::string& problems);

}  // namespace polyfly_bench
