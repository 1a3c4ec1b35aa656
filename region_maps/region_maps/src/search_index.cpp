#include "search_index.hpp"

#include <algorithm>
#include <cmath>

#include "region_maps/format.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// Unit of coefficients and parameters. Products are in units of its square.
constexpr double kUnit = 0x1p14;
// Upper bound of all roundings of doubles, relative to the numbers added.
constexpr double kArithmetic = 0x1p-44;
// Upper bound of all roundings of doubles and the tolerance together, relative to a plane's norm.
constexpr double kSlack = 0x1p-18;
static_assert(format::kMaxTolerance <= 0.5 * kSlack);
// Greatest parameter, relative to its bound: it may lie beyond by the tolerance.
constexpr double kEnlarged = 1.001;
// A constant that no products outweigh.
constexpr std::int32_t kFar = 1 << 30;
constexpr std::uint32_t kNowhere = ~std::uint32_t{0};

/// Bound of the rounding, in units of products: p coefficients off by half a unit each, times parameters of
/// at most a little more than kUnit; parameters off by half a unit each, times coefficients of Euclidean norm
/// kUnit; and the slack.
std::int32_t marginFor(std::uint32_t p) {
  const double n = p;
  const double rounding = kEnlarged * 0.5 * kUnit * (n + std::sqrt(n)) + n;
  return static_cast<std::int32_t>(std::ceil(rounding + kSlack * kUnit * kUnit + 2.0));
}

std::uint32_t groupCount(const RegionView& region) {
  return static_cast<std::uint32_t>((std::uint64_t{region.row_count} + SearchIndex::kRowLanes - 1) /
                                    SearchIndex::kRowLanes);
}

/// Groups that hold tested rows.
std::uint32_t testedGroups(const RegionView& region, std::uint32_t tests) {
  std::uint32_t count = 0;
  for (std::uint32_t g = 0; g < groupCount(region); ++g) count += SearchIndex::testedLanes(tests, g) != 0;
  return count;
}

bool isLeaf(std::uint32_t child) { return (child & MapContent::kLeaf) != 0; }

}  // namespace

class SearchIndex::Builder {
 public:
  Builder(const RegionMap& map, SearchIndex& index)
      : map_(map),
        index_(index),
        p_(static_cast<std::uint32_t>(map.parameters().size())),
        pairs_(pairs(p_)) {}

  void run() {
    if (p_ > kMostParameters) return;
    numberBlocks();
    if (!fits()) return;
    scaleParameters();
    addRegions();
    addLeaves();
    addBlocks();
  }

 private:
  /// A plane in 16 bits.
  struct Rounded {
    std::array<std::int32_t, kMostParameters / 2> pairs{};
    std::int32_t constant = 0;
  };

  /// Which nodes begin a block: so that there are as few blocks as possible.
  void numberBlocks() {
    const std::size_t count = map_.nodeCount();
    fewest_.resize(count);
    for (std::size_t i = count; i-- > 0;) {  // a node comes before its children
      Fewest& fewest = fewest_[i];
      fewest[0] = 1 + fewestBelow(i, kLevels - 1);
      for (std::size_t left = 1; left < kLevels; ++left) {
        fewest[left] = std::min(fewest[0], fewestBelow(i, left - 1));
      }
    }
    std::vector<unsigned char> left(count, 0);  // levels that the parent's block has for the node
    block_.assign(count, kNowhere);
    for (std::size_t i = 0; i < count; ++i) {
      const bool begins = left[i] == 0 || fewest_[i][0] < fewestBelow(i, left[i] - 1u);
      if (begins) block_[i] = static_cast<std::uint32_t>(index_.block_count_++);
      for (const std::uint32_t child : {map_.node(i).below, map_.node(i).above}) {
        if (!isLeaf(child)) left[child] = static_cast<unsigned char>(begins ? kLevels - 1 : left[i] - 1u);
      }
    }
    std::vector<Fewest>().swap(fewest_);
  }

  /// Blocks that hold all below a node of whose block so many levels are left.
  std::uint32_t fewestBelow(std::size_t node, std::size_t left) const {
    std::uint32_t sum = 0;
    for (const std::uint32_t child : {map_.node(node).below, map_.node(node).above}) {
      if (!isLeaf(child)) sum += fewest_[child][left];
    }
    return sum;
  }

  bool fits() {
    // Ranges of rows and candidates may overlap in a file, here they do not.
    const std::size_t limit = std::min(kMostBytes, kMostBytesPerByte * map_.bytes()) / sizeof(std::int32_t);
    std::size_t words = index_.block_count_ * blockWords(p_);
    for (std::size_t i = 0; i < map_.regionCount() && words <= limit; ++i) {
      words += kHead + std::size_t{groupCount(map_.region(i))} * groupWords(p_);
    }
    for (std::size_t i = 0; i < map_.leafCount() && words <= limit; ++i) {
      words += 2 * std::max<std::size_t>(map_.leaf(i).count, 1);
    }
    if (words > limit) index_.block_count_ = 0;
    return words <= limit;
  }

