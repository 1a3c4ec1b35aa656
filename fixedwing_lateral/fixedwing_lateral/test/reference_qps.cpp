#include "reference_qps.hpp"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "reference_data.hpp"

namespace lateral_test {
namespace {

using namespace polyfly;

constexpr int kMoves = 40;
constexpr int kStates = 6;
constexpr int kOnline = 18;
// Where the parts of `extra` begin.
constexpr int kNodesAt = kStates + kMoves;
constexpr int kOnlineAt = kNodesAt + (kMoves + 1) * kStates;

std::filesystem::path folder() { return referenceData("online_qps"); }

PathSegment segmentFrom(const double* p) {
  if (p[0] == 0.0) return LineSegment{{p[1], p[2]}, {p[3], p[4]}};
  const TurnDirection direction = p[4] > 0.0 ? TurnDirection::kRight : TurnDirection::kLeft;
  return ArcSegment{{p[1], p[2]}, p[3], direction, p[5], p[6]};
}

ReferenceQp read(const nlohmann::json& instance) {
  const auto extra = instance.at("extra").get<std::vector<double>>();
  ReferenceQp qp;
  for (int i = 0; i < kStates; ++i) qp.state[i] = extra[i];
  qp.moves.assign(&extra[kStates], &extra[kStates] + kMoves);
  for (int k = 0; k <= kMoves; ++k)
    qp.nodes.emplace_back(Eigen::Map<const LateralState>(&extra[kNodesAt + k * kStates]));
  const double* online = &extra[kOnlineAt];
  qp.data.conditions.airspeed = online[0];
  qp.data.conditions.wind = {online[1], online[2]};
  qp.data.current = segmentFrom(online + 3);
  qp.data.next = segmentFrom(online + 10);
  qp.data.conditions.gate = SwitchGate(qp.data.current);
  for (int k = 0; k < kMoves; ++k) qp.previous.push_back(online[k * kOnline + 17]);
  qp.solution = instance.at("x_ref").get<std::vector<double>>();
  return qp;
}

}  // namespace

std::vector<ReferenceQp> readReferenceQps(const std::string& name) {
  std::vector<ReferenceQp> qps;
  std::ifstream file(folder() / (name + ".json"));
  if (!file) return qps;
  const nlohmann::json content = nlohmann::json::parse(file);
  for (const auto& instance : content.at("instances")) qps.push_back(read(instance));
  return qps;
}

}  // namespace lateral_test
