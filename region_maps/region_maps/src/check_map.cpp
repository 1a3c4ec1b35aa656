#include "check_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "polyfly_base/error.hpp"
#include "polyfly_base/utf8.hpp"

namespace polyfly {
namespace {

using format::Bounds;
using format::Header;
using format::Section;
using Node = MapContent::Node;
using Leaf = MapContent::Leaf;
using Region = MapContent::Region;

/// By how much the length of a plane may differ from 1.
constexpr double kMaxLengthError = 0x1p-40;  // [scaled]

constexpr const char* kSectionNames[format::kSectionCount] = {"text",    "bounds",     "planes", "laws",
                                                              "regions", "rows",       "active", "nodes",
                                                              "leaves",  "candidates", "tests"};

[[noreturn]] void refuse(const std::string& name, const std::string& rule) {
  throw Error(name + ": " + rule);
}

std::string at(const char* what, std::uint64_t index) {
  return std::string(what) + " " + std::to_string(index);
}

/// Whose rule is being checked; becomes text only when it is broken.
struct Owner {
  const char* what;
  std::uint64_t index;
};

std::string operator+(const Owner& owner, const std::string& rule) {
  return at(owner.what, owner.index) + rule;
}

bool hasControl(std::string_view text) noexcept {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; });
}

/// One map under examination, with its sections as pointers.
class MapValidator {
 public:
  MapValidator(const void* data, std::size_t size, const std::string& name)
      : bytes_(static_cast<const unsigned char*>(data)),
        size_(size),
        header_(format::readHeader(data)),
        name_(name) {}

  void checkHeader() const;
  void checkSections() const;
  std::vector<std::string_view> checkText() const;
  void checkSignalNames(const std::vector<std::string_view>& texts) const;
  void checkNumbers() const;
  void checkRegions() const;
  void checkLeaves() const;
  void checkTests() const;
  LookupCost checkTree() const;

 private:
  struct Path;

  [[noreturn]] void fail(const std::string& rule) const { refuse(name_, rule); }
  std::uint64_t count(Section section) const noexcept { return header_.sections[section].count; }
  template <typename T>
  const T* start(Section section) const noexcept {
    return sectionStart<T>(bytes_, header_, section);
  }
  void checkZero(std::uint64_t first, std::uint64_t end, const std::string& where) const;
  void checkFinite(Section section, std::uint64_t numbers) const;
  void checkLengths() const;
  void checkRange(const Owner& owner, std::uint64_t first, std::uint64_t amount, Section section) const;
  void checkChild(const Owner& owner, std::uint32_t child, std::uint64_t least_node) const;
  std::vector<std::uint64_t> leafRowCounts() const;

  const unsigned char* bytes_;
  std::uint64_t size_;
  const Header header_;
  const std::string& name_;
};

void MapValidator::checkHeader() const {
  if (header_.parameters < 1 || header_.parameters > format::kMaxSignals) {
    fail("header: parameters must be 1 to 256, got " + std::to_string(header_.parameters));
  }
  if (header_.inputs < 1 || header_.inputs > format::kMaxSignals) {
    fail("header: inputs must be 1 to 256, got " + std::to_string(header_.inputs));
  }
  const std::size_t sections = format::sectionCount(header_.version);
  if (header_.section_count != sections) {
    fail("header: sections must be " + std::to_string(sections) + ", got " +
         std::to_string(header_.section_count));
  }
  if (!std::isfinite(header_.period) || header_.period < 0.0) {
    fail("header: period must be finite and not negative");
  }
  if (!(header_.tolerance >= 0.0 && header_.tolerance <= format::kMaxTolerance)) {
    std::ostringstream rule;
    rule << "header: tolerance must be 0 to " << format::kMaxTolerance << ", got " << header_.tolerance;
    fail(rule.str());
  }
  if (header_.first_fallback != 0) {
    fail(
        "header: has fallback regions, which `reduce --separate` of version 0.2 wrote; reduce the original "
        "map "
        "again");
  }
  checkZero(offsetof(Header, reserved), offsetof(Header, sections), "the reserved bytes of the header");
}

