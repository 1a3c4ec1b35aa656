#include "prove.hpp"

#include <chrono>
#include <future>
#include <string>
#include <utility>

#include "watch.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds kLookPeriod{100};

RobustProblem robustProblemOf(const LoadedMap& map) {
  return parseRobustProblem(std::string(map.map().problemText()), map.textSource());
}

}  // namespace

std::variant<VerifyReport, RobustSampling> verifyMap(const LoadedMap& map, std::uint64_t samples,
                                                     std::uint64_t seed, double tolerance, int threads,
                                                     py::object progress) {
  if (samples < 1) throw Error("samples: must be at least 1, got 0");
  if (!(tolerance > 0.0)) throw Error("tolerance: must be above 0, got " + std::to_string(tolerance));
  const int workers = threadCount(threads);
  if (map.isRobust()) {
    const RobustProblem problem = robustProblemOf(map);
    return watched(std::move(progress),
                   [&](Watch&) { return sampleRobustMap(map.map(), problem, samples, seed, tolerance); });
  }
  const ParametricProgram program = map.program();
  return watched(std::move(progress), [&](Watch& watch) {
    VerifyOptions options;
    options.samples = samples;
    options.seed = seed;
    options.tolerance = tolerance;
    options.threads = workers;
    options.stop = &watch.stop();
    options.progress = [&](auto done, auto total) { watch.look(shareText(done, total, "samples")); };
    return verify(map.map(), program, options);
  });
}

std::variant<CertifyReport, RobustProof> certifyMap(const LoadedMap& map, int threads, py::object progress) {
  const int workers = threadCount(threads);
  if (map.isRobust()) {
    const RobustProblem problem = robustProblemOf(map);
    return watched(std::move(progress), [&](Watch& watch) {
      ProveOptions options;
      options.threads = workers;
      options.stop = &watch.stop();
      // It has no progress, so another thread does it, and this one looks after Ctrl-C.
      auto proof =
          std::async(std::launch::async, [&] { return proveRobustMap(map.map(), problem, options); });
      while (proof.wait_for(kLookPeriod) != std::future_status::ready) watch.look("proof in fractions");
      return proof.get();
    });
  }
  const ParametricProgram program = map.program();
  return watched(std::move(progress), [&](Watch& watch) {
    CertifyOptions options;
    options.threads = workers;
    options.stop = &watch.stop();
    options.progress = [&](auto done, auto total) {
      watch.look("proof: " + shareText(done, total, "steps"));
    };
    return certify(map.map(), program, options);
  });
}

}  // namespace polyfly::python