  void scaleParameters() {
    View& view = index_.view_;
    for (std::size_t i = 0; i < p_; ++i) {
      const Signal& signal = map_.parameters()[i];
      half_[i] = 0.5 * signal.upper - 0.5 * signal.lower;
      greatest_[i] = kEnlarged * std::max(std::abs(signal.lower), std::abs(signal.upper)) + half_[i];
      view.centre[i] = signal.lower + half_[i];
      const double gain = kUnit / half_[i];
      view.gain[i] = std::isfinite(gain) ? gain : 0.0;
    }
    view.margin = marginFor(p_);
  }

  /// All zero, so never decided, where rounding could do more than the margin says.
  Rounded rounded(const double* plane, bool negated) const {
    const View& view = index_.view_;
    std::array<double, kMostParameters> a{};
    double c = plane[p_];
    double noise = std::abs(plane[p_]);
    double square = 0.0;
    for (std::size_t i = 0; i < p_; ++i) {
      c -= plane[i] * view.centre[i];
      noise += std::abs(plane[i]) * greatest_[i];
      if (view.gain[i] > 0.0) a[i] = plane[i] * (kUnit / view.gain[i]);
      square += a[i] * a[i];
    }
    noise *= kArithmetic;
    for (std::size_t i = 0; i < p_; ++i) {
      if (!(view.gain[i] > 0.0)) noise += std::abs(plane[i]) * kEnlarged * half_[i];
    }
    const double norm = std::sqrt(square);
    if (!(std::isnormal(square) && map_.tolerance() + noise <= kSlack * norm)) return {};
    const double scale = (negated ? -kUnit : kUnit) / norm;
    // No plane that is farther away crosses the box; clamped, it still does not.
    const double reach = 1.1 * kUnit * kUnit * std::sqrt(static_cast<double>(p_));
    Rounded result;
    result.constant = static_cast<std::int32_t>(std::lround(std::clamp(c * scale * kUnit, -reach, reach)));
    for (std::size_t i = 0; i < p_; ++i) {
      const auto half = static_cast<std::uint32_t>(std::lround(-a[i] * scale)) & 0xffffu;
      result.pairs[i / 2] |= static_cast<std::int32_t>(half << 16 * (i % 2));
    }
    return result;
  }

  void place(const Rounded& plane, std::int32_t shift, std::int32_t* words, std::uint32_t lanes) const {
    for (std::size_t k = 0; k < pairs_; ++k) words[k * lanes] = plane.pairs[k];
    words[pairs_ * lanes] = plane.constant + shift;
  }

  static std::int32_t* words(std::vector<Line>& lines) {
    return reinterpret_cast<std::int32_t*>(lines.data());
  }

  static std::vector<Line> linesFor(std::size_t words) {
    constexpr std::size_t kWords = sizeof(Line) / sizeof(std::int32_t);
    return std::vector<Line>((words + kWords - 1) / kWords, Line{});
  }

  /// Each region's rows in groups, less the margin; and after them one that holds nothing, for empty leaves.
  void addRegions() {
    std::size_t size = kHead + groupWords(p_);
    for (std::size_t i = 0; i < map_.regionCount(); ++i)
      size += kHead + std::size_t{groupCount(map_.region(i))} * groupWords(p_);
    index_.records_ = linesFor(size);
    std::int32_t* const start = words(index_.records_);
    index_.view_.records = start;
    std::int32_t* record = start;
    for (std::size_t i = 0; i < map_.regionCount(); ++i) {
      record_.push_back(static_cast<std::uint32_t>((record - start) / kHead));
      record = addRegion(i, record);
    }
    record_.push_back(static_cast<std::uint32_t>((record - start) / kHead));
    record[2] = 1;
    std::fill_n(record + kHead + pairs_ * kRowLanes, kRowLanes, -kFar);
  }

  std::int32_t* addRegion(std::size_t number, std::int32_t* record) const {
    const RegionView region = map_.region(number);
    const std::uint32_t groups = groupCount(region);
    record[0] = static_cast<std::int32_t>(number);
    record[1] = static_cast<std::int32_t>(region.law);
    record[2] = static_cast<std::int32_t>(groups);
    record[3] = static_cast<std::int32_t>(region.first_row);
    record += kHead;
    for (std::size_t i = 0; i < std::size_t{groups} * kRowLanes; ++i) {
      std::int32_t* const lane = record + i / kRowLanes * groupWords(p_) + i % kRowLanes;
      if (i < region.row_count) {
        const std::int32_t row = region.rows[i];
        const std::size_t plane = static_cast<std::size_t>(row < 0 ? -row : row) - 1;
        place(rounded(map_.plane(plane), row < 0), -index_.view_.margin, lane, kRowLanes);
      } else {
        lane[pairs_ * kRowLanes] = kFar;  // holds anywhere
      }
    }
    return record + std::size_t{groups} * groupWords(p_);
  }

