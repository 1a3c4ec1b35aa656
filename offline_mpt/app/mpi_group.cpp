#include "mpi_group.hpp"

#include <cstdlib>

#include "polyfly_base/error.hpp"

#ifdef POLYFLY_MPI
#include <mpi.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <list>
#include <thread>
#include <utility>
#endif

namespace polyfly {
namespace {

// Open MPI, MPICH and its relatives
constexpr const char* kSizes[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"};
constexpr const char* kRanks[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK"};

constexpr const char* kNeighbours[] = {"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"};

int number(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

int launchedSize() {
  for (const char* const variable : kSizes) {
    if (const int size = number(variable, 0); size > 0) return size;
  }
  return 1;
}

#ifdef POLYFLY_MPI

constexpr int kTag = 1;

/// MPI counts bytes as int. A longer message goes in parts, all of this size but the last, which is shorter or empty.
constexpr std::size_t kPartBytes = std::size_t{1} << 30;

constexpr auto kPause = std::chrono::microseconds(100);  // between two looks for messages, when leaving

class Mpi : public MpiGroup {
 public:
  // Messages go through one thread at a time, not always the same one.
  Mpi() {
    // Reading from a process that has died would end this one.
    ::setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 0);
    int provided = MPI_THREAD_SINGLE;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    parts_.resize(static_cast<std::size_t>(size_));
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);  // a dead process must not end this one
    if (provided < MPI_THREAD_SERIALIZED) throw Error("MPI: this installation does not support threads");
    findNeighbours();
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }

  void send(int to, std::vector<std::byte> message) override {
    tidy();
    Sending& sending = sending_.emplace_back();
    sending.message = std::move(message);
    const std::size_t size = sending.message.size();
    sending.requests.assign(size / kPartBytes + 1, MPI_REQUEST_NULL);
    for (std::size_t k = 0; k < sending.requests.size(); ++k) {
      const std::size_t first = k * kPartBytes, bytes = std::min(kPartBytes, size - first);
      MPI_Isend(sending.message.data() + first, static_cast<int>(bytes), MPI_BYTE, to, kTag, MPI_COMM_WORLD,
                &sending.requests[k]);
    }
  }

  // Never waits: the rest of a long message does not come from a process that died.
  bool receive(int& from, std::vector<std::byte>& message) override {
    tidy();
    do {
      if (receiving_.request == MPI_REQUEST_NULL && !beginReceiving()) return false;
      int done = 0;
      if (MPI_Test(&receiving_.request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done == 0) return false;
    } while (receiving_.bytes == kPartBytes);
    from = receiving_.from;
    message = std::exchange(partOf(from), {});
    return true;
  }

  // MPI itself does not tell. On this machine the process table does.
  bool lost(int rank) override {
    const pid_t process = neighbours_[static_cast<std::size_t>(rank)];
    return process > 0 && gone(process);
  }

  // Long messages need a receiver: everyone receives until everyone has sent.
  std::vector<double> leave(const std::vector<double>& told) override {
    while (!sending_.empty()) drain();
    std::vector<double> sum(told.size());
    MPI_Request all_sent = MPI_REQUEST_NULL;
    MPI_Iallreduce(told.data(), sum.data(), static_cast<int>(told.size()), MPI_DOUBLE, MPI_SUM,
                   MPI_COMM_WORLD, &all_sent);
    for (int done = 0; done == 0; MPI_Test(&all_sent, &done, MPI_STATUS_IGNORE)) drain();
    MPI_Finalize();
    return sum;
  }

  void abort(int exit_code) override { MPI_Abort(MPI_COMM_WORLD, exit_code); }

 private:
  struct Sending {
    std::vector<std::byte> message;
    std::vector<MPI_Request> requests;
  };

  struct Receiving {
    int from = 0;
    std::size_t bytes = 0;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  /// What has come of a message of this process.
  std::vector<std::byte>& partOf(int rank) { return parts_[static_cast<std::size_t>(rank)]; }

  bool beginReceiving() {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &there, &status);
    if (there == 0) return false;
    int bytes = 0;
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    receiving_.from = status.MPI_SOURCE;
    receiving_.bytes = static_cast<std::size_t>(bytes);
    std::vector<std::byte>& part = partOf(receiving_.from);
    const std::size_t first = part.size();
    part.resize(first + receiving_.bytes);
    MPI_Irecv(part.data() + first, bytes, MPI_BYTE, receiving_.from, kTag, MPI_COMM_WORLD,
              &receiving_.request);
    return true;
  }

  static bool gone(pid_t process) { return ::kill(process, 0) != 0 && errno == ESRCH; }

  // Frees what has been sent; also lets MPI work.
  void tidy() {
    for (auto sending = sending_.begin(); sending != sending_.end();) {
      int done = 0;
      MPI_Testall(static_cast<int>(sending->requests.size()), sending->requests.data(), &done,
                  MPI_STATUSES_IGNORE);
      sending = done != 0 ? sending_.erase(sending) : std::next(sending);
    }
  }

  void drain() {
    int from = 0;
    std::vector<std::byte> message;
    while (receive(from, message)) message.clear();
    std::this_thread::sleep_for(kPause);
  }

  // Process ids of the processes on this machine, 0 for the others and for those in another name space.
  void findNeighbours() {
    const long mine = static_cast<long>(::getpid());
    std::vector<long> all(static_cast<std::size_t>(size_));
    MPI_Allgather(&mine, 1, MPI_LONG, all.data(), 1, MPI_LONG, MPI_COMM_WORLD);
    MPI_Comm here = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &here);
    int count = 0;
    MPI_Comm_size(here, &count);
    std::vector<int> ranks(static_cast<std::size_t>(count));
    MPI_Allgather(&rank_, 1, MPI_INT, ranks.data(), 1, MPI_INT, here);
    MPI_Comm_free(&here);
    neighbours_.assign(static_cast<std::size_t>(size_), 0);
    for (const int rank : ranks) {
      const auto process = static_cast<pid_t>(all[static_cast<std::size_t>(rank)]);
      if (!gone(process)) neighbours_[static_cast<std::size_t>(rank)] = process;
    }
  }

  int rank_ = 0;
  int size_ = 1;
  std::vector<pid_t> neighbours_;
  std::list<Sending> sending_;
  Receiving receiving_;
  std::vector<std::vector<std::byte>> parts_;
};

#endif

}  // namespace

int launchedRank() {
  for (const char* const variable : kRanks) {
    if (const int rank = number(variable, -1); rank >= 0) return rank;
  }
  return 0;
}

int launchedHere() {
  for (const char* const variable : kNeighbours) {
    if (const int count = number(variable, 0); count > 0) return count;
  }
  return 1;
}

std::unique_ptr<MpiGroup> joinGroup() {
  if (launchedSize() == 1) return nullptr;
#ifdef POLYFLY_MPI
  return std::make_unique<Mpi>();
#else
  throw Error("this build has no MPI: start one process, or build where libopenmpi-dev is installed");
#endif
}

}  // namespace polyfly
