#include "validation/map_proposal.hpp"

#include <yaml-cpp/yaml.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <iomanip>
#include <locale>
#include <mutex>
#include <new>
#include <sstream>
#include <thread>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/explore.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/load_yaml.hpp"
#include "region_maps/region_map.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly {
namespace {

/// Sets a flag when a time is over, unless it is destroyed before.
class Deadline {
 public:
  explicit Deadline(double seconds) : timer_([this, seconds] { run(seconds); }) {}
  ~Deadline() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      done_ = true;
    }
    changed_.notify_one();
    timer_.join();
  }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  const std::atomic<bool>& over() const { return over_; }

 private:
  void run(double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    over_ = !changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return done_; });
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::atomic<bool> over_{false};
  std::thread timer_;  // last: it uses the others
};

// Outwards to three significant digits, as people write ranges.
double roundedOut(double value, bool up) {
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
  return (up ? std::ceil(value / unit) : std::floor(value / unit)) * unit;
}

std::vector<MapProposal::Change> changesOf(const MapUse& use) {
  std::vector<MapProposal::Change> changes;
  for (const ParameterUse& parameter : use.parameters) {
    const auto [lower, upper] = parameter.proposedRange();
    if (lower == parameter.lower && upper == parameter.upper) continue;
    changes.push_back({parameter.name,
                       parameter.unit,
                       {parameter.lower, parameter.upper},
                       {lower == parameter.lower ? lower : roundedOut(lower, false),
                        upper == parameter.upper ? upper : roundedOut(upper, true)}});
  }
  return changes;
}

// The text with the range of one parameter replaced; all else, comments too, stays as it is.
std::string withRange(const std::string& text, const MapProposal::Change& change) {
  const YAML::Node parameters = loadYaml(text, "the map's problem")["parameters"];
  for (const YAML::Node& parameter : parameters) {
    if (!parameter["name"] || parameter["name"].as<std::string>() != change.parameter) continue;
    const YAML::Node range = parameter["range"];
    const auto begin = range ? static_cast<std::size_t>(range.Mark().pos) : text.size();
    const std::size_t end =
        begin < text.size() && text[begin] == '[' ? text.find(']', begin) : std::string::npos;
    if (end == std::string::npos) break;
    std::ostringstream list;
    list.imbue(std::locale::classic());
    list << std::setprecision(10) << "[" << change.to[0] << ", " << change.to[1] << "]";
    return text.substr(0, begin) + list.str() + text.substr(end + 1);
  }
  throw Error("parameters: " + change.parameter +
              ": no `range: [least, greatest]` to change in the map's problem");
}

// An interrupted feasible set bounds nothing: no region is known before it is whole.
void countRobust(const ProposalLimits& limits, MapProposal* proposal) {
  const RobustProblem problem = parseRobustProblem(proposal->problem, proposal->map_path + " (proposal)");
  const Deadline deadline(limits.seconds);
  ProjectOptions options;
  options.stop = &deadline.over();
  const FeasibleSet set = projectFeasibleSet(buildRobustProgram(problem), options);
  if (set.interrupted) return;
  proposal->regions_then = explicitLaw(problem, set).regions.size();
  proposal->counted_all = true;
}

void countLinear(const std::string& kind, const ProposalLimits& limits, MapProposal* proposal) {
  const ParametricProgram program = parseProgram(proposal->problem, kind, proposal->map_path + " (proposal)");
  ExploreOptions options;
  options.region_limit = limits.regions;
  options.time_limit = limits.seconds;
  const Partition partition = explore(program, options);
  proposal->regions_then = partition.regions.size();
  proposal->counted_all = partition.status == ExploreStatus::kComplete;
}

void count(const std::string& kind, const ProposalLimits& limits, MapProposal* proposal) {
  const bool yaml = kind == "yaml";
  if (yaml && isRobustProblem(proposal->problem, proposal->map_path)) {
    countRobust(limits, proposal);
  } else {
    countLinear(kind, limits, proposal);
  }
  if (proposal->counted_all || proposal->regions_then > 0) return;
  std::ostringstream text;
  text << "its regions were not counted within " << limits.seconds << " s: `offline_mpt solve` takes longer";
  proposal->obstacle = text.str();
}

}  // namespace

std::optional<MapProposal> proposeMap(const RegionMap& map, const MapUse& use, const std::string& axis,
                                      const ProposalLimits& limits) {
  MapProposal proposal;
  proposal.axis = axis;
  proposal.map_path = map.path();
  proposal.regions = map.regionCount();
  proposal.changes = changesOf(use);
  proposal.infeasible = use.outside_partition;
  if (proposal.changes.empty() && proposal.infeasible == 0) return std::nullopt;
  if (proposal.changes.empty()) {
    proposal.obstacle =
        "no range covers these samples: the problem has no solution there; its bounds on states or its "
        "horizon must change";
    return proposal;
  }
  try {
    std::string text(map.problemText());
    for (const MapProposal::Change& change : proposal.changes) text = withRange(text, change);
    proposal.problem = text;
    count(std::string(map.problemKind()), limits, &proposal);
  } catch (const std::bad_alloc&) {  // is no property of the problem
    throw;
  } catch (const std::exception& error) {
    proposal.obstacle = error.what();
  }
  return proposal;
}

}  // namespace polyfly
