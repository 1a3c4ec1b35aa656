#include "offline_mpt/encode.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <sstream>

#include "polyfly_base/error.hpp"
#include "region_maps/format.hpp"
#include "support/vector_text.hpp"
#include "tree/row_order.hpp"
#include "tree/tolerances.hpp"

namespace polyfly {
namespace {

/// Groups equal vectors of `width` numbers. Sorted by a fixed projection, equal vectors stand close together.
class Deduplicator {
 public:
  using Agree = std::function<bool(const double* one, const double* other)>;

  /// Vectors that `agree` refuses are not equal either.
  Deduplicator(const std::vector<double>& vectors, std::size_t width, double tolerance,
               const Agree& agree = {})
      : index_(vectors.size() / width) {
    const std::size_t count = index_.size();
    std::vector<double> key(count, 0.0);
    double weight_sum = 0.0;
    for (std::size_t j = 0; j < width; ++j) {
      const double weight = 1.0 / (1.0 + 0.37 * static_cast<double>(j));
      weight_sum += weight;
      for (std::size_t i = 0; i < count; ++i) key[i] += weight * vectors[i * width + j];
    }
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
    const double window = weight_sum * tolerance;
    std::vector<std::size_t> heads(count);  // representative of each vector
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = order[k];
      heads[i] = i;
      for (std::size_t back = k; back-- > 0 && key[i] - key[order[back]] <= window;) {
        const std::size_t other = heads[order[back]];
        if (close(vectors, width, i, other, tolerance) &&
            (!agree || agree(&vectors[i * width], &vectors[other * width]))) {
          heads[i] = other;
          break;
        }
      }
    }
    number(heads);
  }

  const std::vector<std::uint32_t>& index() const { return index_; }          ///< group of each vector
  const std::vector<std::size_t>& representatives() const { return first_; }  ///< a vector of each group

 private:
  static bool close(const std::vector<double>& v, std::size_t width, std::size_t a, std::size_t b,
                    double tolerance) {
    for (std::size_t j = 0; j < width; ++j) {
      if (std::abs(v[a * width + j] - v[b * width + j]) > tolerance) return false;
    }
    return true;
  }

  void number(const std::vector<std::size_t>& heads) {
    std::vector<std::uint32_t> group(heads.size(), 0);
    for (std::size_t i = 0; i < heads.size(); ++i) {
      if (heads[i] != i) continue;
      group[i] = static_cast<std::uint32_t>(first_.size());
      first_.push_back(i);
    }
    for (std::size_t i = 0; i < heads.size(); ++i) index_[i] = group[heads[i]];
  }

