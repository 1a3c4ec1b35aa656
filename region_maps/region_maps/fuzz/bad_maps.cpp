#include "bad_maps.hpp"

#include <cstring>
#include <functional>
#include <limits>

#include "region_maps/format.hpp"
#include "region_maps/write_map.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

using Bytes = std::vector<std::byte>;
using format::Header;
using format::Section;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kHuge = std::numeric_limits<double>::max();

Header headerOf(const Bytes& bytes) {
  Header header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  return header;
}

void setHeader(Bytes& bytes, const Header& header) { std::memcpy(bytes.data(), &header, sizeof(header)); }

/// The small map under change. Numbers are put `index` numbers of their own size after the section's start.
struct MapMutation {
  Bytes bytes = layOut(makeSmallMap());
  Header header = headerOf(bytes);

  template <typename T>
  void put(Section section, std::size_t index, T value) {
    std::memcpy(bytes.data() + header.sections[section].offset + index * sizeof(T), &value, sizeof(T));
  }
  void putText(const std::string& before, const std::string& after) {
    const auto* const text =
        reinterpret_cast<const char*>(bytes.data() + header.sections[format::kText].offset);
    const std::size_t place = std::string(text, header.sections[format::kText].count).find(before);
    for (std::size_t i = 0; i < after.size(); ++i) put(format::kText, place + i, after[i]);
  }
};

using Change = std::function<void(MapMutation&)>;

/// A change of the header alone.
Change inHeader(const std::function<void(Header&)>& change) {
  return [change](MapMutation& patient) { change(patient.header); };
}

template <typename T>
Change put(Section section, std::size_t index, T value) {
  return [=](MapMutation& patient) { patient.put(section, index, value); };
}

struct Rule {
  const char* name;
  const char* reason;
  Change change;
};

std::vector<BadMap> apply(const std::vector<Rule>& rules) {
  std::vector<BadMap> maps;
  for (const Rule& rule : rules) {
    MapMutation patient;
    rule.change(patient);
    setHeader(patient.bytes, patient.header);
    repairFrame(patient.bytes);
    maps.push_back({rule.name, patient.bytes, rule.reason});
  }
  return maps;
}

std::vector<Rule> headerRules() {
  return {
      {"no_parameter", "header: parameters must be 1 to 256", inHeader([](Header& h) { h.parameters = 0; })},
      {"many_parameters", "header: parameters must be 1 to 256",
       inHeader([](Header& h) { h.parameters = 257; })},
      {"no_input", "header: inputs must be 1 to 256", inHeader([](Header& h) { h.inputs = 0; })},
      {"many_inputs", "header: inputs must be 1 to 256", inHeader([](Header& h) { h.inputs = 0xffffffffu; })},
      {"section_count", "header: sections must be 11", inHeader([](Header& h) { h.section_count = 10; })},
      {"section_count_of_version_1", "header: sections must be 10",
       inHeader([](Header& h) { h.version = 1; })},
      {"period_nan", "header: period must be", inHeader([](Header& h) { h.period = kNan; })},
      {"period_infinite", "header: period must be", inHeader([](Header& h) { h.period = kInfinity; })},
      {"period_negative", "header: period must be", inHeader([](Header& h) { h.period = -0.1; })},
      {"tolerance_nan", "header: tolerance must be 0 to 1e-08, got nan",
       inHeader([](Header& h) { h.tolerance = kNan; })},
      {"tolerance_negative", "header: tolerance must be 0 to 1e-08, got -1e-09",
       inHeader([](Header& h) { h.tolerance = -1e-9; })},
      {"tolerance_large", "header: tolerance must be 0 to 1e-08, got 1.5",
       inHeader([](Header& h) { h.tolerance = 1.5; })},
      {"tolerance_of_half_a_range", "header: tolerance must be 0 to 1e-08, got 1",
       inHeader([](Header& h) { h.tolerance = 1.0; })},
      {"tolerance_just_above", "header: tolerance must be 0 to 1e-08, got 1.1e-08",
       inHeader([](Header& h) { h.tolerance = 1.1e-8; })},
      {"reserved", "reserved bytes of the header must be zero",
       inHeader([](Header& h) { h.reserved[3] = 1; })},
      {"fallback_regions",
       "header: has fallback regions, which `reduce --separate` of version 0.2 wrote; reduce the original "
       "map "
       "again",
       inHeader([](Header& h) { h.first_fallback = 3; })},
      {"cost_depth", "cost does not agree", inHeader([](Header& h) { ++h.depth; })},
      {"cost_checks", "cost does not agree", inHeader([](Header& h) { --h.region_checks; })},
      {"cost_multiply_adds", "cost does not agree", inHeader([](Header& h) { h.multiply_adds = 0; })},
  };
}

