#include "problem/filter_match.hpp"

#include "problem/fields.hpp"
#include "problem/optimal_control.hpp"
#include "problem/program_match.hpp"

namespace checker {
namespace {

/// Minimise sum of weight (u - wish)^2 / 2 over z = u, theta = (xi, wish).
class FilterProgram {
 public:
  explicit FilterProgram(const FilterProblem& problem)
      : problem_(problem), nu_(problem.inputCount()), n_(problem.size()), p_(n_ + nu_) {}

  ExpectedProgram run() {
    result_.H = BallMatrix(nu_, nu_);
    result_.F = BallMatrix(nu_, p_ + 1);
    result_.C = BallMatrix(nu_, p_ + 1);
    for (std::size_t j = 0; j < nu_; ++j) {
      result_.H.at(j, j) = Ball(Fraction(problem_.weights[j]));
      result_.F.at(j, n_ + j) = -result_.H.at(j, j);
      addInputBound(j, 1, problem_.inputs[j].second);
      addInputBound(j, -1, -problem_.inputs[j].first);
    }
    for (std::size_t i = 0; i < problem_.G.rows; ++i) {
      ExpectedRow row = emptyRow(problem_.b.at(i, 0));
      for (std::size_t j = 0; j < nu_; ++j) row.on_z[j] = Ball(problem_.G.at(i, j));
      for (std::size_t j = 0; j < n_; ++j) row.on_theta[j] = Ball(problem_.M.at(i, j));
      result_.rows.push_back(row);
    }
    return result_;
  }

 private:
  ExpectedRow emptyRow(const Fraction& bound) const {
    return {std::vector<Ball>(nu_), std::vector<Ball>(p_), Ball(bound)};
  }

  void addInputBound(std::size_t j, int sign, double bound) {
    ExpectedRow row = emptyRow(Fraction(bound));
    row.on_z[j] = Ball(sign);
    result_.rows.push_back(row);
  }

  const FilterProblem& problem_;
  const std::size_t nu_, n_, p_;
  ExpectedProgram result_;
};

}  // namespace

bool isCompletedText(const std::string& whole, const std::string& file) {
  if (whole.compare(0, file.size(), file) != 0) return false;
  const std::string rest = whole.substr(file.size());
  if ((file.empty() || file.back() != '\n') && (rest.empty() || rest.front() != '\n')) return false;
  try {
    const YAML::Node added = documentOf(rest);
    return added.IsMap() && added.size() == 1 && added["safe_set"];
  } catch (const YAML::Exception&) {
    return false;
  }
}

void matchFilter(const Matrices& program, const FilterProblem& problem) {
  std::vector<std::pair<double, double>> ranges = problem.states;
  if (problem.hasDelay()) ranges.insert(ranges.end(), problem.inputs.begin(), problem.inputs.end());
  ranges.insert(ranges.end(), problem.wishes.begin(), problem.wishes.end());
  matchProgram(program, {}, ranges, FilterProgram(problem).run(), 0);
}

}  // namespace checker
