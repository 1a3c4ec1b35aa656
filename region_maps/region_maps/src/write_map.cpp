#include "region_maps/write_map.hpp"

#include <cstring>

#include "check_map.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/write_file.hpp"

namespace polyfly {
namespace {

[[noreturn]] void refuse(const MapContent& content, const std::string& rule) {
  throw Error((content.name.empty() ? std::string("region map") : content.name) + ": " + rule);
}

/// The text section: every string with a zero byte after it.
std::string layOutText(const MapContent& content) {
  std::string text;
  const auto add = [&](const std::string& string, const char* what) {
    if (string.find('\0') != std::string::npos) refuse(content, std::string(what) + ": holds a zero byte");
    text.append(string).push_back('\0');
  };
  add(content.name, "name");
  add(content.problem_text, "problem text");
  add(content.problem_kind, "problem kind");
  add(content.solver_status, "solver status");
  add(content.solver_notes, "solver notes");
  for (const auto* const signals : {&content.parameters, &content.inputs}) {
    for (const Signal& signal : *signals) {
      add(signal.name, "name of a signal");
      add(signal.unit, "unit of a signal");
    }
  }
  return text;
}

std::vector<format::Bounds> layOutBounds(const MapContent& content) {
  std::vector<format::Bounds> bounds;
  for (const auto* const signals : {&content.parameters, &content.inputs}) {
    for (const Signal& signal : *signals) bounds.push_back({signal.lower, signal.upper});
  }
  return bounds;
}

/// A section's bytes in memory.
struct Source {
  const void* data;
  std::size_t bytes;
};

template <typename Container>
Source sourceOf(const Container& values) {
  return {values.data(), values.size() * sizeof(values[0])};
}

void checkCounts(const MapContent& content) {
  const std::size_t p = content.parameters.size();
  const std::size_t m = content.inputs.size();
  if (p < 1 || p > format::kMaxSignals)
    refuse(content, "parameters: must be 1 to 256, got " + std::to_string(p));
  if (m < 1 || m > format::kMaxSignals) refuse(content, "inputs: must be 1 to 256, got " + std::to_string(m));
  if (content.planes.size() % (p + 1) != 0) refuse(content, "planes: must hold p + 1 numbers each");
  if (content.laws.size() % ((p + 1) * m) != 0)
    refuse(content, "laws: must hold m rows of p + 1 numbers each");
}

}  // namespace

std::vector<std::byte> layOut(const MapContent& content) {
  checkCounts(content);
  const std::string text = layOutText(content);
  const std::vector<format::Bounds> bounds = layOutBounds(content);
  const Source sources[format::kSectionCount] = {sourceOf(text),
                                                 sourceOf(bounds),
                                                 sourceOf(content.planes),
                                                 sourceOf(content.laws),
                                                 sourceOf(content.regions),
                                                 sourceOf(content.rows),
                                                 sourceOf(content.active),
                                                 sourceOf(content.nodes),
                                                 sourceOf(content.leaves),
                                                 sourceOf(content.candidates),
                                                 sourceOf(content.tests)};

  format::Header header = {};
  std::memcpy(header.magic, format::kMagic, sizeof(header.magic));
  header.byte_order = format::kByteOrder;
  header.version = format::kVersion;
  header.parameters = static_cast<std::uint32_t>(content.parameters.size());
  header.inputs = static_cast<std::uint32_t>(content.inputs.size());
  header.root = content.root;
  header.section_count = format::kSectionCount;
  header.period = content.period;
  header.tolerance = content.tolerance;
  header.reduced_from = content.reduced_from;
  std::uint64_t end = sizeof(header);
  for (std::size_t i = 0; i < format::kSectionCount; ++i) {
    header.sections[i] = {format::alignUp(end),
                          sources[i].bytes / format::elementSize(i, header.parameters, header.inputs)};
    end = header.sections[i].offset + sources[i].bytes;
  }
  header.file_size = format::alignUp(end);

  std::vector<std::byte> bytes(header.file_size, std::byte{0});
  for (std::size_t i = 0; i < format::kSectionCount; ++i) {
    if (sources[i].bytes != 0)
      std::memcpy(bytes.data() + header.sections[i].offset, sources[i].data, sources[i].bytes);
  }
  std::memcpy(bytes.data(), &header, sizeof(header));
  const LookupCost cost =
      checkStructure(bytes.data(), bytes.size(), content.name.empty() ? "region map" : content.name).cost;
  header.depth = cost.depth;
  header.region_checks = cost.region_checks;
  header.multiply_adds = cost.multiply_adds;
  std::memcpy(bytes.data(), &header, sizeof(header));
  header.checksum = format::checksum(bytes.data(), bytes.size());
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

void writeMap(const MapContent& content, const std::string& path) {
  writeFileAtomically(path, layOut(content));
}

}  // namespace polyfly