std::vector<Rule> sectionRules() {
  constexpr std::uint64_t kVast = std::numeric_limits<std::uint64_t>::max();
  const auto offset = [](Section section, std::uint64_t value) {
    return inHeader([=](Header& h) { h.sections[section].offset = value; });
  };
  const auto count = [](Section section, std::uint64_t value) {
    return inHeader([=](Header& h) { h.sections[section].count = value; });
  };
  return {
      {"section_in_header", "section text: must start at byte 320", offset(format::kText, 0)},
      {"section_overlap", "section rows: must start at byte",
       inHeader([](Header& h) { h.sections[format::kRows].offset = h.sections[format::kRegions].offset; })},
      {"section_gap", "section nodes: must start at byte",
       inHeader([](Header& h) { h.sections[format::kNodes].offset += 64; })},
      {"section_unaligned", "section laws: must start at byte",
       inHeader([](Header& h) { h.sections[format::kLaws].offset += 8; })},
      {"section_far", "section leaves: must start at byte", offset(format::kLeaves, kVast)},
      {"section_long", "section candidates: reaches beyond the end", count(format::kCandidates, 1000)},
      {"section_vast", "section rows: too many elements", count(format::kRows, kVast)},
      {"section_many", "section nodes: too many elements", count(format::kNodes, 0x80000000u)},
      {"text_vast", "section text: reaches beyond the end", count(format::kText, kVast)},
      {"section_short", "must start at byte", count(format::kPlanes, 0)},
      {"bounds_count", "section bounds: must have one element for each",
       [](MapMutation& patient) {
         // One fewer, and the following section stays where it is.
         patient.header.sections[format::kBounds].count = 2;
         patient.put(format::kBounds, 4, 0.0);
         patient.put(format::kBounds, 5, 0.0);
       }},
      {"early_end", "the sections end at byte",
       [](MapMutation& patient) { patient.bytes.resize(patient.bytes.size() + 64); }},
      {"padding_between", "the bytes before section bounds must be zero",
       [](MapMutation& patient) {
         patient.bytes[patient.header.sections[format::kBounds].offset - 1] = std::byte{1};
       }},
      {"padding_after", "the bytes after the last section must be zero",
       [](MapMutation& patient) { patient.bytes.back() = std::byte{0x80}; }},
  };
}

std::vector<Rule> textRules() {
  const auto text = [](const std::string& before, const std::string& after) {
    return [=](MapMutation& patient) { patient.putText(before, after); };
  };
  const std::string zero(1, '\0');
  return {
      {"text_open", "the last string has no end",
       [](MapMutation& patient) {
         patient.put(format::kText, patient.header.sections[format::kText].count - 1, 'x');
       }},
      {"text_more", "section text: more strings than 11", text("horizon", zero)},
      {"text_fewer", "section text: must hold 11 strings, holds 10", text("small" + zero, "smallx")},
      {"text_not_utf8", "string 1 is not UTF-8", text("horizon", "\xff")},
      {"text_overlong", "string 1 is not UTF-8", text("horizon", "\xc0\xaf")},
      {"text_surrogate", "string 1 is not UTF-8", text("horizon", "\xed\xa0\x80")},
      {"text_cut_sequence", "string 2 is not UTF-8", text("yaml", "yam\xc2")},
      {"text_control", "string 3 holds a control character", text("complete", "comp\nete")},
      {"signal_control", "string 5 holds a control character",
       text("theta_0",
            "theta\x7f"
            "0")},
      {"signal_nameless", "parameter 0: has no name",
       [](MapMutation& patient) {
         // Its unit grows by what the name loses, so that the number of strings stays.
         patient.putText("theta_0" + std::string(1, '\0') + "m", std::string(1, '\0') + "heta_0mm");
       }},
      {"signal_twice", "parameter 1: name theta_0 occurs twice", text("theta_1", "theta_0")},
  };
}

