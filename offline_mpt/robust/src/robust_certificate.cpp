#include "robust_certificate.hpp"

#include <algorithm>
#include <map>

#include "certify/certificate.hpp"
#include "certify/certify_exactly.hpp"
#include "certify/region_check.hpp"
#include "rational_parts.hpp"
#include "region_maps/region_map.hpp"
#include "robust_mpc/prove_map.hpp"
#include "support/certificate_text.hpp"

namespace polyfly {
namespace {

// u~_0 - K e and tau.
constexpr int kVariables = 2;

std::string fraction(const Rational& value) { return " " + value.get_str(16); }

std::string fractions(const RationalVector& values) {
  std::string text;
  for (const Rational& value : values) text += fraction(value);
  return text;
}

std::string sparse(const RationalVector& values) {
  std::string text;
  std::size_t count = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] == 0) continue;
    ++count;
    text += " " + std::to_string(k) + fraction(values[k]);
  }
  return " " + std::to_string(count) + text;
}

/// K e as a function of theta.
RationalVector preferredInput(const RobustProblem& problem) {
  RationalVector gain(at(problem.parameterCount()));
  const std::vector<int> errors = problem.errorParameters();
  for (int s = 0; s < problem.stateCount(); ++s) gain[at(errors[at(s)])] = problem.tie_gain(0, s);
  return gain;
}

/// What the references add to u~, as a function of theta.
RationalVector inputShift(const RobustProblem& problem) {
  RationalVector shift;
  for (const RobustProblem::Parameter& parameter : problem.parameters)
    shift.push_back(parameter.state < 0 ? parameter.input_shift[0] : Rational(0));
  return shift;
}

/// The linear program of the facets, in fractions and rounded: the facet a y <= b counts for u~_0 = K e + z_1, tau = z_2.
class FacetProgram {
 public:
  explicit FacetProgram(const RobustStatement& statement) : source(statement.signals) {
    const int rows = static_cast<int>(statement.set.facets.size()), p = statement.problem.parameterCount();
    const int outputs = source.inputCount();
    source.H = Eigen::MatrixXd::Zero(kVariables, kVariables);
    source.F = Eigen::MatrixXd::Zero(kVariables, p);
    source.f = Eigen::VectorXd::Unit(kVariables, 1);
    source.A.resize(rows, kVariables);
    source.S.resize(rows, p);
    source.b.resize(rows);
    source.A_theta.resize(0, p);
    source.b_theta.resize(0);
    source.E = Eigen::MatrixXd::Identity(outputs, kVariables);
    source.C = Eigen::MatrixXd::Zero(outputs, p);
    source.c = Eigen::VectorXd::Zero(outputs);
    numbers.H.assign(kVariables * kVariables, 0);
    numbers.F.assign(at(kVariables * p), 0);
    numbers.f = {0, 1};
    numbers.E.assign(at(outputs * kVariables), 0);
    for (int i = 0; i < outputs; ++i) numbers.E[at(i * kVariables + i)] = 1;
    numbers.C.assign(at(outputs * p), 0);
    numbers.c.assign(at(outputs), 0);
    const RationalVector preferred = preferredInput(statement.problem), shift = inputShift(statement.problem);
    for (int j = 0; j < p; ++j) {
      numbers.C[at(j)] = preferred[at(j)] + shift[at(j)];
      source.C(0, j) = nearestDouble(numbers.C[at(j)]);
    }
    for (int i = 0; i < rows; ++i) addRow(i, statement.set.facets[at(i)].half_space, preferred);
  }

  ParametricProgram source;
  RationalProgram numbers;

