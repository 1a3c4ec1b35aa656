#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "map_export/export_online.hpp"

namespace polyfly {

enum class OnlineStatus { kOk, kInfeasible, kNotFinite, kIterations };

/// The generated solver, operation for operation, so that its iterations can be counted. A test compares
/// it with the compiled code bit for bit. Real is double or float.
template <class Real>
class OnlineSolver {
 public:
  OnlineSolver(const OnlineTables& tables, const OnlineTolerances& tolerances, std::uint32_t iteration_limit)
      : parameters_(tables.parameters.size()),
        inputs_(tables.inputs.size()),
        variables_(tables.variables),
        side_count_(tables.sideCount()),
        active_limit_(tables.activeLimit()),
        iteration_limit_(iteration_limit),
        sides_(tables.sides),
        rows_(rounded(tables.rows)),
        limits_(rounded(tables.limits)),
        conditions_(rounded(tables.conditions)),
        law_(rounded(tables.law)),
        effect_(rounded(tables.effect)),
        feasible_(rounded(tolerances.feasible)),
        active_slack_(static_cast<Real>(tolerances.active_slack)),
        dependent_(static_cast<Real>(tolerances.dependent)),
        rate_zero_(static_cast<Real>(tolerances.rate)),
        limit_(side_count_),
        point_(variables_),
        direction_(variables_),
        multiplier_(active_limit_ + 1),
        rate_(active_limit_ + 1),
        pivot_(active_limit_ + 1),
        factor_(static_cast<std::size_t>(active_limit_) * (active_limit_ + 1) / 2),
        active_(active_limit_ + 1) {}

  /// theta p numbers, u m numbers; u is unchanged without kOk.
  OnlineStatus solve(const Real* theta, Real* u) {
    OnlineStatus status = start(theta);
    std::uint32_t side = mostViolated();
    while (status == OnlineStatus::kOk && side < side_count_) {
      status = admit(side);
      if (status != OnlineStatus::kOk) break;
      side = mostViolated();
      if (side == side_count_) {
        status = refresh();
        side = mostViolated();
      }
    }
    return status == OnlineStatus::kOk ? finish(theta, u) : status;
  }

  std::uint32_t iterations() const { return iterations_; }

 private:
  static std::vector<Real> rounded(const std::vector<double>& values) {
    return std::vector<Real>(values.begin(), values.end());
  }

  const Real* row(std::uint32_t side) const {
    return &rows_[static_cast<std::size_t>(side >> 1) * variables_];
  }

  Real affine(const Real* coefficients, const Real* theta) {
    Real sum = coefficients[parameters_];
    for (std::size_t i = 0; i < parameters_; ++i) sum += coefficients[i] * theta[i];
    return sum;
  }

  Real dot(const Real* a, const Real* b) {
    Real sum = 0;
    for (std::size_t i = 0; i < variables_; ++i) sum += a[i] * b[i];
    return sum;
  }

  void add(std::vector<Real>& y, Real factor, std::uint32_t side) {
    const Real signed_factor = (side & 1u) != 0 ? -factor : factor;
    for (std::size_t i = 0; i < variables_; ++i) y[i] += signed_factor * row(side)[i];
  }

  Real along(std::uint32_t side, const Real* v) {
    const Real product = dot(row(side), v);
    return (side & 1u) != 0 ? -product : product;
  }

  void factoriseRow(std::size_t k) {
    const std::uint32_t side = sides_[active_[k]];
    const std::size_t first = k * (k + 1) / 2 - k;
    std::size_t first_j = 0;
    for (std::size_t j = 0; j < k; ++j) {
      Real sum = along(sides_[active_[j]], row(side));
      if ((side & 1u) != 0) sum = -sum;
      for (std::size_t i = 0; i < j; ++i) sum -= factor_[first + i] * factor_[first_j + i];
      factor_[first + j] = sum;
      first_j += j;
    }
    Real pivot = 1;
    for (std::size_t j = 0; j < k; ++j) {
      const Real product = factor_[first + j];
      factor_[first + j] = product / pivot_[j];
      pivot -= factor_[first + j] * product;
    }
    pivot_[k] = pivot;
  }

  void solveTransposed(std::vector<Real>& x, std::size_t count) {
    for (std::size_t j = count; j > 1; --j) {
      const std::size_t first = j * (j - 1) / 2 - (j - 1);
      for (std::size_t i = 0; i + 1 < j; ++i) x[i] -= factor_[first + i] * x[j - 1];
    }
  }

  void drop(std::size_t position, std::size_t last) {
    for (std::size_t j = position; j < last; ++j) {
      active_[j] = active_[j + 1];
      multiplier_[j] = multiplier_[j + 1];
    }
    --active_count_;
    for (std::size_t j = position; j < active_count_; ++j) factoriseRow(j);
  }

  bool isActive(std::uint32_t side) const {
    for (std::size_t j = 0; j < active_count_; ++j) {
      if (active_[j] == side) return true;
    }
    return false;
  }

  std::uint32_t mostViolated() {
    std::uint32_t worst = side_count_;
    Real least = 0;
    Real value = 0;
    std::uint32_t last = std::numeric_limits<std::uint32_t>::max();
    for (std::uint32_t s = 0; s < side_count_; ++s) {
      if (sides_[s] >> 1 != last) {
        value = dot(row(sides_[s]), point_.data());
        last = sides_[s] >> 1;
      }
      const Real slack = limit_[s] + ((sides_[s] & 1u) != 0 ? value : -value);
      if (slack < least && slack < -feasible_[s] && (slack < -active_slack_ * feasible_[s] || !isActive(s))) {
        least = slack;
        worst = s;
      }
    }
    return worst;
  }

