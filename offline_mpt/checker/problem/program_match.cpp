#include "problem/program_match.hpp"

#include <algorithm>
#include <cstdio>

namespace checker {
namespace {

const Fraction kGreatestEffect(1, 1000000);

/// Parts of a row, each from a matrix of its own: actual entries and expected ones.
struct Part {
  Vector actual;
  std::vector<Ball> expected;
};

/// The greatest difference, relative to the greatest entry of the part and of those before it: parts further behind are
/// sums in which more cancels.
Fraction difference(const std::vector<Part>& parts) {
  Fraction greatest, size;
  for (const Part& part : parts) {
    Fraction distance;
    for (std::size_t j = 0; j < part.actual.size(); ++j) {
      distance = std::max(distance, part.expected[j].distance(part.actual[j]));
      size = std::max(size, Fraction(abs(part.actual[j])));
    }
    greatest = std::max(greatest, size == 0 ? distance : Fraction(distance / size));
  }
  return greatest;
}

/// A row of the program.
struct ActualRow {
  std::vector<Part> parts;
  bool is_equality = false;
};

class Match {
 public:
  Match(const Matrices& program, const std::set<std::size_t>& equalities, const Fraction& tolerance,
        RoundingEffect* effect)
      : program_(program), equalities_(equalities), tolerance_(tolerance), effect_(effect) {}

  /// `names` are matrices side by side: parts of each row, or `together` one part.
  void matrix(const std::vector<std::string>& names, const BallMatrix& expected, bool together = false) {
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
      std::vector<Part> parts;
      std::size_t column = 0;
      for (const std::string& part : names) {
        if (parts.empty() || !together) parts.emplace_back();
        for (const Fraction& entry : rowOf(part, i, 1)) {
          parts.back().actual.push_back(entry);
          parts.back().expected.push_back(expected.at(i, column++));
        }
      }
      requireSmall(difference(parts), name + ": row " + std::to_string(i));
    }
  }

