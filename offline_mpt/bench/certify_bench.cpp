#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "../test/map_in_memory.hpp"
#include "bench_commands.hpp"
#include "clocks.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly::bench {
namespace {

// Sets a flag after some seconds unless it ends before.
class Alarm {
 public:
  explicit Alarm(double seconds) : thread_([this, seconds] { wait(seconds); }) {}
  ~Alarm() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      over_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  const std::atomic<bool>* rung() const { return &rung_; }

 private:
  void wait(double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return over_; });
    rung_ = !over_;
  }

  std::atomic<bool> rung_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace

Json timeCertificate(const CertifyArguments& arguments) {
  const ParametricProgram program = loadProgram(arguments.problem);
  const Partition partition = explore(program);
  TreeOptions tree;
  tree.mode = TreeMode::kFast;  // the tree plays no part here
  const MapInMemory memory(encode(program, partition, tree));
  CertifyOptions options;
  options.threads = arguments.threads;
  const Alarm alarm(arguments.time_limit);
  options.stop = alarm.rung();
  const double cpu = cpuSeconds();
  const double wall = wallSeconds();
  const CertifyReport report = certify(memory.map(), program, options);
  Json result;
  result["problem"] = program.name;
  result["parameters"] = program.parameterCount();
  result["regions"] = memory.map().regionCount();
  result["threads"] = arguments.threads;
  result["passed"] = report.passed();
  result["limit_reached"] = report.interrupted;
  result["defects"] = report.defects.size();
  result["first_defect"] = report.defects.empty() ? std::string() : report.defects.front().text;
  result["wall_seconds"] = wallSeconds() - wall;
  result["cpu_seconds"] = cpuSeconds() - cpu;
  result["certificate_bytes"] = report.certificate.size();
  return result;
}

}  // namespace polyfly::bench