  void addLeaves() {
    std::vector<Candidate>& candidates = index_.candidates_;
    for (std::size_t i = 0; i < map_.leafCount(); ++i) {
      const LeafView leaf = map_.leaf(i);
      first_.push_back(static_cast<std::uint32_t>(candidates.size()));
      groups_.push_back(leaf.count == 0 ? 1 : 0);
      for (std::uint32_t k = 0; k < leaf.count; ++k) {
        candidates.push_back({record_[leaf.candidates[k]], leaf.testsOf(k)});
        groups_.back() += testedGroups(map_.region(leaf.candidates[k]), leaf.testsOf(k));
      }
      if (leaf.count == 0) candidates.push_back({record_.back(), MapContent::kAllRows});
      candidates.back().record |= kLast;
    }
    index_.view_.candidates = candidates.data();
  }

  void addBlocks() {
    index_.blocks_ = linesFor(index_.block_count_ * blockWords(p_));
    std::int32_t* const start = words(index_.blocks_);
    index_.view_.blocks = start;
    std::vector<std::uint32_t> above(index_.block_count_, 0);  // blocks on the path to each
    index_.view_.root = refer(map_.root(), 0, above);
    for (std::size_t i = 0; i < block_.size(); ++i) {  // a node comes after its parent
      if (block_[i] != kNowhere) addBlock(static_cast<std::uint32_t>(i), start, above);
    }
  }

  void addBlock(std::uint32_t node, std::int32_t* start, std::vector<std::uint32_t>& above) {
    constexpr std::uint32_t kPlanes = kChildren - 1;
    const std::uint32_t number = block_[node];
    std::int32_t* const block = start + number * std::size_t{blockWords(p_)};
    std::int32_t* const constants = block + pairs_ * kChildren;
    // Children in the file. Those of lane i are at 2 i + 1 and 2 i + 2.
    std::array<std::uint32_t, kPlanes + kChildren> children;
    children[0] = node;
    for (std::uint32_t lane = 0; lane < kPlanes; ++lane) {
      const std::uint32_t child = children[lane];
      if (child == kNowhere || isLeaf(child) || (lane > 0 && block_[child] != kNowhere)) {
        constants[lane] = kFar;  // a path that ended goes on below
        children[2 * lane + 1] = child;
        children[2 * lane + 2] = kNowhere;
      } else {
        place(rounded(map_.plane(map_.node(child).plane), false), -index_.view_.margin, block + lane,
              kChildren);
        block[kPlanes] |= 1 << lane;
        children[2 * lane + 1] = map_.node(child).below;
        children[2 * lane + 2] = map_.node(child).above;
      }
    }
    constants[kPlanes] = static_cast<std::int32_t>(node);
    for (std::uint32_t i = 0; i < kChildren; ++i) {
      const std::uint32_t child = children[kPlanes + i];
      if (child == kNowhere) continue;
      constants[kChildren + i] = static_cast<std::int32_t>(refer(child, above[number] + 1, above));
    }
  }

  /// What leads to a child of the file that has so many blocks above it.
  std::uint32_t refer(std::uint32_t child, std::uint32_t blocks, std::vector<std::uint32_t>& above) {
    if (!isLeaf(child)) {
      above[block_[child]] = blocks;
      return block_[child];
    }
    const std::uint32_t leaf = child & ~MapContent::kLeaf;
    const std::uint64_t lanes = std::uint64_t{blocks} * kChildren + groups_[leaf] * kRowLanes;
    index_.multiply_adds_ = std::max(index_.multiply_adds_, 2 * pairs_ * lanes);
    return first_[leaf] | kLeaf;
  }

  const RegionMap& map_;
  SearchIndex& index_;
  const std::uint32_t p_;
  const std::uint32_t pairs_;
  std::array<double, kMostParameters> half_{};
  std::array<double, kMostParameters> greatest_{};
  /// Blocks that hold a node and all below, when so many levels of its parent's block are left for it.
  using Fewest = std::array<std::uint32_t, kLevels>;

  std::vector<Fewest> fewest_;
  // Block of each node that begins one.
  std::vector<std::uint32_t> block_;
  // Record of each region, and of the empty one.
  std::vector<std::uint32_t> record_;  // [kHead words]
  // First candidate of each leaf.
  std::vector<std::uint32_t> first_;
  // Number of groups of all candidates of each leaf.
  std::vector<std::uint64_t> groups_;
};

SearchIndex::SearchIndex(const RegionMap& map) { Builder(map, *this).run(); }

std::size_t SearchIndex::bytes() const noexcept {
  return (blocks_.size() + records_.size()) * sizeof(Line) + candidates_.size() * sizeof(candidates_[0]);
}

}  // namespace polyfly
