#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "region_maps/lookup.hpp"
#include "region_maps/map_content.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

/// A critical region as it lies in the file. Pointers live as long as the map.
struct RegionView {
  /// Rows of the region, see MapContent::rows.
  const std::int32_t* rows = nullptr;
  std::uint32_t row_count = 0;
  const std::int32_t* active = nullptr;
  std::uint32_t active_count = 0;
  std::uint32_t law = 0;
  /// Index of the first row among all rows of the file.
  std::uint32_t first_row = 0;
};

/// The regions that may hold a parameter at a leaf of the search tree, in the order in which they are tested.
struct LeafView {
  const std::uint32_t* candidates = nullptr;
  /// Per candidate the rows that are tested, see MapContent::tests. nullptr: all rows of each.
  const std::uint32_t* tests = nullptr;
  std::uint32_t count = 0;

  std::uint32_t testsOf(std::uint32_t i) const noexcept {
    return tests == nullptr ? MapContent::kAllRows : tests[i];
  }
};

/// For RegionMap::open [bytes]: no limit, and the largest map that a node flies. Three such maps in force and three to
/// come take at most 1.5 GiB.
constexpr std::uint64_t kAnySize = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kGreatestFlownMap = std::uint64_t{256} << 20;

/// A region map file in memory. Look-ups read its bytes as they lie in the file. Opening checks the whole file once: sizes, alignment, every index, finiteness,
/// checksum. It throws polyfly::Error with the file and the rule that it breaks. Afterwards a look-up only tests its
/// own input. Look-ups allocate nothing and may run concurrently. Moves, does not copy; a map that was moved from may
/// only be assigned to or destroyed.
class RegionMap {
 public:
  /// Reads the file once into memory. What happens to the file afterwards does not reach the map. A file of more than
  /// `most_bytes` is refused before memory is taken for it. Throws Error.
  static RegionMap open(const std::string& path, std::uint64_t most_bytes = kAnySize);

  /// Reads `size` bytes at `data`, which must be 64-byte aligned and outlive the map; `name` is used
  /// in errors. Throws Error.
  static RegionMap view(const void* data, std::size_t size, const std::string& name);

  RegionMap(RegionMap&& other) noexcept;
  RegionMap& operator=(RegionMap&& other) noexcept;
  ~RegionMap();

  const std::string& path() const noexcept;
  std::string_view name() const noexcept;
  std::string_view problemText() const noexcept;
  std::string_view problemKind() const noexcept;
  std::string_view solverStatus() const noexcept;
  std::string_view solverNotes() const noexcept;
  double period() const noexcept;
  double tolerance() const noexcept;
  const std::vector<Signal>& parameters() const noexcept;
  const std::vector<Signal>& inputs() const noexcept;
  const LookupCost& cost() const noexcept;

  std::size_t regionCount() const noexcept;
  std::size_t lawCount() const noexcept;
  std::size_t planeCount() const noexcept;
  std::size_t nodeCount() const noexcept;
  std::size_t leafCount() const noexcept;
  std::size_t bytes() const noexcept;
  /// The bytes of the whole file.
  std::string_view file() const noexcept;
  std::uint32_t formatVersion() const noexcept;
  /// Checksum of the whole file, as in its header.
  std::uint64_t checksum() const noexcept;

  /// Checksum of the map that this one was reduced from, or 0.
  std::uint64_t reducedFrom() const noexcept;

  RegionView region(std::size_t index) const noexcept;
  const double* plane(std::size_t index) const noexcept;  ///< p + 1 numbers
  const double* law(std::size_t index) const noexcept;    ///< m rows of p + 1 numbers

  /// The root as a child, see MapContent::Node.
  std::uint32_t root() const noexcept;
  const MapContent::Node& node(std::size_t index) const noexcept;
  LeafView leaf(std::size_t index) const noexcept;

  /// Region that holds theta (p numbers), by the search tree: FORMAT.md, "Point location".
  Lookup locate(const double* theta) const noexcept;

  /// As locate, and writes u = K theta + k (m numbers) when the status is kInside; u is left alone otherwise.
  Lookup evaluate(const double* theta, double* u) const noexcept;

  /// As `locate`, testing all regions in file order: its reference.
  Lookup locateExhaustively(const double* theta) const noexcept;

  /// Whether theta lies in region `index` within the map's tolerance.
  bool contains(std::size_t index, const double* theta) const noexcept;

 private:
  /// The checked file, and what look-ups read.
  struct Loaded;

  explicit RegionMap(std::unique_ptr<Loaded> loaded) noexcept;
  static RegionMap load(std::unique_ptr<Loaded> loaded, std::size_t size);

  std::unique_ptr<Loaded> loaded_;
};

}  // namespace polyfly