 private:
  void addRow(int i, const ExactHalfSpace& facet, const RationalVector& preferred) {
    const int p = source.parameterCount();
    RationalVector row{facet.a[at(p)], facet.a[at(p) + 1]};
    for (int j = 0; j < p; ++j) row.push_back(-facet.a[at(j)] - facet.a[at(p)] * preferred[at(j)]);
    row.push_back(facet.b);
    const std::vector<Integer> whole = wholeNumbers(row);
    Integer greatest(1);
    for (const Integer& value : whole) greatest = std::max(greatest, Integer(abs(value)));
    const auto rounded = [&](int k) { return nearestDouble(Rational(whole[at(k)]) / greatest); };
    for (int k = 0; k < kVariables; ++k) {
      numbers.A.emplace_back(whole[at(k)]);
      source.A(i, k) = rounded(k);
    }
    for (int j = 0; j < p; ++j) {
      numbers.S.emplace_back(whole[at(kVariables + j)]);
      source.S(i, j) = rounded(kVariables + j);
    }
    numbers.b.emplace_back(whole.back());
    source.b[i] = rounded(kVariables + p);
  }
};

/// The law's regions by their active facets, sorted.
using RegionsByActive = std::map<std::vector<int>, const RobustLaw::Region*>;

RegionsByActive byActive(const RobustLaw& law) {
  RegionsByActive regions;
  for (const RobustLaw::Region& region : law.regions) {
    std::vector<int> active = region.active;
    std::sort(active.begin(), active.end());
    regions.emplace(std::move(active), &region);
  }
  return regions;
}

/// None: nullptr.
const RobustLaw::Region* regionOf(const RegionsByActive& regions, const RegionView& view) {
  const auto found = regions.find({view.active, view.active + view.active_count});
  return found == regions.end() ? nullptr : found->second;
}

std::vector<Defect> strangeRegions(const RegionMap& map, const RegionsByActive& regions) {
  std::vector<Defect> defects;
  for (std::uint32_t r = 0; r < map.regionCount(); ++r) {
    if (regionOf(regions, map.region(r)) != nullptr) continue;
    defects.push_back(
        regionDefect(Defect::Kind::kActiveSet, r, -1, "no region of the exact law has its active facets"));
  }
  return defects;
}

/// The lines of the certificate up to its first region.
class Head {
 public:
  Head(const RegionMap& map, const RobustStatement& statement, const RegionsByActive& regions)
      : map_(map), statement_(statement), regions_(regions) {}

  std::string text(const StatedTolerances& tolerances) {
    text_ = "polyfly robust certificate 2\n" + mapLine("map", map_) + problemLine(map_.problemText());
    text_ += "tolerances " + hex(tolerances.law) + " " + hex(tolerances.plane) + "\n";
    text_ += "equalities 0\nbasis 0\nconvexity linear " + hex(0.0) + "\ncoverage exact\n";
    addModel();
    addRows();
    addHalfSpaces();
    text_ += "regions " + std::to_string(map_.regionCount()) + "\n";
    addPlans();
    return std::move(text_);
  }