std::vector<Rule> numberRules() {
  return {
      {"bound_nan", "parameter 0: lower must not exceed upper", put(format::kBounds, 0, kNan)},
      {"bound_swapped", "parameter 1: lower must not exceed upper", put(format::kBounds, 2, 3.0)},
      {"bound_infinite", "parameter 1: bounds must be finite", put(format::kBounds, 3, kInfinity)},
      {"bound_huge", "parameter 0: bounds must be finite",
       [](MapMutation& patient) {
         patient.put(format::kBounds, 0, -kHuge);
         patient.put(format::kBounds, 1, kHuge);
       }},
      {"input_bound_nan", "input 0: lower must not exceed upper", put(format::kBounds, 5, kNan)},
      {"input_bound_void", "input 0: no value lies between its bounds",
       [](MapMutation& patient) {
         patient.put(format::kBounds, 4, kInfinity);
         patient.put(format::kBounds, 5, kInfinity);
       }},
      {"plane_nan", "section planes 0: holds a number that is not finite", put(format::kPlanes, 1, kNan)},
      {"plane_infinite", "section planes 5: holds a number that is not finite",
       put(format::kPlanes, 17, -kInfinity)},
      {"plane_zero", "section planes 0: must have the length 1 in scaled parameters, has 0",
       put(format::kPlanes, 0, 0.0)},
      {"plane_short", "section planes 5: must have the length 1 in scaled parameters, has 1e-11",
       put(format::kPlanes, 16, 1e-11)},
      {"plane_long", "section planes 0: must have the length 1 in scaled parameters, has 1",
       put(format::kPlanes, 0, 1.0 + 0x1.1p-40)},
      {"plane_huge", "section planes 0: must have the length 1 in scaled parameters, has inf",
       put(format::kPlanes, 1, 1e308)},
      {"law_nan", "section laws 3: holds a number that is not finite", put(format::kLaws, 9, kNan)},
  };
}

std::vector<Rule> regionRules() {
  constexpr std::uint32_t kMost = 0xffffffffu;
  return {
      {"region_first_row", "region 0: reaches beyond section rows", put(format::kRegions, 0, kMost)},
      {"region_row_count", "region 3: reaches beyond section rows", put(format::kRegions, 16, 5u)},
      {"region_law", "region 1: law 4 does not exist", put(format::kRegions, 7, 4u)},
      {"region_first_active", "region 2: reaches beyond section active", put(format::kRegions, 13, kMost)},
      {"region_active_count", "region 2: reaches beyond section active", put(format::kRegions, 14, 100u)},
      {"row_zero", "row 3: plane does not exist", put(format::kRows, 3, 0)},
      {"row_beyond", "row 15: plane does not exist", put(format::kRows, 15, 7)},
      {"row_negated_beyond", "row 0: plane does not exist", put(format::kRows, 0, -7)},
      {"row_least", "row 0: plane does not exist",
       put(format::kRows, 0, std::numeric_limits<std::int32_t>::min())},
      {"active_negative", "active row 1: must not be negative", put(format::kActive, 1, -1)},
      {"no_region", "section regions: must not be empty",
       [](MapMutation& patient) {
         MapContent map = makeSmallMap();
         patient.bytes = layOut(map);
         // Zero the section and move what follows up: only the header can say "none".
         const std::uint64_t first = patient.header.sections[format::kRegions].offset;
         const std::uint64_t end = patient.header.sections[format::kRows].offset;
         patient.bytes.erase(patient.bytes.begin() + static_cast<std::ptrdiff_t>(first),
                             patient.bytes.begin() + static_cast<std::ptrdiff_t>(end));
         patient.header.sections[format::kRegions].count = 0;
         for (std::size_t i = format::kRows; i < format::kSectionCount; ++i) {
           patient.header.sections[i].offset -= end - first;
         }
       }},
  };
}

