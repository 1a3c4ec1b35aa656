#include "region_maps/region_map.hpp"

#include "check_map.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::vector<Signal> readSignals(const std::string_view* texts, const format::Bounds* bounds,
                                std::size_t count) {
  std::vector<Signal> signals(count);
  for (std::size_t i = 0; i < count; ++i) {
    signals[i] = {std::string(texts[2 * i]), std::string(texts[2 * i + 1]), bounds[i].lower, bounds[i].upper};
  }
  return signals;
}

std::vector<double> widenedBox(const std::vector<Signal>& parameters, double tolerance) {
  std::vector<double> box;
  box.reserve(2 * parameters.size());
  for (const Signal& parameter : parameters) {
    const double slack = tolerance * (0.5 * parameter.upper - 0.5 * parameter.lower);
    box.push_back(parameter.lower - slack);
    box.push_back(parameter.upper + slack);
  }
  return box;
}

}  // namespace

RegionMap RegionMap::open(const std::string& path) {
  RegionMap map;
  map.path_ = path;
  map.file_ = MappedFile(path);
  map.load(map.file_.data(), map.file_.size());
  return map;
}

RegionMap RegionMap::view(const void* data, std::size_t size, const std::string& name) {
  if (reinterpret_cast<std::uintptr_t>(data) % format::kAlignment != 0) {
    throw Error(name + ": must be aligned to 64 bytes in memory");
  }
  RegionMap map;
  map.path_ = name;
  map.load(data, size);
  return map;
}

void RegionMap::load(const void* data, std::size_t size) {
  checkFrame(data, size, path_);
  data_ = data;
  const MapFacts facts = checkStructure(data, size, path_);
  const format::Header header = format::readHeader(data);
  checkCost(header, facts.cost, path_);
  cost_ = facts.cost;
  header_ = header;
  for (std::size_t i = 0; i < texts_.size(); ++i) texts_[i] = facts.texts[i];
  const std::string_view* const signal_texts = facts.texts.data() + format::kTextCount;
  const auto* const bounds = sectionStart<format::Bounds>(data, header, format::kBounds);
  const std::size_t p = header.parameters;
  parameters_ = readSignals(signal_texts, bounds, p);
  inputs_ = readSignals(signal_texts + 2 * p, bounds + p, header.inputs);
  box_ = widenedBox(parameters_, header.tolerance);
  active_ = sectionStart<std::int32_t>(data, header, format::kActive);
  tables_.box = box_.data();
  tables_.planes = sectionStart<double>(data, header, format::kPlanes);
  tables_.laws = sectionStart<double>(data, header, format::kLaws);
  tables_.regions = sectionStart<MapContent::Region>(data, header, format::kRegions);
  tables_.rows = sectionStart<std::int32_t>(data, header, format::kRows);
  tables_.nodes = sectionStart<MapContent::Node>(data, header, format::kNodes);
  tables_.leaves = sectionStart<MapContent::Leaf>(data, header, format::kLeaves);
  tables_.candidates = sectionStart<std::uint32_t>(data, header, format::kCandidates);
  if (header.sections[format::kTests].count != 0)
    tables_.tests = sectionStart<std::uint32_t>(data, header, format::kTests);
  tables_.tolerance = header.tolerance;
  tables_.handicap = format::kHandicap * header.tolerance;
  tables_.first_fallback = static_cast<std::uint32_t>(firstFallback());
  tables_.root = header.root;
  tables_.parameters = header.parameters;
  tables_.inputs = header.inputs;
  functions_ = functionsFor(header.parameters);
  index_ = SearchIndex(*this);
  tables_.index = index_.view();
}

std::string_view RegionMap::name() const noexcept { return texts_[format::kName]; }
std::string_view RegionMap::problemText() const noexcept { return texts_[format::kProblemText]; }
std::string_view RegionMap::problemKind() const noexcept { return texts_[format::kProblemKind]; }
std::string_view RegionMap::solverStatus() const noexcept { return texts_[format::kSolverStatus]; }
std::string_view RegionMap::solverNotes() const noexcept { return texts_[format::kSolverNotes]; }
double RegionMap::period() const noexcept { return header_.period; }
double RegionMap::tolerance() const noexcept { return header_.tolerance; }

std::size_t RegionMap::regionCount() const noexcept { return header_.sections[format::kRegions].count; }
std::size_t RegionMap::lawCount() const noexcept { return header_.sections[format::kLaws].count; }
std::size_t RegionMap::planeCount() const noexcept { return header_.sections[format::kPlanes].count; }
std::size_t RegionMap::nodeCount() const noexcept { return header_.sections[format::kNodes].count; }
std::size_t RegionMap::leafCount() const noexcept { return header_.sections[format::kLeaves].count; }
std::uint32_t RegionMap::formatVersion() const noexcept { return header_.version; }
std::size_t RegionMap::bytes() const noexcept { return header_.file_size; }
std::uint64_t RegionMap::checksum() const noexcept { return header_.checksum; }
std::size_t RegionMap::firstFallback() const noexcept {
  return header_.first_fallback != 0 ? header_.first_fallback : regionCount();
}
std::uint64_t RegionMap::reducedFrom() const noexcept { return header_.reduced_from; }

RegionView RegionMap::region(std::size_t index) const noexcept {
  const MapContent::Region& region = tables_.regions[index];
  return {tables_.rows + region.first_row,
          region.row_count,
          active_ + region.first_active,
          region.active_count,
          region.law,
          region.first_row};
}

std::uint32_t RegionMap::root() const noexcept { return tables_.root; }

const MapContent::Node& RegionMap::node(std::size_t index) const noexcept { return tables_.nodes[index]; }

LeafView RegionMap::leaf(std::size_t index) const noexcept {
  const MapContent::Leaf& leaf = tables_.leaves[index];
  return {tables_.candidates + leaf.first, tables_.tests == nullptr ? nullptr : tables_.tests + leaf.first,
          leaf.count};
}

const double* RegionMap::plane(std::size_t index) const noexcept {
  return tables_.planes + index * (std::size_t{tables_.parameters} + 1);
}

const double* RegionMap::law(std::size_t index) const noexcept {
  return tables_.laws + index * (std::size_t{tables_.parameters} + 1) * tables_.inputs;
}

Lookup RegionMap::locate(const double* theta) const noexcept { return functions_.locate(tables_, theta); }

Lookup RegionMap::locateFrom(const double* theta, std::uint32_t last) const noexcept {
  return functions_.locate_from(tables_, theta, last);
}

Lookup RegionMap::evaluateFrom(const double* theta, std::uint32_t last, double* u) const noexcept {
  return functions_.evaluate_from(tables_, theta, last, u);
}

Lookup RegionMap::evaluate(const double* theta, double* u) const noexcept {
  return functions_.evaluate(tables_, theta, u);
}

Lookup RegionMap::locateInFile(const double* theta) const noexcept {
  return functions_.locate_in_file(tables_, theta);
}

Lookup RegionMap::locateExhaustively(const double* theta) const noexcept {
  return functions_.locate_exhaustively(tables_, regionCount(), theta);
}

bool RegionMap::contains(std::size_t index, const double* theta) const noexcept {
  return functions_.contains(tables_, index, theta);
}

}  // namespace polyfly