 private:
  void addMatrix(const char* name, const RationalMatrix& matrix) {
    text_ += std::string("model ") + name + " " + std::to_string(matrix.rows()) + " " +
             std::to_string(matrix.cols());
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      for (Eigen::Index j = 0; j < matrix.cols(); ++j) text_ += fraction(matrix(i, j));
    }
    text_ += "\n";
  }

  void addModel() {
    const RobustProblem& problem = statement_.problem;
    const int np = problem.parameterCount(), nx = problem.stateCount();
    RationalMatrix drift(nx, 1), state_shift(np, nx), input_shift(np, 1), range(np, 2), input_range(1, 2);
    for (int i = 0; i < nx; ++i) drift(i, 0) = problem.drift[at(i)];
    const RationalVector shift = inputShift(problem);
    for (int j = 0; j < np; ++j) {
      const RobustProblem::Parameter& parameter = problem.parameters[at(j)];
      for (int i = 0; parameter.state < 0 && i < nx; ++i) state_shift(j, i) = parameter.state_shift[at(i)];
      input_shift(j, 0) = shift[at(j)];
      range(j, 0) = parameter.range.lower;
      range(j, 1) = parameter.range.upper;
    }
    input_range(0, 0) = problem.input_ranges[0].lower;
    input_range(0, 1) = problem.input_ranges[0].upper;
    addMatrix("A", problem.A);
    addMatrix("B", problem.B);
    addMatrix("G", problem.G);
    addMatrix("drift", drift);
    addMatrix("C", problem.C);
    addMatrix("tie_gain", problem.tie_gain);
    if (problem.feedback == FeedbackPrediction::kFixed) addMatrix("feedback_gain", problem.feedback_gain);
    addMatrix("state_shift", state_shift);
    addMatrix("input_shift", input_shift);
    addMatrix("range", range);
    addMatrix("input_range", input_range);
    appendList("errors", problem.errorParameters(), text_);
    for (int i = 0; i < nx; ++i) {
      if (const auto& bounds = problem.state_ranges[at(i)]; bounds)
        text_ +=
            "state_range " + std::to_string(i) + fraction(bounds->lower) + fraction(bounds->upper) + "\n";
    }
  }

  void addRows() {
    text_ += "predictions " + std::to_string(statement_.program.prediction_count) + "\n";
    for (const RobustProgram::Row& row : statement_.program.rows) {
      text_ += "row" + fraction(row.bound) + fractions(row.y) + sparse(row.z) + " " +
               std::to_string(row.terms.size());
      for (const RobustProgram::Term& term : row.terms) text_ += fraction(term.constant) + sparse(term.z);
      text_ += "\n";
    }
  }

  void addHalfSpaces() {
    for (const FeasibleSet::Facet& facet : statement_.set.facets) {
      text_ += "half_space " + std::to_string(facet.parts.size());
      for (const FeasibleSet::Part& part : facet.parts) {
        std::string signs = "s";
        for (const bool negative : part.negative) signs += negative ? '-' : '+';
        text_ += " " + std::to_string(part.row) + " " + signs + fraction(part.weight);
      }
      text_ += "\n";
    }
  }

  /// Vertices of regions with their plans, and the simplices that make up each region.
  void addPlans() {
    std::string simplices;
    for (std::size_t r = 0; r < map_.regionCount(); ++r) {
      const RobustLaw::Region& region = *regionOf(regions_, map_.region(r));
      std::vector<std::size_t> places;
      for (std::size_t k = 0; k < region.vertices.size(); ++k) places.push_back(pointOf(region, k));
      for (const std::vector<std::size_t>& simplex : triangulate(region.polytope, region.vertices)) {
        simplices += "simplex " + std::to_string(r);
        for (const std::size_t k : simplex) simplices += " " + std::to_string(places[k]);
        simplices += "\n";
      }
    }
    text_ += simplices;
  }

  std::size_t pointOf(const RobustLaw::Region& region, std::size_t vertex) {
    const RationalVector& theta = region.vertices[vertex];
    const auto [known, is_new] = points_.emplace(theta, points_.size());
    if (is_new) {
      text_ += "point" + fractions(theta) + fraction(dot(region.input_gain, theta) + region.input_offset) +
               fraction(dot(region.peak_gain, theta) + region.peak_offset) +
               fractions(region.predictions[vertex]) + "\n";
    }
    return known->second;
  }

  const RegionMap& map_;
  const RobustStatement& statement_;
  const RegionsByActive& regions_;
  std::map<RationalVector, std::size_t> points_;
  std::string text_;
};

}  // namespace

void writeCertificate(const RobustProof& proof, const std::string& path) {
  writeProof(proof.certificate, "the map", path);
}

CertifyReport certifyRobust(const RegionMap& map, const RobustStatement& statement,
                            const CertifyOptions& options) {
  const RegionsByActive regions = byActive(statement.law);
  CertifyReport report;
  report.defects = strangeRegions(map, regions);
  if (!report.defects.empty()) return report;
  const FacetProgram facets(statement);
  const ExactProgram exact(facets.source, facets.numbers, {});
  return certifyExactly({map, facets.source, exact, options}, [&](const StatedTolerances& tolerances) {
    return Head(map, statement, regions).text(tolerances);
  });
}

}  // namespace polyfly