void MapValidator::checkSections() const {
  // The place of every section follows from the counts, so overlaps and gaps need no test of their own.
  std::uint64_t end = format::headerSize(header_.version);
  for (std::size_t i = 0; i < header_.section_count; ++i) {
    const format::SectionEntry& entry = header_.sections[i];
    const std::string section = std::string("section ") + kSectionNames[i];
    const std::uint64_t offset = format::alignUp(end);
    if (entry.offset != offset) {
      fail(section + ": must start at byte " + std::to_string(offset) + ", starts at " +
           std::to_string(entry.offset));
    }
    if (i != format::kText && entry.count > format::kMaxElements) fail(section + ": too many elements");
    const std::uint64_t element = format::elementSize(i, header_.parameters, header_.inputs);
    if (offset > size_ || entry.count > (size_ - offset) / element)
      fail(section + ": reaches beyond the end of the file");
    checkZero(end, offset, "the bytes before " + section);
    end = offset + entry.count * element;
  }
  if (format::alignUp(end) != size_) {
    fail("the sections end at byte " + std::to_string(end) + ", the file at " + std::to_string(size_));
  }
  checkZero(end, size_, "the bytes after the last section");
  if (count(format::kBounds) != std::uint64_t{header_.parameters} + header_.inputs) {
    fail("section bounds: must have one element for each parameter and input");
  }
}

void MapValidator::checkZero(std::uint64_t first, std::uint64_t end, const std::string& where) const {
  if (std::any_of(bytes_ + first, bytes_ + end, [](unsigned char byte) { return byte != 0; })) {
    fail(where + " must be zero");
  }
}

std::vector<std::string_view> MapValidator::checkText() const {
  const std::size_t expected = format::kTextCount + 2 * (std::size_t{header_.parameters} + header_.inputs);
  std::string_view rest(start<char>(format::kText), count(format::kText));
  std::vector<std::string_view> texts;
  texts.reserve(expected);
  while (!rest.empty()) {
    const std::size_t length = rest.find('\0');
    if (length == std::string_view::npos) fail("section text: the last string has no end");
    if (texts.size() == expected) fail("section text: more strings than " + std::to_string(expected));
    texts.push_back(rest.substr(0, length));
    rest.remove_prefix(length + 1);
  }
  if (texts.size() != expected) {
    fail("section text: must hold " + std::to_string(expected) + " strings, holds " +
         std::to_string(texts.size()));
  }
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (!isUtf8(texts[i])) fail("section text: " + at("string", i) + " is not UTF-8");
    const bool multi_line = i == format::kProblemText || i == format::kSolverNotes;
    if (!multi_line && hasControl(texts[i]))
      fail("section text: " + at("string", i) + " holds a control character");
  }
  return texts;
}

void MapValidator::checkSignalNames(const std::vector<std::string_view>& texts) const {
  const auto check = [&](const char* kind, std::size_t first, std::size_t amount) {
    for (std::size_t i = 0; i < amount; ++i) {
      const std::string_view name = texts[first + 2 * i];
      if (name.empty()) fail(at(kind, i) + ": has no name");
      for (std::size_t j = 0; j < i; ++j) {
        if (texts[first + 2 * j] == name) fail(at(kind, i) + ": name " + std::string(name) + " occurs twice");
      }
    }
  };
  check("parameter", format::kTextCount, header_.parameters);
  check("input", format::kTextCount + 2 * std::size_t{header_.parameters}, header_.inputs);
}