  /// Each expected row is exactly one row of the program, and the other way round.
  void rows(const std::vector<ExpectedRow>& expected) {
    std::vector<ActualRow> open = actualRows();
    require(open.size() == expected.size(), "the program has " + std::to_string(open.size()) +
                                                " rows, the problem " + std::to_string(expected.size()));
    for (std::size_t k = 0; k < expected.size(); ++k) {
      Fraction found;
      const auto is_it = [&](ActualRow& row) {
        row.parts[0].expected = expected[k].on_z;
        row.parts[1].expected = expected[k].on_theta;
        row.parts[2].expected = {expected[k].bound};
        found = difference(row.parts);
        return row.is_equality == expected[k].is_equality && found <= tolerance_;
      };
      const auto at = std::find_if(open.begin(), open.end(), is_it);
      require(at != open.end(), "row " + std::to_string(k) + " of the problem is none of the program");
      greatest_ = std::max(greatest_, found);
      if (effect_ != nullptr) addEffect(at->parts);
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

  void addEffect(const std::vector<Part>& row) {
    std::vector<Vector> distances;
    for (const Part& part : row) {
      distances.emplace_back();
      for (std::size_t j = 0; j < part.actual.size(); ++j)
        distances.back().push_back(part.expected[j].distance(part.actual[j]));
    }
    effect_->addRow(row[0].actual, distances[0], distances[1], distances[2][0]);
  }

  Vector rowOf(const std::string& name, std::size_t i, int sign) const {
    const Matrix& matrix = program_.at(name);
    Vector row;
    for (std::size_t j = 0; j < matrix.columns; ++j) row.push_back(sign * matrix.at(i, j));
    return row;
  }

  /// A z <= S theta + b, and those without z as A_theta theta <= b_theta.
  std::vector<ActualRow> actualRows() const {
    std::vector<ActualRow> result;
    const std::size_t n = program_.at("A").columns;
    for (std::size_t i = 0; i < program_.at("A").rows; ++i)
      result.push_back({{{rowOf("A", i, 1), {}}, {rowOf("S", i, 1), {}}, {rowOf("b", i, 1), {}}},
                        equalities_.count(i) > 0});
    for (std::size_t i = 0; i < program_.at("A_theta").rows; ++i)
      result.push_back(
          {{{Vector(n), {}}, {rowOf("A_theta", i, -1), {}}, {rowOf("b_theta", i, 1), {}}}, false});
    return result;
  }

  const Matrices& program_;
  const std::set<std::size_t>& equalities_;
  const Fraction tolerance_;
  RoundingEffect* const effect_;
  Fraction greatest_;
};

/// Whether no two stages share a term of the cost: only then may the variables be those beside a feedback.
bool isBlockDiagonal(const Matrix& H, std::size_t inputs, std::size_t size) {
  for (std::size_t i = 0; i < std::min(inputs, H.rows); ++i) {
    for (std::size_t j = 0; j < std::min(inputs, H.columns); ++j)
      if (i / size != j / size && H.at(i, j) != 0) return false;
  }
  return true;
}

}  // namespace

mpq_class matchProgram(const Matrices& program, const std::set<std::size_t>& equalities, const Ranges& ranges,
                       const ExpectedProgram& expected, const mpq_class& tolerance, RoundingEffect* effect) {
  const std::size_t n = expected.H.rows(), q = expected.C.rows();
  requireSizes(program, n, program.at("A").rows, ranges.size(), q);
  for (std::size_t j = 0; j < ranges.size(); ++j)
    require(program.at("box").at(j, 0) == ranges[j].first && program.at("box").at(j, 1) == ranges[j].second,
            "the range of parameter " + std::to_string(j) + " is not that of the problem");
  Match match(program, equalities, tolerance, effect);
  match.matrix({"H"}, expected.H);
  match.matrix({"F", "f"}, expected.F);
  match.rows(expected.rows);
  BallMatrix first(q, n);
  first.setBlock(0, 0, BallMatrix::identity(q));
  match.matrix({"E"}, first);
  // Of a steady state, what cancels in C may be far greater in c.
  match.matrix({"C", "c"}, expected.C, true);
  return match.greatest();
}

ProgramMatch matchProgram(const Matrices& program, const std::set<std::size_t>& equalities,
                          const TrackingProblem& problem, const ExpectedProgram& expected,
                          const mpq_class& tolerance) {
  Ranges ranges, inputs;
  for (const TrackingProblem::Parameter& parameter : problem.parameters)
    if (!parameter.fixed) ranges.emplace_back(parameter.range.lower, parameter.range.upper);
  for (const TrackingProblem::Range& input : problem.inputs) inputs.emplace_back(input.lower, input.upper);
  requireSizes(program, expected.H.rows(), program.at("A").rows, ranges.size(), expected.C.rows());
  RoundingEffect effect(program, ranges, inputs, problem.blocks.size() * inputs.size());
  ProgramMatch match;
  match.riccati_residual = expected.riccati_residual;
  match.difference = matchProgram(program, equalities, ranges, expected, tolerance, &effect);
  effect.addCost(expected);
  match.effect = effect.ofInputs(expected.C);
  char share[32];
  std::snprintf(share, sizeof share, "%.3g", match.effect.get_d());
  require(match.effect <= kGreatestEffect,
          std::string("rounding of the program may change an input by ") + share + " of its range");
  return match;
}

ProgramMatch matchProgram(const Matrices& program, const std::set<std::size_t>& equalities,
                          const TrackingProblem& problem, const mpq_class& tolerance) {
  const std::size_t nu = problem.inputs.size();
  const bool may_feed_back = isBlockDiagonal(program.at("H"), problem.blocks.size() * nu, nu);
  try {
    return matchProgram(program, equalities, problem, expectedProgram(problem), tolerance);
  } catch (const Refused&) {
    if (!may_feed_back) throw;
  }
  ProgramMatch match = matchProgram(program, equalities, problem,
                                    expectedProgram(problem, Variables::kBesideFeedback), tolerance);
  match.variables = Variables::kBesideFeedback;
  return match;
}

}  // namespace checker