  std::vector<std::uint32_t> index_;
  std::vector<std::size_t> first_;
};

/// theta = centre + half .* t
struct Scaling {
  explicit Scaling(const ParametricProgram& program) {
    for (const Signal& signal : program.parameters) {
      centre.push_back(0.5 * (signal.lower + signal.upper));
      half.push_back(0.5 * (signal.upper - signal.lower));
    }
  }
  std::vector<double> centre;
  std::vector<double> half;
};

/// All half-spaces of all regions in scaled parameters, as unit planes whose first large entry is positive.
struct Planes {
  std::vector<double> planes;
  std::vector<char> negated;
};

Planes collectPlanes(const Partition& partition, const Scaling& scaling) {
  const std::size_t p = scaling.half.size();
  Planes out;
  std::vector<double> row(p + 1);
  for (const CriticalRegion& region : partition.regions) {
    for (Eigen::Index f = 0; f < region.G.rows(); ++f) {
      row[p] = region.g(f);
      double squared = 0.0;
      for (std::size_t j = 0; j < p; ++j) {
        row[j] = region.G(f, static_cast<Eigen::Index>(j)) * scaling.half[j];
        row[p] -= region.G(f, static_cast<Eigen::Index>(j)) * scaling.centre[j];
        squared += row[j] * row[j];
      }
      const auto leading = std::find_if(row.begin(), row.end(),
                                        [](double a) { return std::abs(a) > tolerance::kLeadingEntry; });
      const bool negate = leading != row.end() && *leading < 0.0;
      const double factor = (negate ? -1.0 : 1.0) / std::sqrt(squared);
      for (const double value : row) out.planes.push_back(factor * value);
      out.negated.push_back(negate ? 1 : 0);
    }
  }
  return out;
}

void addPlanes(const Partition& partition, const Scaling& scaling, MapContent& content, TreeRegions& tree) {
  const std::size_t p = scaling.half.size();
  const Planes all = collectPlanes(partition, scaling);
  const double same = partition.near_rows.empty() ? tolerance::kSamePlane : tolerance::kSamePlaneOfNearRows;
  const Deduplicator sharing(all.planes, p + 1, same);
  for (const std::size_t i : sharing.representatives()) {
    double bound = all.planes[i * (p + 1) + p];
    for (std::size_t j = 0; j < p; ++j) {
      const double a = all.planes[i * (p + 1) + j];
      tree.planes.push_back(a);
      content.planes.push_back(a / scaling.half[j]);
      bound += a / scaling.half[j] * scaling.centre[j];
    }
    tree.planes.push_back(all.planes[i * (p + 1) + p]);
    content.planes.push_back(bound);
  }
  std::size_t next = 0;
  for (const CriticalRegion& region : partition.regions) {
    MapContent::Region entry;
    entry.first_row = static_cast<std::uint32_t>(content.rows.size());
    entry.row_count = static_cast<std::uint32_t>(region.G.rows());
    std::vector<std::int32_t> rows;
    for (Eigen::Index f = 0; f < region.G.rows(); ++f, ++next) {
      const auto plane = static_cast<std::int32_t>(sharing.index()[next]) + 1;
      rows.push_back(all.negated[next] ? -plane : plane);
    }
    content.rows.insert(content.rows.end(), rows.begin(), rows.end());
    tree.rows.push_back(std::move(rows));
    for (std::size_t j = 0; j < p; ++j) {
      tree.centres.push_back((region.centre(static_cast<Eigen::Index>(j)) - scaling.centre[j]) /
                             scaling.half[j]);
    }
    entry.first_active = static_cast<std::uint32_t>(content.active.size());
    entry.active_count = static_cast<std::uint32_t>(region.active.size());
    content.active.insert(content.active.end(), region.active.begin(), region.active.end());
    content.regions.push_back(entry);
  }
}

/// The laws of all regions: as they are written, and as they are compared, in scaled parameters.
struct Laws {
  std::vector<double> written;
  std::vector<double> scaled;
  Eigen::VectorXd outputs;  // greatest |u| at the regions' centres
};

Laws collectLaws(const Partition& partition, const Scaling& scaling, Eigen::Index outputs) {
  const auto p = static_cast<Eigen::Index>(scaling.half.size());
  Laws laws;
  laws.outputs = Eigen::VectorXd::Zero(outputs);
  for (const CriticalRegion& region : partition.regions) {
    laws.outputs = laws.outputs.cwiseMax((region.K * region.centre + region.k).cwiseAbs());
    for (Eigen::Index i = 0; i < outputs; ++i) {
      double constant = region.k(i);
      for (Eigen::Index j = 0; j < p; ++j) {
        const double gain = region.K(i, j);
        laws.written.push_back(gain);
        laws.scaled.push_back(gain * scaling.half[static_cast<std::size_t>(j)]);
        constant += gain * scaling.centre[static_cast<std::size_t>(j)];
      }
      laws.written.push_back(region.k(i));
      laws.scaled.push_back(constant);
    }
  }
  return laws;
}

/// Whether each output of two laws is the same in the whole box within tolerance::kSharedLaw, relative to its own |u|, or
/// to that of all laws where they are less than 1.
bool agreeInBox(const double* law, const double* other, std::size_t width, const Eigen::VectorXd& outputs) {
  for (Eigen::Index i = 0; i < outputs.size(); ++i, law += width, other += width) {
    double difference = 0.0, size = 0.0;
    for (std::size_t j = 0; j < width; ++j) {
      difference += std::abs(law[j] - other[j]);
      size += std::abs(law[j]);
    }
    if (difference > tolerance::kSharedLaw * std::max(std::min(1.0, outputs(i)), size)) return false;
  }
  return true;
}

void addLaws(const Partition& partition, const Scaling& scaling, MapContent& content) {
  const std::size_t width = content.inputs.size() * (scaling.half.size() + 1);
  const Laws laws = collectLaws(partition, scaling, static_cast<Eigen::Index>(content.inputs.size()));
  const std::size_t outputs = content.inputs.size();
  // not relative to the laws: beside the steepest of them, a saturated one would pass for constant
  const Deduplicator sharing(laws.scaled, width, kSameLaw * laws.outputs.maxCoeff(),
                             [&](const double* law, const double* other) {
                               return agreeInBox(law, other, width / outputs, laws.outputs);
                             });
  for (const std::size_t i : sharing.representatives()) {
    const auto first = laws.written.begin() + static_cast<std::ptrdiff_t>(i * width);
    content.laws.insert(content.laws.end(), first, first + static_cast<std::ptrdiff_t>(width));
  }
  for (std::size_t r = 0; r < content.regions.size(); ++r) content.regions[r].law = sharing.index()[r];
}

std::string notes(const Partition& partition, const SearchTree& tree, TreeMode mode) {
  double radius = partition.regions.front().radius;
  for (const CriticalRegion& region : partition.regions) radius = std::min(radius, region.radius);
  std::ostringstream text;
  text << "regions: " << partition.regions.size() << "\n"
       << "candidate_sets: " << partition.stats.candidate_sets << "\n"
       << "degenerate_facets: " << partition.stats.degenerate_facets << "\n"
       << "least_radius: " << radius << "\n"
       << "tree_depth: " << tree.depth << "\n"
       << "tree: " << toString(mode) << ", " << toString(tree.end) << "\n";
  if (!partition.near_rows.empty()) {
    text << "near_rows:";
    for (const int row : partition.near_rows) text << " " << row;
    text << "\n";
  }
  if (partition.unbounded_at.size() > 0)
    text << "unbounded_at: " << vectorText(partition.unbounded_at) << "\n";
  return text.str();
}

}  // namespace

MapContent encode(const ParametricProgram& program, const Partition& partition, const TreeOptions& options) {
  if (partition.regions.empty())
    throw Error(program.name + ": the partition has no region (" + toString(partition.status) + ")");
  const Scaling scaling(program);
  MapContent content;
  content.name = program.name;
  content.problem_text = program.text;
  content.problem_kind = program.text_kind;
  content.solver_status = toString(partition.status);
  content.period = program.period;
  content.tolerance = tolerance::kMembership;
  content.parameters = program.parameters;
  content.inputs = program.inputs;

  TreeRegions regions;
  regions.p = program.parameterCount();
  addPlanes(partition, scaling, content, regions);
  addLaws(partition, scaling, content);
  TreeOptions choices = options;
  if (choices.explored_pivots == 0) choices.explored_pivots = partition.stats.lp_pivots;
  if (!partition.near_rows.empty()) choices.least_cell = std::max(choices.least_cell, tolerance::kLeastCell);
  SearchTree tree = buildTree(regions, choices);
  content.solver_notes = notes(partition, tree, options.mode);
  moveTree(std::move(tree), content);
  orderRows(content);
  return content;
}

}  // namespace polyfly