  std::size_t blockingPosition(Real& step) {
    std::size_t position = active_count_;
    step = std::numeric_limits<Real>::max();
    for (std::size_t j = 0; j < active_count_; ++j) {
      if (!(rate_[j] > rate_zero_)) continue;
      const Real to_zero = multiplier_[j] / rate_[j];
      if (to_zero < step) {
        step = to_zero;
        position = j;
      }
    }
    return position;
  }

  void direct(std::uint32_t entering) {
    const std::size_t count = active_count_;
    const std::size_t first = count * (count + 1) / 2 - count;
    for (std::size_t j = 0; j < count; ++j) rate_[j] = factor_[first + j];
    solveTransposed(rate_, count);
    direction_.assign(variables_, 0);
    add(direction_, -1, sides_[entering]);
    for (std::size_t j = 0; j < count; ++j) add(direction_, rate_[j], sides_[active_[j]]);
  }

  OnlineStatus admit(std::uint32_t entering) {
    active_[active_count_] = entering;
    multiplier_[active_count_] = 0;
    for (;;) {
      const std::size_t count = active_count_;
      if (iterations_ >= iteration_limit_) return OnlineStatus::kIterations;
      ++iterations_;
      factoriseRow(count);
      direct(entering);
      Real step = 0;
      const std::size_t blocking = blockingPosition(step);
      const bool is_independent = count < active_limit_ && pivot_[count] > dependent_;
      Real full_step = std::numeric_limits<Real>::max();
      if (is_independent) {
        const Real slack = limit_[entering] - along(sides_[entering], point_.data());
        full_step = slack < 0 ? -slack / pivot_[count] : 0;
      }
      if (!is_independent && blocking == count) return OnlineStatus::kInfeasible;
      const bool is_in = is_independent && full_step <= step;
      if (is_in) step = full_step;
      for (std::size_t j = 0; j < count; ++j) multiplier_[j] -= step * rate_[j];
      multiplier_[count] += step;
      if (is_independent) {
        for (std::size_t j = 0; j < variables_; ++j) point_[j] += step * direction_[j];
      }
      if (is_in) {
        active_count_ = count + 1;
        return OnlineStatus::kOk;
      }
      drop(blocking, count);
    }
  }

  void solveFactor(std::vector<Real>& x) {
    std::size_t first = 0;
    for (std::size_t j = 0; j < active_count_; ++j) {
      for (std::size_t i = 0; i < j; ++i) x[j] -= factor_[first + i] * x[i];
      first += j;
    }
    for (std::size_t j = 0; j < active_count_; ++j) x[j] /= pivot_[j];
    solveTransposed(x, active_count_);
  }

  void solveActive() {
    point_.assign(variables_, 0);
    for (std::size_t j = 0; j < active_count_; ++j) multiplier_[j] = 0;
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t j = 0; j < active_count_; ++j)
        rate_[j] = along(sides_[active_[j]], point_.data()) - limit_[active_[j]];
      solveFactor(rate_);
      for (std::size_t j = 0; j < active_count_; ++j) {
        multiplier_[j] += rate_[j];
        add(point_, -rate_[j], sides_[active_[j]]);
      }
    }
  }

  OnlineStatus refresh() {
    OnlineStatus status = OnlineStatus::kOk;
    for (;;) {
      Real least = 0;
      std::size_t worst = active_count_;
      solveActive();
      for (std::size_t j = 0; j < active_count_; ++j) {
        if (multiplier_[j] < least) {
          least = multiplier_[j];
          worst = j;
        }
      }
      if (worst == active_count_) break;
      if (iterations_ >= iteration_limit_) {
        status = OnlineStatus::kIterations;
        break;
      }
      ++iterations_;
      drop(worst, active_count_ - 1);
    }
    return status;
  }

  OnlineStatus start(const Real* theta) {
    OnlineStatus status = OnlineStatus::kOk;
    iterations_ = 0;
    active_count_ = 0;
    point_.assign(variables_, 0);
    for (std::uint32_t i = 0; i < side_count_; ++i) {
      limit_[i] = affine(&limits_[i * (parameters_ + 1)], theta);
      if (!std::isfinite(limit_[i])) status = OnlineStatus::kNotFinite;
    }
    for (std::size_t i = 0; i < parameters_; ++i) {
      if (!std::isfinite(theta[i])) status = OnlineStatus::kNotFinite;
    }
    for (std::size_t i = 0; i < conditions_.size() && status == OnlineStatus::kOk; i += parameters_ + 1) {
      if (affine(&conditions_[i], theta) < 0) status = OnlineStatus::kInfeasible;
    }
    return status;
  }

  OnlineStatus finish(const Real* theta, Real* u) {
    std::vector<Real> values(inputs_);
    for (std::size_t j = 0; j < inputs_; ++j) {
      values[j] = affine(&law_[j * (parameters_ + 1)], theta) + dot(&effect_[j * variables_], point_.data());
      if (!std::isfinite(values[j])) return OnlineStatus::kNotFinite;
    }
    for (std::size_t j = 0; j < inputs_; ++j) u[j] = values[j];
    return OnlineStatus::kOk;
  }

  std::size_t parameters_, inputs_, variables_;
  std::uint32_t side_count_, active_limit_, iteration_limit_;
  std::vector<std::uint32_t> sides_;
  std::vector<Real> rows_, limits_, conditions_, law_, effect_;
  std::vector<Real> feasible_;
  Real active_slack_, dependent_, rate_zero_;
  std::vector<Real> limit_, point_, direction_, multiplier_, rate_, pivot_, factor_;
  std::vector<std::uint32_t> active_;
  std::size_t active_count_ = 0;
  std::uint32_t iterations_ = 0;
};

}  // namespace polyfly