void MapValidator::checkNumbers() const {
  const std::uint64_t p = header_.parameters;
  const Bounds* const bounds = start<Bounds>(format::kBounds);
  for (std::uint64_t i = 0; i < count(format::kBounds); ++i) {
    const Bounds& b = bounds[i];
    const std::string signal = i < p ? at("parameter", i) : at("input", i - p);
    if (!(b.lower <= b.upper)) fail(signal + ": lower must not exceed upper");
    const double slack = header_.tolerance * (0.5 * b.upper - 0.5 * b.lower);
    if (i < p && !(std::isfinite(b.lower - slack) && std::isfinite(b.upper + slack))) {
      fail(signal + ": bounds must be finite, also when widened by the tolerance");
    }
    const double infinity = std::numeric_limits<double>::infinity();
    if (b.lower == infinity || b.upper == -infinity) fail(signal + ": no value lies between its bounds");
  }
  checkFinite(format::kPlanes, p + 1);
  checkLengths();
  checkFinite(format::kLaws, (p + 1) * header_.inputs);
  if (count(format::kLaws) == 0) fail("section laws: must not be empty");
}

void MapValidator::checkFinite(Section section, std::uint64_t numbers) const {
  const double* const values = start<double>(section);
  for (std::uint64_t i = 0; i < count(section) * numbers; ++i) {
    if (!std::isfinite(values[i])) {
      fail(std::string("section ") + at(kSectionNames[section], i / numbers) +
           ": holds a number that is not finite");
    }
  }
}

/// Only then are the tolerance, and all that is proven with it, distances.
void MapValidator::checkLengths() const {
  const std::uint64_t p = header_.parameters;
  const Bounds* const bounds = start<Bounds>(format::kBounds);
  const double* plane = start<double>(format::kPlanes);
  for (std::uint64_t i = 0; i < count(format::kPlanes); ++i, plane += p + 1) {
    double squared = 0.0;
    for (std::uint64_t k = 0; k < p; ++k) {
      const double scaled = plane[k] * (0.5 * bounds[k].upper - 0.5 * bounds[k].lower);
      squared += scaled * scaled;
    }
    if (!(std::abs(std::sqrt(squared) - 1.0) <= kMaxLengthError)) {
      std::ostringstream rule;
      rule << "section " << at("planes", i) << ": must have the length 1 in scaled parameters, has "
           << std::sqrt(squared);
      fail(rule.str());
    }
  }
}

void MapValidator::checkRange(const Owner& owner, std::uint64_t first, std::uint64_t amount,
                              Section section) const {
  if (first + amount > count(section))
    fail(owner + (std::string(": reaches beyond section ") + kSectionNames[section]));
}

void MapValidator::checkRegions() const {
  if (count(format::kRegions) == 0) fail("section regions: must not be empty");
  const Region* const regions = start<Region>(format::kRegions);
  for (std::uint64_t i = 0; i < count(format::kRegions); ++i) {
    const Region& region = regions[i];
    const Owner owner{"region", i};
    checkRange(owner, region.first_row, region.row_count, format::kRows);
    checkRange(owner, region.first_active, region.active_count, format::kActive);
    if (region.law >= count(format::kLaws))
      fail(owner + ": law " + std::to_string(region.law) + " does not exist");
  }
  const std::int32_t* const rows = start<std::int32_t>(format::kRows);
  const auto planes = static_cast<std::int64_t>(count(format::kPlanes));
  for (std::uint64_t i = 0; i < count(format::kRows); ++i) {
    const std::int64_t row = rows[i];
    if (row == 0 || row > planes || row < -planes) fail(at("row", i) + ": plane does not exist");
  }
  const std::int32_t* const active = start<std::int32_t>(format::kActive);
  for (std::uint64_t i = 0; i < count(format::kActive); ++i) {
    if (active[i] < 0) fail(at("active row", i) + ": must not be negative");
  }
}

