#include "polytope_sets/polytope.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lp/polytope.hpp"
#include "polyfly_base/error.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

std::vector<double> flatRows(const Polytope& set) {
  std::vector<double> rows;
  for (int i = 0; i < set.rowCount(); ++i) {
    for (int j = 0; j < set.dimension(); ++j) rows.push_back(set.A(i, j));
    rows.push_back(set.b[i]);
  }
  return rows;
}

/// Collects rows, at length 1, each once.
class RowList {
 public:
  explicit RowList(int dimension) : dimension_(dimension) {}

  // False when the row alone makes the set empty.
  bool add(const Eigen::VectorXd& a, double b, double scale) {
    const double length = a.norm();
    if (length <= tolerance::kZeroEntry * scale) return b >= -tolerance::kZeroEntry * scale;
    Eigen::VectorXd row(dimension_ + 1);
    row << a / length, b / length;
    for (Eigen::VectorXd& other : rows_) {
      if ((other.head(dimension_) - row.head(dimension_)).cwiseAbs().maxCoeff() > tolerance::kSameRow)
        continue;
      other[dimension_] = std::min(other[dimension_], row[dimension_]);
      return true;
    }
    rows_.push_back(std::move(row));
    return true;
  }

  Polytope set() const {
    Polytope result;
    result.A.resize(static_cast<Eigen::Index>(rows_.size()), dimension_);
    result.b.resize(result.A.rows());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      result.A.row(static_cast<Eigen::Index>(i)) = rows_[i].head(dimension_).transpose();
      result.b[static_cast<Eigen::Index>(i)] = rows_[i][dimension_];
    }
    return result;
  }

 private:
  int dimension_;
  std::vector<Eigen::VectorXd> rows_;
};

}  // namespace

Polytope rounded(const ExactPolytope& set) {
  RowList rows(set.dimension);
  const auto add = [&](const ExactHalfSpace& row, double sign) {
    Rational greatest = abs(row.b);
    for (const Rational& value : row.a) greatest = std::max(greatest, Rational(abs(value)));
    if (greatest == 0) return;
    Eigen::VectorXd a(set.dimension);
    for (int j = 0; j < set.dimension; ++j)
      a[j] = sign * nearestDouble(Rational(row.a[static_cast<std::size_t>(j)] / greatest));
    if (rows.add(a, sign * nearestDouble(Rational(row.b / greatest)), 1.0)) return;
    a.setZero();  // 0 . x <= -1 as x_0 <= -1 and x_0 >= 1
    for (const double side : {1.0, -1.0}) {
      a[0] = side;
      rows.add(a, -1.0, 1.0);
    }
  };
  for (const ExactHalfSpace& row : set.rows) add(row, 1.0);
  for (const ExactHalfSpace& row : set.equalities) {
    add(row, 1.0);
    add(row, -1.0);
  }
  return rows.set();
}

ExactPolytope exactly(const Polytope& set) {
  ExactPolytope result;
  result.dimension = set.dimension();
  for (int i = 0; i < set.rowCount(); ++i) {
    ExactHalfSpace row;
    for (int j = 0; j < set.dimension(); ++j) row.a.emplace_back(set.A(i, j));
    row.b = Rational(set.b[i]);
    result.rows.push_back(std::move(row));
  }
  return result;
}

Ball chebyshevBall(const Polytope& set) {
  PolytopeSolver solver(set.dimension());
  Ball ball{Eigen::VectorXd::Zero(set.dimension()), 0.0};
  if (!solver.chebyshev(flatRows(set).data(), set.rowCount(), ball.centre.data(), ball.radius))
    throw Error("polytope: inscribed ball: the set is unbounded, or the simplex method failed");
  return ball;
}

double support(const Polytope& set, const Eigen::VectorXd& inside, const Eigen::VectorXd& direction) {
  PolytopeSolver solver(set.dimension());
  Eigen::VectorXd point(set.dimension());
  if (!solver.support(flatRows(set).data(), set.rowCount(), inside.data(), direction.data(), point.data()))
    throw Error("polytope: support: the simplex method failed");
  return direction.dot(point);
}

Polytope minimal(const Polytope& set, double tolerance) {
  const Ball ball = chebyshevBall(set);
  if (ball.radius <= 0.0) throw Error("polytope: redundant rows: the set has no interior");
  PolytopeSolver solver(set.dimension());
  MinimalRows found;
  if (!solver.minimal(flatRows(set).data(), set.rowCount(), ball.centre.data(), tolerance, found))
    throw Error("polytope: redundant rows: the simplex method failed");
  Polytope result;
  result.A.resize(static_cast<Eigen::Index>(found.facets.size()), set.dimension());
  result.b.resize(result.A.rows());
  for (std::size_t k = 0; k < found.facets.size(); ++k) {
    result.A.row(static_cast<Eigen::Index>(k)) = set.A.row(found.facets[k]);
    result.b[static_cast<Eigen::Index>(k)] = set.b[found.facets[k]];
  }
  return result;
}

Polytope eliminate(const Polytope& set, int column, double tolerance) {
  const int n = set.dimension();
  RowList rows(n - 1);
  const auto drop = [&](const Eigen::VectorXd& a) {
    Eigen::VectorXd result(n - 1);
    result << a.head(column), a.tail(n - 1 - column);
    return result;
  };
  bool possible = true;
  for (int i = 0; i < set.rowCount(); ++i) {
    const double up = set.A(i, column);
    if (std::abs(up) <= tolerance::kZeroEntry)
      possible = rows.add(drop(set.A.row(i).transpose()), set.b[i], 1.0) && possible;
    if (up <= tolerance::kZeroEntry) continue;
    for (int k = 0; k < set.rowCount(); ++k) {
      const double down = -set.A(k, column);
      if (down <= tolerance::kZeroEntry) continue;
      possible = rows.add(drop((down * set.A.row(i) + up * set.A.row(k)).transpose()),
                          down * set.b[i] + up * set.b[k], up + down) &&
                 possible;
    }
  }
  if (!possible) throw Error("polytope: elimination: the set is empty");
  return minimal(rows.set(), tolerance);
}

}  // namespace polyfly
