// Reading the certificate of a robust map, and the linear program of its half-spaces.
#include "robust/robust_certificate.hpp"

#include <algorithm>

#include "extensions/read_certificate.hpp"
#include "robust/read_map_certificate.hpp"

namespace checker {
namespace {

// What the statement needs of the extensions: half-spaces that differ from the box by rounding.
const char* const kLeftOut = "left_out";
constexpr char kFirstWords[] = "polyfly robust ";
// Rows are compared as lists of this length, whatever few numbers their lines hold.
constexpr std::size_t kMostPredictions = 10000;

}  // namespace

bool RobustCertificate::readFurther(const std::string& key, Line& line) {
  if (readProgram(key, line)) return true;
  require(key == kLeftOut || key == "weights", key + ": is no line of a robust certificate");
  return ExtendedCertificate::readFurther(key, line);
}

bool RobustCertificate::readProgram(const std::string& key, Line& line) {
  if (key == "model") {
    readModel(line);
  } else if (key == "errors") {
    require(errors_.empty(), "errors is given twice");
    for (std::size_t k = line.count(kMany); k > 0; --k) errors_.push_back(line.count(kMany));
  } else if (key == "state_range") {
    const std::size_t state = line.count(kMany);
    const Fraction lower = line.fraction(), upper = line.fraction();
    require(state_ranges_.emplace(state, std::make_pair(lower, upper)).second, "a state has two ranges");
  } else if (key == "predictions") {
    require(!has_predictions_, "predictions is given twice");
    has_predictions_ = true;
    predictions_ = line.count(kMostPredictions);
  } else if (key == "row") {
    readRow(line);
  } else if (key == "half_space") {
    readHalfSpace(line);
  } else if (key == "point") {
    readPoint(line);
  } else if (key == "simplex") {
    require(!points_.empty(), "a simplex before the first point");
    const std::size_t region = line.count(kMany);
    Simplex& simplex = simplices_[region].emplace_back();
    while (!line.done()) simplex.push_back(line.count(points_.size() - 1));
    require(simplex.size() == map().p + 1, "a simplex has another number of vertices");
  } else {
    return false;
  }
  return true;
}

void RobustCertificate::readModel(Line& line) {
  const std::string name = line.word();
  Matrix matrix;
  matrix.rows = line.count(kMany);
  matrix.columns = line.count(kMany);
  while (!line.done()) matrix.entries.push_back(line.fraction());
  require(matrix.entries.size() == matrix.rows * matrix.columns, name + ": its size is not as stated");
  require(model_.emplace(name, std::move(matrix)).second, name + " is given twice");
}

RobustCertificate::Sparse RobustCertificate::readSparse(Line& line) const {
  require(has_predictions_, "predictions is missing");
  Sparse entries;
  for (std::size_t k = line.count(kMany); k > 0; --k) {
    const std::size_t place = line.count(kMany);
    require(place < predictions_, "a row names a prediction that is not there");
    entries.emplace_back(place, line.fraction());
  }
  return entries;
}

void RobustCertificate::readRow(Line& line) {
  PlanRow& row = rows_.emplace_back();
  row.bound = line.fraction();
  for (std::size_t j = 0; j < map().p + 2; ++j) row.y.push_back(line.fraction());
  row.z = readSparse(line);
  for (std::size_t k = line.count(kMany); k > 0; --k) {
    const Fraction constant = line.fraction();
    row.terms.push_back({constant, readSparse(line)});
  }
}

/// The weighted sum of rows, each with one sign for each of its terms: what they give for one disturbance. Predictions
/// must cancel. So no plan breaks the half-space.
void RobustCertificate::readHalfSpace(Line& line) {
  Vector sum(map().p + 3), predictions(predictions_);
  for (std::size_t k = line.count(kMany); k > 0; --k) {
    const std::size_t place = line.count(kMany);
    require(place < rows_.size(), "a half-space names a row that is not there");
    const PlanRow& row = rows_[place];
    const std::string signs = line.word();
    const Fraction weight = line.fraction();
    require(weight > 0, "a half-space has a weight that is not positive");
    require(signs.size() == row.terms.size() + 1 && signs[0] == 's' &&
                signs.find_first_not_of("+-", 1) == std::string::npos,
            "a half-space has another number of signs than its row has terms");
    for (std::size_t j = 0; j < row.y.size(); ++j) sum[j] += weight * row.y[j];
    sum.back() += weight * row.bound;
    for (const auto& [entry, value] : row.z) predictions[entry] += weight * value;
    for (std::size_t t = 0; t < row.terms.size(); ++t) {
      const Fraction signed_weight = signs[t + 1] == '-' ? Fraction(-weight) : weight;
      sum.back() -= signed_weight * row.terms[t].constant;
      for (const auto& [entry, value] : row.terms[t].z) predictions[entry] += signed_weight * value;
    }
  }
  for (const Fraction& value : predictions)
    require(value == 0, "the predictions of a half-space do not cancel");
  half_spaces_.push_back(std::move(sum));
}

void RobustCertificate::readPoint(Line& line) {
  require(has_predictions_, "predictions is missing");
  Point& point = points_.emplace_back();
  for (std::size_t j = 0; j < map().p + 2; ++j) point.y.push_back(line.fraction());
  while (!line.done()) point.plan.push_back(line.fraction());
  require(point.plan.size() == predictions_, "a plan has another number of predictions");
}

const Matrix& RobustCertificate::model(const std::string& name) const { return model_.at(name); }

void RobustCertificate::requireModel() const {
  require(model_.count("A") > 0 && model_.count("G") > 0 && model_.count("C") > 0, "model: is missing");
  const std::size_t nx = model("A").rows, p = map().p;
  const std::map<std::string, std::pair<std::size_t, std::size_t>> sizes = {{"A", {nx, nx}},
                                                                            {"B", {nx, 1}},
                                                                            {"G", {nx, model("G").columns}},
                                                                            {"drift", {nx, 1}},
                                                                            {"C", {model("C").rows, nx}},
                                                                            {"tie_gain", {1, nx}},
                                                                            {"state_shift", {p, nx}},
                                                                            {"input_shift", {p, 1}},
                                                                            {"range", {p, 2}},
                                                                            {"input_range", {1, 2}}};
  for (const auto& [name, size] : sizes) {
    const auto at = model_.find(name);
    require(at != model_.end(), "model " + name + ": is missing");
    require(at->second.rows == size.first && at->second.columns == size.second,
            "model " + name + ": its size does not fit");
  }
  // Only check_problem reads the gain of a fixed feedback: its effect is in the rows.
  const auto feedback = model_.find("feedback_gain");
  const bool has_feedback = feedback != model_.end();
  require(!has_feedback || (feedback->second.rows == 1 && feedback->second.columns == nx),
          "model feedback_gain: its size does not fit");
  require(model_.size() == sizes.size() + (has_feedback ? 1 : 0), "model: an unknown matrix");
  constexpr std::size_t kMostChannels = 20;  // each vertex of the disturbances is tried
  require(model("G").columns <= kMostChannels, "model G: has too many channels");
  require(state_ranges_.empty() || state_ranges_.rbegin()->first < nx, "state_range: no such state");
  require(nx > 0 && errors_.size() == nx, "errors: not one for each state");
  std::set<std::size_t> seen;
  for (const std::size_t parameter : errors_) {
    require(parameter < p && seen.insert(parameter).second,
            "errors: names a parameter that is not there, or twice");
    for (std::size_t i = 0; i < nx; ++i)
      require(model("state_shift").at(parameter, i) == 0 && model("input_shift").at(parameter, 0) == 0,
              "an error is a reference");
  }
}

/// K e as a function of theta.
Vector RobustCertificate::preferredInput() const {
  Vector gain(map().p);
  for (std::size_t i = 0; i < errors_.size(); ++i) gain[errors_[i]] = model("tie_gain").at(0, i);
  return gain;
}

/// The linear program: the least tau = z_2, then the least |z_1|, of u~_0 = K e + z_1. The map has u = u~_0 and what the
/// references add; then perhaps tau.
void RobustCertificate::complete() {
  require(data_.empty(), "an unknown line");
  // A half-space that counts as an equality would let any law on it be the optimum.
  require(equalities_.empty() && basis_.empty(), "equalities or basis of a robust program are not empty");
  requireModel();
  const std::size_t p = map().p, q = map().q, rows = half_spaces_.size();
  require(q == 1 || q == 2, "a robust map has one input, and perhaps tau");
  const auto make = [&](const std::string& name, std::size_t height, std::size_t width) -> Vector& {
    Matrix& matrix = data_[name];
    matrix.rows = height;
    matrix.columns = width;
    matrix.entries.assign(height * width, 0);
    return matrix.entries;
  };
  make("H", 2, 2);
  make("f", 2, 1)[1] = 1;
  make("F", 2, p);
  make("A_theta", 0, p);
  make("b_theta", 0, 1);
  make("c", q, 1);
  Vector& E = make("E", q, 2);
  for (std::size_t i = 0; i < q; ++i) E[2 * i + i] = 1;
  Vector &C = make("C", q, p), &box = make("box", p, 2);
  const Vector preferred = preferredInput();
  for (std::size_t j = 0; j < p; ++j) {
    C[j] = preferred[j] + model("input_shift").at(j, 0);
    box[2 * j] = map().bounds[2 * j];
    box[2 * j + 1] = map().bounds[2 * j + 1];
  }
  Vector &A = make("A", rows, 2), &S = make("S", rows, p), &b = make("b", rows, 1);
  for (std::size_t i = 0; i < rows; ++i) {
    const Vector& half_space = half_spaces_[i];
    Vector values = {half_space[p], half_space[p + 1]};
    for (std::size_t j = 0; j < p; ++j) values.push_back(-half_space[j] - half_space[p] * preferred[j]);
    values.push_back(half_space.back());
    const Row whole = primitive(values);
    A[2 * i] = whole[0];
    A[2 * i + 1] = whole[1];
    for (std::size_t j = 0; j < p; ++j) S[i * p + j] = whole[2 + j];
    b[i] = whole.back();
  }
}

void RobustCertificate::requireKinds(const std::string& convexity, const std::string& coverage) const {
  require(convexity == "linear", "convexity: " + convexity);
  require(coverage == "exact", "coverage: " + coverage);
}

std::string RobustCertificate::conditions() const {
  std::string text = Certificate::conditions();
  text += "robust: tau is least for all disturbances, then the input nearest to K e\n";
  text += "one step: all bounds hold, and outputs are at most tau, from " + std::to_string(steps_) +
          " vertices of region and disturbance\n";
  text += lost_ == 0
              ? "feasibility is not lost within the ranges of the parameters\n"
              : "feasibility MAY BE LOST: " + std::to_string(lost_) + " of these successors have no plan\n";
  if (left_range_ > 0)
    text += std::to_string(left_range_) + " of these successors leave the range of an error\n";
  return text;
}

std::unique_ptr<Certificate> readMapCertificate(const std::string& text, const Map& map) {
  if (text.compare(0, sizeof kFirstWords - 1, kFirstWords) != 0) return readCertificate(text, map);
  auto certificate = std::make_unique<RobustCertificate>(map);
  certificate->read(text);
  return certificate;
}

}  // namespace checker
