#include "loaded_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "outside_error.hpp"
#include "polyfly_base/write_file.hpp"
#include "robust_mpc/robust_problem.hpp"

namespace polyfly::python {
namespace {

// Fewer look-ups than these take less time than a thread takes to start.
constexpr std::size_t kLeastPerThread = 2048;

// Runs work(first, last) on equal parts of 0 .. count, the first part in this thread.
template <class Work>
void inParts(std::size_t count, int threads, const Work& work) {
  const std::size_t parts =
      std::clamp<std::size_t>(count / kLeastPerThread, 1, static_cast<std::size_t>(threads));
  const auto start = [&](std::size_t part) { return count * part / parts; };
  std::vector<std::thread> workers;
  std::size_t started = 1;
  try {
    for (; started < parts; ++started) workers.emplace_back(work, start(started), start(started + 1));
  } catch (const std::system_error&) {  // No further thread can start: this one does the rest.
    work(start(started), count);
  }
  work(0, start(1));
  for (std::thread& worker : workers) worker.join();
}

}  // namespace

LoadedMap::LoadedMap(const std::string& path) : map_(RegionMap::open(path)) {}

LoadedMap::LoadedMap(MapImage image, const std::string& name)
    : image_(std::move(image)), map_(image_->view(name)) {}

void LoadedMap::save(const std::string& path) const {
  const auto* bytes = reinterpret_cast<const std::byte*>(map_.file().data());
  writeFileAtomically(path, std::vector<std::byte>(bytes, bytes + map_.bytes()));
}

void LoadedMap::evaluate(const double* theta, double* u) const {
  const Lookup lookup = map_.evaluate(theta, u);
  if (lookup.status != LookupStatus::kInside) failOutside(theta, lookup.status);
}

Lookup LoadedMap::locate(const double* theta) const {
  const Lookup lookup = map_.locate(theta);
  if (lookup.status != LookupStatus::kInside) failOutside(theta, lookup.status);
  return lookup;
}

void LoadedMap::failOutside(const double* theta, LookupStatus status) const {
  std::ostringstream text;
  text << map_.path() << ": theta:";
  switch (status) {
    case LookupStatus::kInside:
      break;
    case LookupStatus::kNotFinite:
      text << " must hold finite numbers only";
      break;
    case LookupStatus::kOutsideBox:
      for (std::size_t i = 0; i < parameterCount(); ++i) {
        const Signal& signal = map_.parameters()[i];
        if (theta[i] >= signal.lower && theta[i] <= signal.upper) continue;
        text << " " << signal.name << " must be " << signal.lower << " to " << signal.upper << ", got "
             << theta[i];
        break;
      }
      break;
    case LookupStatus::kOutsidePartition:
      text << " no region holds";
      for (std::size_t i = 0; i < parameterCount(); ++i) text << (i == 0 ? " (" : ", ") << theta[i];
      text << ")";
      break;
  }
  throw OutsideError(text.str());
}

void LoadedMap::evaluateMany(const double* thetas, std::size_t count, int threads, double* u) const {
  const std::size_t p = parameterCount();
  const std::size_t m = inputCount();
  inParts(count, threads, [=](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      if (map_.evaluate(thetas + i * p, u + i * m).status == LookupStatus::kInside) continue;
      std::fill_n(u + i * m, m, std::numeric_limits<double>::quiet_NaN());
    }
  });
}

void LoadedMap::locateMany(const double* thetas, std::size_t count, int threads,
                           std::int64_t* regions) const {
  const std::size_t p = parameterCount();
  inParts(count, threads, [=](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Lookup lookup = map_.locate(thetas + i * p);
      regions[i] = lookup.status == LookupStatus::kInside ? std::int64_t{lookup.region} : -1;
    }
  });
}

ParametricProgram LoadedMap::program() const {
  if (isRobust()) throw Error(textSource() + ": type: a robust_mpc has no parametric program");
  return parseProgram(std::string(map_.problemText()), std::string(map_.problemKind()), textSource());
}

bool LoadedMap::isRobust() const {
  return map_.problemKind() == "yaml" && !map_.problemText().empty() &&
         isRobustProblem(std::string(map_.problemText()), textSource());
}

}  // namespace polyfly::python
