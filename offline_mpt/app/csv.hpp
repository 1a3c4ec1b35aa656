#pragma once

#include <string>
#include <vector>

namespace polyfly {

/// Reads rows of numbers separated by commas, one per parameter vector. The first row may name the columns,
/// in any order; without names the columns are in the order of `names`. Empty lines and lines that start with
/// # are left out. `nan` and `inf` are numbers. Throws Error `path:line: column N 'name': rule`.
std::vector<std::vector<double>> readCsv(const std::string& path, const std::vector<std::string>& names);

}  // namespace polyfly
