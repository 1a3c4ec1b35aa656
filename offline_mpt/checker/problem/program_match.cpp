#include "problem/program_match.hpp"

#include <algorithm>
#include <cstdio>

namespace checker {
namespace {

/// The greatest difference, relative to the greatest entry.
Fraction difference(const Vector& actual, const std::vector<Ball>& expected) {
  Fraction greatest, size;
  for (std::size_t j = 0; j < actual.size(); ++j) {
    greatest = std::max(greatest, expected[j].distance(actual[j]));
    size = std::max(size, Fraction(abs(actual[j])));
  }
  return size == 0 ? greatest : Fraction(greatest / size);
}

class Match {
 public:
  Match(const Matrices& program, const Fraction& tolerance) : program_(program), tolerance_(tolerance) {}

  /// `names` are matrices side by side.
  void matrix(const std::vector<std::string>& names, const BallMatrix& expected) {
    std::string name;
    std::size_t columns = 0;
    for (const std::string& part : names) {
      name += (name.empty() ? "" : " ") + part;
      columns += program_.at(part).columns;
    }
    const std::size_t rows = program_.at(names.front()).rows;
    require(rows == expected.rows() && columns == expected.columns(),
            name + ": has another size than the problem");
    for (std::size_t i = 0; i < rows; ++i) {
      Vector entries;
      std::vector<Ball> balls;
      for (const std::string& part : names) {
        const Matrix& actual = program_.at(part);
        for (std::size_t j = 0; j < actual.columns; ++j) {
          balls.push_back(expected.at(i, entries.size()));
          entries.push_back(actual.at(i, j));
        }
      }
      requireSmall(difference(entries, balls), name + ": row " + std::to_string(i));
    }
  }

  /// Each expected row is exactly one row of the program, and the other way round.
  void rows(const std::vector<ExpectedRow>& expected) {
    std::vector<Vector> open = actualRows();
    require(open.size() == expected.size(), "the program has " + std::to_string(open.size()) +
                                                " rows, the problem " + std::to_string(expected.size()));
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const std::vector<Ball> wanted = joined(expected[k]);
      Fraction found;
      const auto is_it = [&](const Vector& row) {
        found = difference(row, wanted);
        return found <= tolerance_;
      };
      const auto at = std::find_if(open.begin(), open.end(), is_it);
      require(at != open.end(), "row " + std::to_string(k) + " of the problem is none of the program");
      greatest_ = std::max(greatest_, found);
      open.erase(at);
    }
  }

  const Fraction& greatest() const { return greatest_; }

 private:
  void requireSmall(const Fraction& found, const std::string& what) {
    char share[32];
    std::snprintf(share, sizeof share, "%.3g", found.get_d());
    require(found <= tolerance_, what + " differs from the problem by " + share + " of its greatest entry");
    greatest_ = std::max(greatest_, found);
  }

  static std::vector<Ball> joined(const ExpectedRow& row) {
    std::vector<Ball> result = row.on_z;
    result.insert(result.end(), row.on_theta.begin(), row.on_theta.end());
    result.push_back(row.bound);
    return result;
  }

  /// A z <= b + S theta, and those without z as A_theta theta <= b_theta.
  std::vector<Vector> actualRows() const {
    std::vector<Vector> result;
    const Matrix &A = program_.at("A"), &S = program_.at("S"), &b = program_.at("b");
    const Matrix &A_theta = program_.at("A_theta"), &b_theta = program_.at("b_theta");
    for (std::size_t i = 0; i < A.rows; ++i) {
      Vector row;
      for (std::size_t j = 0; j < A.columns; ++j) row.push_back(A.at(i, j));
      for (std::size_t j = 0; j < S.columns; ++j) row.push_back(S.at(i, j));
      row.push_back(b.at(i, 0));
      result.push_back(row);
    }
    for (std::size_t i = 0; i < A_theta.rows; ++i) {
      Vector row;
      row.resize(A.columns);
      for (std::size_t j = 0; j < A_theta.columns; ++j) row.push_back(-A_theta.at(i, j));
      row.push_back(b_theta.at(i, 0));
      result.push_back(row);
    }
    return result;
  }

  const Matrices& program_;
  const Fraction tolerance_;
  Fraction greatest_;
};

}  // namespace

mpq_class matchProgram(const Matrices& program, const TrackingProblem& problem,
                       const ExpectedProgram& expected, const mpq_class& tolerance) {
  const std::size_t n = expected.H.rows(), q = expected.C.rows();
  requireSizes(program, n, program.at("A").rows, problem.freeCount(), q);
  std::size_t j = 0;
  for (const TrackingProblem::Parameter& parameter : problem.parameters) {
    if (parameter.fixed) continue;
    require(program.at("box").at(j, 0) == parameter.range.lower &&
                program.at("box").at(j, 1) == parameter.range.upper,
            "the range of parameter " + std::to_string(j) + " is not that of the problem");
    ++j;
  }
  Match match(program, tolerance);
  match.matrix({"H"}, expected.H);
  match.matrix({"F", "f"}, expected.F);
  match.rows(expected.rows);
  BallMatrix first(q, n);
  first.setBlock(0, 0, BallMatrix::identity(q));
  match.matrix({"E"}, first);
  match.matrix({"C", "c"}, expected.C);
  return match.greatest();
}

}  // namespace checker