void MapValidator::checkLeaves() const {
  if (count(format::kLeaves) == 0) fail("section leaves: must not be empty");
  const Leaf* const leaves = start<Leaf>(format::kLeaves);
  for (std::uint64_t i = 0; i < count(format::kLeaves); ++i) {
    checkRange({"leaf", i}, leaves[i].first, leaves[i].count, format::kCandidates);
  }
  const std::uint32_t* const candidates = start<std::uint32_t>(format::kCandidates);
  for (std::uint64_t i = 0; i < count(format::kCandidates); ++i) {
    if (candidates[i] >= count(format::kRegions)) fail(at("candidate", i) + ": region does not exist");
  }
}

/// One element for each candidate, with bits of rows that its region has.
void MapValidator::checkTests() const {
  if (count(format::kTests) == 0) return;
  if (count(format::kTests) != count(format::kCandidates))
    fail("section tests: must be empty, or have one element for each candidate");
  const auto* const candidates = start<std::uint32_t>(format::kCandidates);
  const auto* const tests = start<std::uint32_t>(format::kTests);
  const Region* const regions = start<Region>(format::kRegions);
  for (std::uint64_t i = 0; i < count(format::kTests); ++i) {
    const std::uint32_t rows = regions[candidates[i]].row_count;
    if (rows < 32 && tests[i] >> rows != 0) fail(at("test", i) + ": names a row that its region lacks");
  }
}

/// Half-spaces tested at each leaf if no candidate but the last holds theta.
std::vector<std::uint64_t> MapValidator::leafRowCounts() const {
  const Region* const regions = start<Region>(format::kRegions);
  const Leaf* const leaves = start<Leaf>(format::kLeaves);
  const std::uint32_t* const candidates = start<std::uint32_t>(format::kCandidates);
  // Leaves may overlap: running sums keep the time linear in the size of the file.
  std::vector<std::uint64_t> sums(count(format::kCandidates) + 1, 0);
  const auto* const tests = count(format::kTests) == 0 ? nullptr : start<std::uint32_t>(format::kTests);
  for (std::size_t i = 0; i + 1 < sums.size(); ++i) {
    const std::uint32_t all = regions[candidates[i]].row_count;
    sums[i + 1] = sums[i] + (tests == nullptr ? all : testedRows(tests[i], all));
  }
  std::vector<std::uint64_t> rows(count(format::kLeaves));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = sums[std::uint64_t{leaves[i].first} + leaves[i].count] - sums[leaves[i].first];
    if (rows[i] > std::numeric_limits<std::uint32_t>::max())
      fail(at("leaf", i) + ": more than 2^32 - 1 half-spaces");
  }
  return rows;
}

void MapValidator::checkChild(const Owner& owner, std::uint32_t child, std::uint64_t least_node) const {
  const std::uint32_t index = child & ~MapContent::kLeaf;
  if ((child & MapContent::kLeaf) != 0) {
    if (index >= count(format::kLeaves)) fail(owner + ": leaf " + std::to_string(index) + " does not exist");
  } else {
    if (index >= count(format::kNodes)) fail(owner + ": node " + std::to_string(index) + " does not exist");
    if (index < least_node) fail(owner + ": node " + std::to_string(index) + " must come after its parent");
  }
}

/// The greatest cost of the paths seen so far. [nodes, half-spaces]
struct MapValidator::Path {
  std::uint64_t depth = 0;
  std::uint64_t checks = 0;
  std::uint64_t both = 0;

  void end(std::uint64_t nodes, std::uint64_t rows) {
    depth = std::max(depth, nodes);
    checks = std::max(checks, rows);
    both = std::max(both, nodes + rows);
  }
};

