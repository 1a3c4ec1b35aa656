#include "certificate.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>

namespace checker {
namespace {

/// Lines that every certificate has once, beside the program's numbers.
const char* const kHead[] = {"map",     "problem", "tolerances", "equalities", "basis",
                             "dropped", "relaxed", "convexity",  "coverage",   "regions"};

}  // namespace

Certificate::Certificate(const std::string& text, const Map& map) : map_(map), scaling_(map) {
  std::istringstream lines(unsealed(text));
  std::string line;
  require(std::getline(lines, line) && line == "polyfly certificate 4", "not a certificate of version 4");
  claims_.reserve(map.regions.size());
  Claim* claim = nullptr;
  while (std::getline(lines, line)) readLine(line, claim);
  checkHead();
  checkSizes();
  replaceEntries();
}

void Certificate::readLine(const std::string& text, Claim*& claim) {
  Line line(text);
  const std::string key = line.word();
  if (key == "drop" || key == "leaf" || key == "outside" || key == "near" || key == "beyond" ||
      key == "sliver") {
    lookups_.push_back(text);
    return;
  }
  if (std::find(std::begin(kHead), std::end(kHead), key) != std::end(kHead))
    require(head_.insert(key).second, key + " is given twice");
  if (key == "map") {
    require(line.word() == hexText(map_.checksum) && line.count(SIZE_MAX) == map_.size,
            "the certificate is of another map");
  } else if (key == "problem") {
    require(line.word() == hexText(xxh64(map_.problem)) && line.count(SIZE_MAX) == map_.problem.size(),
            "the certificate is of another problem");
  } else if (key == "tolerances") {
    law_tolerance_ = line.real();
    plane_tolerance_ = line.real();
  } else if (key == "convexity") {
    const std::string kind = line.word();
    require(kind == "singular" || kind == "definite", "convexity: " + kind);
    singular_ = kind == "singular";
    penalty_ = line.real();
  } else if (key == "coverage") {
    const std::string kind = line.word();
    require(kind == "exact" || kind == "widened", "coverage: " + kind);
    widened_ = kind == "widened";
  } else if (key == "counts") {
    Counts& counts = counts_.emplace_back();
    counts.name = line.word();
    counts.row = line.count(kMany);
    counts.column = line.count(kMany);
    counts.value = line.fraction();
  } else if (key == "equalities" || key == "dropped" || key == "relaxed" || key == "basis") {
    for (std::size_t k = line.count(kMany); k > 0; --k) {
      const std::size_t row = line.count(kMany);
      if (key == "basis") {
        basis_.push_back(row);
      } else {
        (key == "dropped" ? dropped_ : key == "relaxed" ? relaxed_ : equalities_).insert(row);
      }
    }
  } else if (key == "implied") {
    implied_.push_back(readWeights(line));
  } else if (key == "regions") {
    require(line.count(kMany) == map_.regions.size(), "the certificate is of another number of regions");
  } else if (key == "R") {
    require(line.count(kMany) == claims_.size() && claims_.size() < map_.regions.size(),
            "regions are out of order");
    claim = &claims_.emplace_back();
  } else if (key == "G") {
    require(claims_.size() >= map_.regions.size(), "a sliver before the last region");
    claim = &claims_.emplace_back();
    claim->is_sliver = true;
    for (std::size_t k = line.count(kMany); k > 0; --k) claim->active.push_back(line.count(kMany));
  } else if (key == "P" || key == "I" || key == "D" || key == "X" || key == "W" || key == "Y" || key == "L" ||
             key == "V") {
    require(claim != nullptr, key + " before the first region");
    if (key == "P") {
      while (!line.done()) claim->point.push_back(line.fraction());
    } else if (key == "Y") {
      require(widened_, "a row is forgiven where nothing is moved outwards");
      claim->forgiven.insert(line.word());
    } else if (key == "V") {
      require(claim->is_sliver && claim->cover.empty(), "a cover of what is no sliver");
      while (!line.done()) claim->cover += line.word() + " ";
    } else if (key == "L") {
      require(line.count(kMany) == claim->listed.size(), "facets are out of order");
      claim->listed.push_back(line.word());
      std::string& closing = claim->closings.emplace_back();
      while (!line.done()) closing += line.word() + " ";
    } else {
      const std::string origin = line.word();
      const Integer scale = line.integer();
      require(claim->proofs.emplace(key + origin, std::make_pair(scale, readWeights(line))).second,
              "a row is proven twice");
    }
  } else {
    Matrix matrix = readMatrix(line, key);
    require(data_.emplace(key, std::move(matrix)).second, key + " is given twice");
  }
  line.end();
}

/// Nothing is left out, and the tolerances are such that "within" means something: the map's look-up reaches
/// twice as far as planes may differ.
void Certificate::checkHead() const {
  for (const char* const key : kHead) require(head_.count(key) > 0, std::string(key) + " is missing");
  require(law_tolerance_ >= 0 && law_tolerance_ <= Fraction(kMostLawTolerance),
          "the law tolerance is out of range");
  require(plane_tolerance_ >= 0 && plane_tolerance_ <= Fraction(kMostPlaneTolerance) &&
              2 * plane_tolerance_ <= Fraction(map_.tolerance),
          "the plane tolerance is out of range");
}

void Certificate::checkSizes() {
  n_ = data("H").rows;
  m_ = data("A").rows;
  p_ = map_.p;
  q_ = map_.q;
  requireSizes(data_, n_, m_, p_, q_);
  for (std::size_t j = 0; j < p_; ++j) {
    const Fraction lower = data("box").at(j, 0), upper = data("box").at(j, 1);
    require(
        lower == Fraction(map_.bounds[2 * j]) && upper == Fraction(map_.bounds[2 * j + 1]) && lower < upper,
        "the box is not the map's");
  }
  linear_ = std::all_of(data("H").entries.begin(), data("H").entries.end(),
                        [](const Fraction& h) { return h == 0; });
  for (const auto* rows : {&equalities_, &dropped_, &relaxed_})
    require(rows->empty() || *rows->rbegin() < m_, "no such row");
  require(claims_.size() >= map_.regions.size() && !map_.regions.empty(), "regions are missing");
  require(!widened_ || claims_.size() == map_.regions.size(),
          "slivers beside regions that are moved outwards");
}

std::string Certificate::conditions() const {
  char line[160];
  std::snprintf(
      line, sizeof line,
      "differences from the exact solution: law at most %g (relative), planes at most %g (scaled)\n",
      law_tolerance_.get_d(), plane_tolerance_.get_d());
  std::string text = line;
  std::snprintf(line, sizeof line, "look-ups: half-spaces are violated by at most %g (scaled)\n",
                8 * map_.tolerance);
  text += line;
  const auto slivers = claims_.size() - map_.regions.size();
  if (slivers > 0)
    text +=
        std::to_string(slivers) + " slivers are left to the regions about them, within the same distance\n";
  if (widened_) text += "coverage is that of the regions moved outwards by that distance\n";
  std::size_t forgiven = 0;
  for (const Claim& claim : claims_) forgiven += claim.forgiven.size();
  if (forgiven > 0)
    text += std::to_string(forgiven) + " rows hold in a region within 2^-40 of their size only\n";
  if (linear_) text += "linear program: of several optima the shortest\n";
  if (singular_) text += "H is singular: of several optima the shortest\n";
  const auto is_bound = [](const Counts& counts) { return counts.name == "b"; };
  const auto bounds = static_cast<std::size_t>(std::count_if(counts_.begin(), counts_.end(), is_bound));
  if (bounds > 0)
    text +=
        std::to_string(bounds) +
        " bounds of rows that count as equalities differ by at most 2^-29 of the sum of the row's entries\n";
  if (counts_.size() > bounds)
    text += std::to_string(counts_.size() - bounds) +
            " entries count as others that differ by at most 2^-30 of the "
            "greatest of their matrix or row\n";
  if (!relaxed_.empty())
    text += std::to_string(relaxed_.size()) + " rows have bounds that are greater by 2^-40 of their size\n";
  const auto is_equality = [this](std::size_t row) { return equalities_.count(row) > 0; };
  const auto near = std::count_if(dropped_.begin(), dropped_.end(), is_equality);
  if (near > 0) text += std::to_string(near) + " equalities hold within 2^-40 of their size only\n";
  const auto dropped = dropped_.size() - static_cast<std::size_t>(near);
  if (dropped > 0) text += std::to_string(dropped) + " rows hold within 2^-30 of their size only\n";
  return text;
}

/// Compares the numbers with those of a JSON problem. Of other kinds only the text is compared.
void Certificate::compareProblem(const std::string& problem) const {
  require(problem == map_.problem, "the problem file is not the one that the map was made from");
  if (problem.find_first_not_of(" \t\r\n") == std::string::npos ||
      problem[problem.find_first_not_of(" \t\r\n")] != '{')
    return;
  compareNumbers(
      problem, [this](const std::string& name) -> const Matrix& { return given(name); }, equalities_);
}

/// Row of (matrix theta + vector) in t.
Vector Certificate::affine(const std::string& matrix, const std::string& vector, std::size_t row,
                           int sign) const {
  Vector result;
  Fraction constant = data(vector).at(row, 0);
  for (std::size_t j = 0; j < p_; ++j) {
    result.push_back(sign * data(matrix).at(row, j) * scaling_.half[j]);
    constant += sign * data(matrix).at(row, j) * scaling_.centre[j];
  }
  result.push_back(constant);
  return result;
}

/// b + S theta of a row in t, greater where the row is relaxed.
Vector Certificate::bound(std::size_t row) const {
  constexpr unsigned long kRelaxedBits = 40;
  Vector result = affine("S", "b", row, 1);
  if (relaxed_.count(row) == 0) return result;
  Fraction greatest;
  for (std::size_t j = 0; j < n_; ++j) greatest = std::max(greatest, Fraction(abs(data("A").at(row, j))));
  result.back() += greatest / Fraction(Integer(1) << kRelaxedBits);
  return result;
}

/// Equalities, convexity: what holds for the program as a whole.
void Certificate::checkProgram() const {
  std::set<std::size_t> allowed = equalities_;
  for (const Weights& proof : implied_) {
    Vector sum(n_ + p_ + 1);
    for (const auto& [row, weight] : proof) {
      require(row < m_ && (weight > 0 || equalities_.count(row) > 0), "an implied equality has a wrong sign");
      for (std::size_t j = 0; j < n_; ++j) sum[j] += weight * data("A").at(row, j);
      for (std::size_t j = 0; j < p_; ++j) sum[n_ + j] += weight * data("S").at(row, j);
      sum[n_ + p_] += weight * data("b").at(row, 0);
      allowed.insert(row);
    }
    for (const Fraction& value : sum) require(value == 0, "an implied equality does not follow");
  }
  for (const Counts& counts : counts_)
    require(counts.name != "b" || allowed.count(counts.row) > 0, "b: of no equality");
  for (const std::size_t row : basis_) require(allowed.count(row) > 0, "a row is no equality");
  for (const std::size_t row : dropped_) {
    require(std::find(basis_.begin(), basis_.end(), row) == basis_.end(), "a row of the basis is dropped");
    require(allowed.count(row) == 0 || equalities_.count(row) > 0, "an implied equality is dropped");
  }
  for (const std::size_t row : relaxed_) require(allowed.count(row) == 0, "an equality is relaxed");
  require(penalty_ >= 0, "convexity: negative");
  require(!linear_ || !singular_, "convexity: H is zero");
  if (!linear_) checkConvexity();
}

/// H of the conditions: symmetric, and as it counts.
Fraction Certificate::hessian(std::size_t i, std::size_t j) const {
  return (data("H").at(i, j) + data("H").at(j, i)) / 2;
}

/// Entries that count as others. They differ by rounding: 2^-30 of the greatest entry of the matrix, or of
/// the row of A; those of b by 2^-29 of the sum of the row's entries. All of H is replaced or nothing; it
/// then has the penalty in it.
void Certificate::replaceEntries() {
  constexpr unsigned long kRoundingBits = 30;
  const auto greatest_of = [](const Matrix& matrix, std::size_t first, std::size_t count) {
    Fraction greatest;
    for (std::size_t k = first; k < first + count; ++k)
      greatest = std::max(greatest, Fraction(abs(matrix.entries[k])));
    return greatest;
  };
  std::map<std::string, std::set<std::pair<std::size_t, std::size_t>>> seen;
  for (const Counts& counts : counts_) {
    const bool may_be_singular =
        counts.name == "H" || counts.name == "F" || counts.name == "f" || counts.name == "A";
    require((singular_ && may_be_singular) || counts.name == "b",
            counts.name + ": its entries cannot count as others");
    Matrix& matrix = data_.at(counts.name);
    require(counts.row < matrix.rows && counts.column < matrix.columns, counts.name + ": no such entry");
    require(seen[counts.name].emplace(counts.row, counts.column).second, "an entry counts twice");
    if (given_.emplace(counts.name, matrix).second && counts.name == "H") {
      for (std::size_t i = 0; i < n_; ++i) {
        for (std::size_t j = 0; j < n_; ++j) {
          matrix.entries[i * n_ + j] = (given("H").at(i, j) + given("H").at(j, i)) / 2;
          for (const std::size_t row : basis_)
            matrix.entries[i * n_ + j] += penalty_ * given("A").at(row, i) * given("A").at(row, j);
        }
      }
    }
  }
  if (seen.count("H") > 0) require(seen["H"].size() == n_ * n_, "H counts as another only in part");
  const std::map<std::string, Matrix> before = data_;
  for (const Counts& counts : counts_) {
    if (counts.name == "b") {
      countBound(counts);
      continue;
    }
    const Matrix& old = before.at(counts.name);
    const bool by_row = counts.name == "A";
    const Fraction size = by_row ? greatest_of(old, counts.row * old.columns, old.columns)
                                 : greatest_of(old, 0, old.entries.size());
    Fraction& entry = data_.at(counts.name).entries[counts.row * old.columns + counts.column];
    entry = counts.value;
    require(abs(entry - old.at(counts.row, counts.column)) * Fraction(Integer(1) << kRoundingBits) <= size,
            counts.name + ": an entry counts as one that differs by more than rounding");
  }
  if (seen.count("H") > 0) penalty_ = 0;
}

/// z moved by 2^-29 in each entry makes up for it.
void Certificate::countBound(const Counts& counts) {
  constexpr unsigned long kNarrowBits = 29;
  Fraction size;
  for (std::size_t j = 0; j < n_; ++j) size += abs(given("A").at(counts.row, j));
  const Fraction difference = abs(counts.value - given("b").at(counts.row, 0));
  require(difference * Fraction(Integer(1) << kNarrowBits) <= size,
          "b: an entry counts as one that differs by more than rounding");
  data_.at("b").entries[counts.row] = counts.value;
}

void Certificate::checkConvexity() const {
  Matrix H = data("H");
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j < n_; ++j) {
      H.entries[i * n_ + j] = hessian(i, j);
      for (const std::size_t row : basis_)
        H.entries[i * n_ + j] += penalty_ * data("A").at(row, i) * data("A").at(row, j);
    }
  }
  std::vector<char> done(n_, 0);
  for (std::size_t round = 0; round < n_; ++round) {
    std::size_t k = n_;
    for (std::size_t i = 0; i < n_; ++i) {
      require(done[i] || H.at(i, i) >= 0, "H is not positive semidefinite");
      if (!done[i] && H.at(i, i) > 0) k = i;
    }
    for (std::size_t i = 0; k == n_ && i < n_ * n_; ++i)
      require(done[i / n_] || done[i % n_] || H.entries[i] == 0, "H is not positive semidefinite");
    if (k == n_) return;
    done[k] = 1;
    for (std::size_t i = 0; i < n_; ++i) {
      if (done[i]) continue;
      const Fraction factor = H.at(i, k) / H.at(k, k);
      for (std::size_t j = 0; j < n_; ++j) H.entries[i * n_ + j] -= factor * H.at(k, j);
    }
  }
}

}  // namespace checker
