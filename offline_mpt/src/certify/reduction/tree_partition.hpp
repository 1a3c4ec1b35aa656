#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "exact_kkt/exact_ranges.hpp"
#include "exact_kkt/exact_region.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

class RegionMap;

/// A map's half-spaces without rounding, in t, theta = centre + half .* t: row (t, 1) >= 0.
class ExactMap {
 public:
  /// The map must outlive the object. Planes that `other`, of the same slack, tolerance and ranges, has too become
  /// its rows, so that they are known to be the same.
  ExactMap(const RegionMap& map, double slack, const ExactMap* other = nullptr);

  /// The same where t is [-1, 1] in other ranges than the map's: lower and upper of `ranges` count.
  ExactMap(const RegionMap& map, double slack, const std::vector<Signal>& ranges, const ExactMap* other);

  const ExactRow& row(std::int32_t row) const { return at(row, kRow); }
  /// The row moved outwards by the slack, in the measure of FORMAT.md.
  const ExactRow& relaxed(std::int32_t row) const { return at(row, kRelaxed); }
  /// The opposite of the relaxed row.
  const ExactRow& outside(std::int32_t row) const { return at(row, kOutside); }

  const RegionMap& map() const { return map_; }
  int p() const;
  Eigen::VectorXd theta(const std::vector<Rational>& t) const { return ranges_.theta(t); }  ///< rounded

 private:
  enum Variant : std::size_t { kRow, kRelaxed, kOutside, kVariants };
  // Variants of the row, then of its opposite.
  using PlaneRows = std::array<ExactRow, 2 * kVariants>;
  const ExactRow& at(std::int32_t row, Variant variant) const;
  PlaneRows makeRows(const double* plane, double slack) const;

  const RegionMap& map_;
  ExactRanges ranges_;
  // Rows of each plane.
  std::vector<std::shared_ptr<const PlaneRows>> rows_;
};

/// The row value (t, 1) >= 0, in whole numbers.
ExactRow wholeRow(const std::vector<Rational>& value);

/// A polytope with a point strictly inside; or one that may have no interior, with a point that is off by
/// rounding at most.
struct ExactCell {
  std::vector<const ExactRow*> rows;
  std::vector<Rational> point;
  /// Whether the point is known to lie strictly inside.
  bool certain = true;
};

/// Cuts of a proof are nested less deeply. The checker refuses others.
constexpr int kDeepestCuts = 2000;

/// What cutting leaves behind: how many parts were looked at and, where it is wanted, the proof in the words
/// of CERTIFICATE.md.
class ProofWriter {
 public:
  ProofWriter() = default;
  /// A proof is wanted of `subject`, which errors begin with.
  explicit ProofWriter(std::string subject) : wanted_(true), subject_(std::move(subject)) {}

  /// While it lives, what is written is one cut deeper. Throws Error where a certificate may not be as deep.
  class Nested {
   public:
    explicit Nested(ProofWriter& log);
    ~Nested() { --log_.depth_; }
    Nested(const Nested&) = delete;
    Nested& operator=(const Nested&) = delete;

   private:
    ProofWriter& log_;
  };

  void countPart() { ++parts_; }
  void word(char word);
  void word(char word, std::uint64_t number);
  /// `word`, and a proof that no point has all rows > 0 in the box. There must be none.
  void empty(char word, const std::vector<const ExactRow*>& rows, int p);

  std::uint64_t parts() const { return parts_; }
  std::string takeText() { return std::move(text_); }

 private:
  bool wanted_ = false;
  std::string subject_;
  int depth_ = 0;
  std::uint64_t parts_ = 0;
  std::string text_;
};

/// The cell of a region, and within `sides`; false when it has no interior.
bool cellOf(const ExactMap& map, std::uint32_t region, ExactCell& cell,
            const std::deque<ExactRow>& sides = {});

/// Finds a point strictly inside; false when there is none.
bool makeCertain(const ExactMap& map, ExactCell& cell);

/// Calls `visit` with every part of the cell that the map's tree leads to a leaf, until it returns false.
/// Parts without interior may be left out: they belong to the closure of the others. False when stopped.
/// `leaf` is its index in the map.
using LeafVisit = std::function<bool(std::uint32_t leaf, const ExactCell& part)>;
bool dissect(const ExactMap& map, const ExactCell& cell, const LeafVisit& visit, ProofWriter& log);

/// Whose regions cut.
enum class CutBy : char {
  kOriginal = 'N',
  /// Regions of the reduced map.
  kCandidate = 'C',
};

/// Calls `visit` with every part of the cell that lies in none of the map's regions, their rows relaxed,
/// until it returns false. Each has a point strictly inside, unless it is uncertain. False when stopped.
using RestVisit = std::function<bool(const ExactCell& rest)>;
bool subtract(const ExactMap& map, const ExactCell& cell, const std::vector<std::uint32_t>& regions, CutBy by,
              const RestVisit& visit, ProofWriter& log);

}  // namespace polyfly