LookupCost MapValidator::checkTree() const {
  constexpr std::uint32_t kUnreached = 0;
  const std::vector<std::uint64_t> leaf_rows = leafRowCounts();
  const Node* const nodes = start<Node>(format::kNodes);
  // Nodes on the path down to and including each node.
  std::vector<std::uint32_t> level(count(format::kNodes), kUnreached);
  Path path;
  const auto visit = [&](const Owner& owner, std::uint32_t child, std::uint64_t least_node,
                         std::uint32_t nodes_above) {
    checkChild(owner, child, least_node);
    const std::uint32_t index = child & ~MapContent::kLeaf;
    if ((child & MapContent::kLeaf) != 0) {
      path.end(nodes_above, leaf_rows[index]);
    } else {
      if (level[index] != kUnreached) fail(owner + ": node " + std::to_string(index) + " has another parent");
      level[index] = nodes_above + 1;
    }
  };
  visit({"root", 0}, header_.root, 0, 0);
  // Children follow their parent, so one pass meets every node after the one that leads to it.
  for (std::uint64_t i = 0; i < count(format::kNodes); ++i) {
    const Owner owner{"node", i};
    if (nodes[i].plane >= count(format::kPlanes)) fail(owner + ": plane does not exist");
    if (level[i] == kUnreached) fail(owner + ": cannot be reached from the root");
    visit(owner, nodes[i].below, i + 1, level[i]);
    visit(owner, nodes[i].above, i + 1, level[i]);
  }
  LookupCost cost;
  const std::uint64_t p = header_.parameters;
  cost.depth = static_cast<std::uint32_t>(path.depth);
  cost.region_checks = static_cast<std::uint32_t>(path.checks);
  cost.multiply_adds = path.both * p + header_.inputs * p;
  return cost;
}

}  // namespace

void checkHead(const void* head, std::uint64_t size, const std::string& name) {
  constexpr std::uint64_t kMagicSize = sizeof(format::kMagic);
  const auto* const bytes = static_cast<const unsigned char*>(head);
  if (size >= kMagicSize &&
      std::all_of(bytes, bytes + kMagicSize, [](unsigned char byte) { return byte == 0; })) {
    refuse(name, "is unfinished: its writer was stopped");
  }
  if (std::memcmp(head, format::kMagic, std::min(size, kMagicSize)) != 0) refuse(name, "is not a region map");
  if (size < format::kFirstHeader) {
    refuse(name, "is cut off: " + std::to_string(size) + " bytes are less than a header of 256");
  }
  Header header = {};
  std::memcpy(&header, head, format::kFirstHeader);
  if (header.byte_order != format::kByteOrder) {
    refuse(name, "header: byte order mark is wrong: a damaged file, or a machine that is not little-endian");
  }
  if (header.version < format::kFirstVersion || header.version > format::kVersion) {
    refuse(name,
           "has format version " + std::to_string(header.version) + ", this program reads versions 1 and 2");
  }
  if (size < format::headerSize(header.version)) {
    refuse(name, "is cut off: " + std::to_string(size) + " bytes are less than a header of " +
                     std::to_string(format::headerSize(header.version)));
  }
  if (header.file_size != size) {
    const char* const verdict = size < header.file_size ? "is cut off: " : "is too long: ";
    refuse(name,
           verdict + std::to_string(size) + " bytes, the header says " + std::to_string(header.file_size));
  }
}

void checkSum(const void* data, std::size_t size, const std::string& name) {
  if (format::readHeader(data).checksum != format::checksum(data, size))
    refuse(name, "is damaged: the checksum does not match");
}

MapFacts checkStructure(const void* data, std::size_t size, const std::string& name) {
  const MapValidator examiner(data, size, name);
  MapFacts facts;
  examiner.checkHeader();
  examiner.checkSections();
  facts.texts = examiner.checkText();
  examiner.checkSignalNames(facts.texts);
  examiner.checkNumbers();
  examiner.checkRegions();
  examiner.checkLeaves();
  examiner.checkTests();
  facts.cost = examiner.checkTree();
  return facts;
}

void checkCost(const Header& header, const LookupCost& cost, const std::string& name) {
  if (header.depth != cost.depth || header.region_checks != cost.region_checks ||
      header.multiply_adds != cost.multiply_adds) {
    refuse(name, "header: the cost does not agree with the tree");
  }
}

}  // namespace polyfly