std::vector<Rule> treeRules() {
  constexpr std::uint32_t kLeaf = MapContent::kLeaf;
  // Nodes of the small map: 0 -> (1, 2), 1 -> leaves 0 and 1, 2 -> leaves 2 and 3.
  return {
      {"root_beyond", "root 0: node 3 does not exist", inHeader([](Header& h) { h.root = 3; })},
      {"root_leaf_beyond", "root 0: leaf 4 does not exist",
       inHeader([](Header& h) { h.root = MapContent::kLeaf | 4; })},
      {"root_late", "node 0: cannot be reached from the root", inHeader([](Header& h) { h.root = 1; })},
      {"root_leaf", "node 0: cannot be reached from the root",
       inHeader([](Header& h) { h.root = MapContent::kLeaf; })},
      {"node_plane", "node 1: plane does not exist", put(format::kNodes, 3, 6u)},
      {"node_below_beyond", "node 0: node 3 does not exist", put(format::kNodes, 1, 3u)},
      {"node_above_beyond", "node 0: leaf 4 does not exist", put(format::kNodes, 2, kLeaf | 4u)},
      {"node_itself", "node 2: node 2 must come after its parent", put(format::kNodes, 7, 2u)},
      {"node_backwards", "node 2: node 0 must come after its parent", put(format::kNodes, 8, 0u)},
      {"node_shared", "node 0: node 1 has another parent", put(format::kNodes, 2, 1u)},
      {"node_two_parents", "node 1: node 2 has another parent", put(format::kNodes, 4, 2u)},
      {"node_unreachable", "node 2: cannot be reached from the root", put(format::kNodes, 2, kLeaf)},
      {"leaf_first", "leaf 0: reaches beyond section candidates", put(format::kLeaves, 0, 0xffffffffu)},
      {"leaf_count", "leaf 3: reaches beyond section candidates", put(format::kLeaves, 7, 2u)},
      {"candidate", "candidate 2: region does not exist", put(format::kCandidates, 2, 4u)},
      {"test", "test 1: names a row that its region lacks", put(format::kTests, 1, 0x10u)},
      {"test_last_bit", "test 3: names a row that its region lacks", put(format::kTests, 3, 0x80000000u)},
      {"tests_fewer", "section tests: must be empty, or have one element for each candidate",
       [](MapMutation& patient) {
         patient.put(format::kTests, 3, 0u);
         patient.header.sections[format::kTests].count = 3;
       }},
  };
}

}  // namespace

void repairFrame(std::vector<std::byte>& bytes) {
  Header header = headerOf(bytes);
  header.file_size = bytes.size();
  setHeader(bytes, header);
  header.checksum = format::checksum(bytes.data(), bytes.size());
  setHeader(bytes, header);
}

std::vector<BadMap> mapsWithBadFrame() {
  const Bytes good = layOut(makeSmallMap());
  const auto changed = [&](const std::function<void(Header&)>& change) {
    Bytes bytes = good;
    Header header = headerOf(bytes);
    change(header);
    setHeader(bytes, header);
    return bytes;
  };
  const auto cut = [&](std::size_t size) {
    return Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
  };
  const auto text = [](const std::string& string, std::size_t size) {
    Bytes bytes(size);
    std::memcpy(bytes.data(), string.data(), string.size());
    return bytes;
  };
  Bytes longer = good;
  longer.resize(good.size() + 64);
  Bytes unfinished = good;
  std::memset(unfinished.data(), 0, 64);
  Bytes flipped = good;
  flipped[headerOf(good).sections[format::kLaws].offset] ^= std::byte{4};
  Bytes padding = good;
  padding.back() ^= std::byte{1};
  return {
      {"empty", {}, "is empty"},
      {"cut_in_magic", cut(5), "is cut off: 5 bytes"},
      {"cut_in_header", cut(255), "is cut off: 255 bytes"},
      {"cut_after_header", cut(256), "is cut off: 256 bytes"},
      {"cut_at_end", cut(good.size() - 1), "is cut off"},
      {"too_long", longer, "is too long"},
      {"unfinished", unfinished, "is unfinished"},
      {"unfinished_zeros", Bytes(4096), "is unfinished"},
      {"foreign_png", text("\x89PNG\r\n\x1a\n", 1000), "is not a region map"},
      {"foreign_short", text("name: lateral\n", 14), "is not a region map"},
      {"line_ends_translated", text("PFLYMAP\r\n", 1000), "is not a region map"},
      {"big_endian", changed([](Header& h) { h.byte_order = 0x04030201u; }), "byte order mark is wrong"},
      {"version_0", changed([](Header& h) { h.version = 0; }),
       "has format version 0, this program reads versions 1 and 2"},
      {"version_3", changed([](Header& h) { h.version = 3; }),
       "has format version 3, this program reads versions 1 and 2"},
      {"flipped_law", flipped, "checksum does not match"},
      {"flipped_padding", padding, "checksum does not match"},
      {"flipped_checksum", changed([](Header& h) { h.checksum ^= 1; }), "checksum does not match"},
  };
}

std::vector<BadMap> mapsWithBadStructure() {
  std::vector<BadMap> maps;
  for (const auto& rules :
       {headerRules(), sectionRules(), textRules(), numberRules(), regionRules(), treeRules()}) {
    for (BadMap& map : apply(rules)) maps.push_back(std::move(map));
  }
  return maps;
}

}  // namespace polyfly
