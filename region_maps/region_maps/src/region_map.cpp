#include "region_maps/region_map.hpp"

#include <array>
#include <string>
#include <utility>

#include "check_map.hpp"
#include "point_location.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/format.hpp"
#include "region_maps/read_file.hpp"

namespace polyfly {
namespace {

static_assert(kHeadBytes >= sizeof(format::Header), "the whole header is checked before memory is taken");

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

/// All but the box.
LookupTables tablesOf(const void* data, const format::Header& header) {
  LookupTables tables;
  tables.planes = sectionStart<double>(data, header, format::kPlanes);
  tables.laws = sectionStart<double>(data, header, format::kLaws);
  tables.regions = sectionStart<MapContent::Region>(data, header, format::kRegions);
  tables.rows = sectionStart<std::int32_t>(data, header, format::kRows);
  tables.nodes = sectionStart<MapContent::Node>(data, header, format::kNodes);
  tables.leaves = sectionStart<MapContent::Leaf>(data, header, format::kLeaves);
  tables.candidates = sectionStart<std::uint32_t>(data, header, format::kCandidates);
  if (header.sections[format::kTests].count != 0)
    tables.tests = sectionStart<std::uint32_t>(data, header, format::kTests);
  tables.tolerance = header.tolerance;
  tables.root = header.root;
  tables.parameters = header.parameters;
  tables.inputs = header.inputs;
  return tables;
}

}  // namespace

struct RegionMap::Loaded {
  // First, what a look-up touches.
  LookupFunctions functions;
  LookupTables tables;
  std::string path;
  AlignedBytes bytes;
  const void* data = nullptr;  // the file, in `bytes` or with the caller of view()
  format::Header header = {};
  const std::int32_t* active = nullptr;  // into the file
  // Views into the file.
  std::array<std::string_view, format::kTextCount> texts;
  std::vector<Signal> parameters;
  std::vector<Signal> inputs;
  std::vector<double> box;
  LookupCost cost;
};

RegionMap::RegionMap(std::unique_ptr<Loaded> loaded) noexcept : loaded_(std::move(loaded)) {}
RegionMap::RegionMap(RegionMap&& other) noexcept = default;
RegionMap& RegionMap::operator=(RegionMap&& other) noexcept = default;
RegionMap::~RegionMap() = default;

RegionMap RegionMap::open(const std::string& path, std::uint64_t most_bytes) {
  auto loaded = std::make_unique<Loaded>();
  loaded->path = path;
  loaded->bytes = readFile(path, [&](const void* head, std::uint64_t size) {
    checkHead(head, size, path);
    if (size <= most_bytes) return;
    throw Error(path + ": is too large for a node: " + std::to_string(size) + " bytes, at most " +
                std::to_string(most_bytes));
  });
  loaded->data = loaded->bytes.data();
  const std::size_t size = loaded->bytes.size();
  return load(std::move(loaded), size);
}

RegionMap RegionMap::view(const void* data, std::size_t size, const std::string& name) {
  if (reinterpret_cast<std::uintptr_t>(data) % format::kAlignment != 0) {
    throw Error(name + ": must be aligned to 64 bytes in memory");
  }
  auto loaded = std::make_unique<Loaded>();
  loaded->path = name;
  loaded->data = data;
  return load(std::move(loaded), size);
}

RegionMap RegionMap::load(std::unique_ptr<Loaded> loaded, std::size_t size) {
  RegionMap map(std::move(loaded));
  Loaded& own = *map.loaded_;
  const void* const data = own.data;
  checkHead(data, size, own.path);
  checkSum(data, size, own.path);
  const MapFacts facts = checkStructure(data, size, own.path);
  const format::Header header = format::readHeader(data);
  checkCost(header, facts.cost, own.path);
  own.cost = facts.cost;
  own.header = header;
  for (std::size_t i = 0; i < own.texts.size(); ++i) own.texts[i] = facts.texts[i];
  const std::string_view* const signal_texts = facts.texts.data() + format::kTextCount;
  const auto* const bounds = sectionStart<format::Bounds>(data, header, format::kBounds);
  const std::size_t p = header.parameters;
  own.parameters = readSignals(signal_texts, bounds, p);
  own.inputs = readSignals(signal_texts + 2 * p, bounds + p, header.inputs);
  own.box = widenedBox(own.parameters, header.tolerance);
  own.active = sectionStart<std::int32_t>(data, header, format::kActive);
  own.tables = tablesOf(data, header);
  own.tables.box = own.box.data();
  own.functions = lookupFunctionsFor(header.parameters);
  return map;
}

const std::string& RegionMap::path() const noexcept { return loaded_->path; }
const std::vector<Signal>& RegionMap::parameters() const noexcept { return loaded_->parameters; }
const std::vector<Signal>& RegionMap::inputs() const noexcept { return loaded_->inputs; }
const LookupCost& RegionMap::cost() const noexcept { return loaded_->cost; }
std::string_view RegionMap::file() const noexcept {
  return {static_cast<const char*>(loaded_->data), bytes()};
}
std::string_view RegionMap::name() const noexcept { return loaded_->texts[format::kName]; }
std::string_view RegionMap::problemText() const noexcept { return loaded_->texts[format::kProblemText]; }
std::string_view RegionMap::problemKind() const noexcept { return loaded_->texts[format::kProblemKind]; }
std::string_view RegionMap::solverStatus() const noexcept { return loaded_->texts[format::kSolverStatus]; }
std::string_view RegionMap::solverNotes() const noexcept { return loaded_->texts[format::kSolverNotes]; }
double RegionMap::period() const noexcept { return loaded_->header.period; }
double RegionMap::tolerance() const noexcept { return loaded_->header.tolerance; }

std::size_t RegionMap::regionCount() const noexcept {
  return loaded_->header.sections[format::kRegions].count;
}
std::size_t RegionMap::lawCount() const noexcept { return loaded_->header.sections[format::kLaws].count; }
std::size_t RegionMap::planeCount() const noexcept { return loaded_->header.sections[format::kPlanes].count; }
std::size_t RegionMap::nodeCount() const noexcept { return loaded_->header.sections[format::kNodes].count; }
std::size_t RegionMap::leafCount() const noexcept { return loaded_->header.sections[format::kLeaves].count; }
std::uint32_t RegionMap::formatVersion() const noexcept { return loaded_->header.version; }
std::size_t RegionMap::bytes() const noexcept { return loaded_->header.file_size; }
std::uint64_t RegionMap::checksum() const noexcept { return loaded_->header.checksum; }
std::uint64_t RegionMap::reducedFrom() const noexcept { return loaded_->header.reduced_from; }

RegionView RegionMap::region(std::size_t index) const noexcept {
  const MapContent::Region& region = loaded_->tables.regions[index];
  return {loaded_->tables.rows + region.first_row,
          region.row_count,
          loaded_->active + region.first_active,
          region.active_count,
          region.law,
          region.first_row};
}

std::uint32_t RegionMap::root() const noexcept { return loaded_->tables.root; }

const MapContent::Node& RegionMap::node(std::size_t index) const noexcept {
  return loaded_->tables.nodes[index];
}

LeafView RegionMap::leaf(std::size_t index) const noexcept {
  const MapContent::Leaf& leaf = loaded_->tables.leaves[index];
  return {loaded_->tables.candidates + leaf.first,
          loaded_->tables.tests == nullptr ? nullptr : loaded_->tables.tests + leaf.first, leaf.count};
}

const double* RegionMap::plane(std::size_t index) const noexcept {
  return loaded_->tables.planes + index * (std::size_t{loaded_->tables.parameters} + 1);
}

const double* RegionMap::law(std::size_t index) const noexcept {
  return loaded_->tables.laws +
         index * (std::size_t{loaded_->tables.parameters} + 1) * loaded_->tables.inputs;
}

Lookup RegionMap::locate(const double* theta) const noexcept {
  return loaded_->functions.locate(loaded_->tables, theta);
}

Lookup RegionMap::evaluate(const double* theta, double* u) const noexcept {
  return loaded_->functions.evaluate(loaded_->tables, theta, u);
}

Lookup RegionMap::locateExhaustively(const double* theta) const noexcept {
  return loaded_->functions.locate_exhaustively(loaded_->tables, regionCount(), theta);
}

bool RegionMap::contains(std::size_t index, const double* theta) const noexcept {
  return loaded_->functions.contains(loaded_->tables, index, theta);
}

}  // namespace polyfly
