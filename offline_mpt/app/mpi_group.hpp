#pragma once

#include <memory>
#include <vector>

#include "offline_mpt/process_group.hpp"

namespace polyfly {

/// The group of one MPI job. Made once in a process.
class MpiGroup : public ProcessGroup {
 public:
  /// When this process is done: leaves MPI, which waits for the others. Returns the sum of what all processes tell,
  /// which is equally many numbers.
  virtual std::vector<double> leave(const std::vector<double>& told) = 0;

  /// Ends the whole job at once, with an exit code. Returns where MPI could not.
  virtual void abort(int exit_code) = 0;
};

/// Joins the processes that an MPI launcher (mpirun, srun) started with this one; null where none did, or one
/// process only. MPI is not touched then. Throws Error where a launcher did and this build has no MPI.
std::unique_ptr<MpiGroup> joinGroup();

/// The process's number as the launcher's environment tells it; 0 without a launcher.
int launchedRank();

/// How many processes the launcher started on this machine; 1 without a launcher.
int launchedHere();

}  // namespace polyfly
