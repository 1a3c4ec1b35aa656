#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "count/law_separation.hpp"
#include "explore/sets/active_set_pool.hpp"
#include "mpc_core/parametric_program.hpp"
#include "polyfly_base/file_draft.hpp"

namespace polyfly {

/// The file of all active sets that were counted, with their witnesses, as COUNT.md states it: written as
/// they are counted, and in its place when it is whole. Throws Error where it cannot be written.
class CountProof {
 public:
  /// Proves for `program`; `weights`: see LawSeparation.
  CountProof(const std::string& path, const ParametricProgram& program, const Eigen::MatrixXd& weights);

  /// `rows`: of the program, without equalities.
  void add(const std::vector<int>& rows, const std::int64_t* witness);

  void commit();

 private:
  void flush();

  FileDraft draft_;
  std::size_t key_bytes_;
  std::size_t parameters_;
  std::vector<unsigned char> buffer_;
  std::uint64_t end_ = 0;
};

}  // namespace polyfly
