#include "condensed_oracle.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace polyfly {
namespace {

using Real = mpf_class;
using Rows = std::vector<std::vector<Real>>;
constexpr unsigned long kBits = 600;

Real real(double value) { return Real(value, kBits); }

Rows zero(std::size_t rows, std::size_t columns) { return Rows(rows, std::vector<Real>(columns, real(0.0))); }

Rows product(const Rows& a, const Rows& b) {
  Rows result = zero(a.size(), b.front().size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.front().size(); ++j)
      for (std::size_t k = 0; k < b.size(); ++k) result[i][j] += a[i][k] * b[k][j];
  return result;
}

Rows transposed(const Rows& a) {
  Rows result = zero(a.front().size(), a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < a[i].size(); ++j) result[j][i] = a[i][j];
  return result;
}

/// The solution of a system with one right-hand side, by elimination.
std::vector<Real> solved(Rows a, std::vector<Real> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = k;
    for (std::size_t i = k; i < n; ++i)
      if (abs(a[i][k]) > abs(a[best][k])) best = i;
    if (a[best][k] == 0) throw std::runtime_error("a singular system");
    std::swap(a[k], a[best]);
    std::swap(b[k], b[best]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const Real factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

Rows sum(Rows a, const Rows& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < a[i].size(); ++j) a[i][j] += b[i][j];
  return a;
}

Rows identity(std::size_t size) {
  Rows result = zero(size, size);
  for (std::size_t i = 0; i < size; ++i) result[i][i] = 1;
  return result;
}

Rows inverse(const Rows& a) {
  Rows columns;
  for (const std::vector<Real>& unit : identity(a.size())) columns.push_back(solved(a, unit));
  return transposed(columns);
}

/// The stabilising solution, by doubling the horizon.
Rows riccati(const Rows& A, const Rows& B, const Rows& Q, const Real& R) {
  constexpr int kMost = 100;
  Rows A_k = A, P = Q, G = product(B, transposed(B));
  for (std::vector<Real>& row : G)
    for (Real& entry : row) entry /= R;
  for (int round = 0; round < kMost; ++round) {
    const Rows W = inverse(sum(identity(A.size()), product(G, P)));
    const Rows step = product(product(transposed(A_k), P), product(W, A_k));
    G = sum(G, product(product(A_k, W), product(G, transposed(A_k))));
    A_k = product(A_k, product(W, A_k));
    P = sum(P, step);
    Real change = real(0.0), size = real(0.0);
    for (std::size_t i = 0; i < P.size(); ++i) {
      for (std::size_t j = 0; j < P.size(); ++j) {
        change = std::max(change, Real(abs(step[i][j])));
        size = std::max(size, Real(abs(P[i][j])));
      }
    }
    if (change * Real("1e50", kBits) <= size) return P;
  }
  throw std::runtime_error("no solution of the Riccati equation");
}

/// min 1/2 z'Hz + gradient'z, |z_k| <= limit, and (z, 1) normal to the rows of `end`.
struct BoundedOptimum {
  const Rows& H;
  const std::vector<Real>& gradient;
  const Rows& end;
  const Real limit;

  /// Where each entry of z is: free (0), at its upper (1) or lower bound (-1).
  using Sides = std::vector<int>;

  /// z, then the multipliers of `end`.
  std::vector<Real> at(const Sides& sides) const {
    const std::size_t N = H.size(), m = end.size();
    Rows system = zero(N + m, N + m);
    std::vector<Real> right(N + m, real(0.0));
    for (std::size_t k = 0; k < N; ++k) {
      if (sides[k] != 0) {
        system[k][k] = 1;
        right[k] = limit * sides[k];
        continue;
      }
      for (std::size_t j = 0; j < N; ++j) system[k][j] = H[k][j];
      for (std::size_t i = 0; i < m; ++i) system[k][N + i] = end[i][k];
      right[k] = -gradient[k];
    }
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < N; ++j) system[N + i][j] = end[i][j];
      right[N + i] = -end[i][N];
    }
    return solved(system, right);
  }

  /// Where the entry has to go from its side; its own side where it may stay.
  int better(const std::vector<Real>& z, std::size_t k, int side) const {
    if (side == 0) return z[k] > limit ? 1 : z[k] < -limit ? -1 : 0;
    Real slope = gradient[k];
    for (std::size_t j = 0; j < H.size(); ++j) slope += H[k][j] * z[j];
    for (std::size_t i = 0; i < end.size(); ++i) slope += end[i][k] * z[H.size() + i];
    return slope * side > 0 ? 0 : side;
  }

  /// All entries change their sides at once; where that goes round in circles, the first one alone, which ends.
  std::vector<Real> find() const {
    constexpr int kTogether = 30, kMost = 2000;
    Sides sides(H.size(), 0);
    for (int round = 0; round < kMost; ++round) {
      const std::vector<Real> z = at(sides);
      bool optimal = true;
      for (std::size_t k = 0; k < H.size() && (optimal || round < kTogether); ++k) {
        const int next = better(z, k, sides[k]);
        optimal = optimal && next == sides[k];
        sides[k] = next;
      }
      if (optimal) return z;
    }
    throw std::runtime_error("no active set is optimal");
  }
};

std::string exact(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

template <typename Numbers>
std::string list(const Numbers& numbers) {
  std::string text = "[";
  for (std::size_t i = 0; i < numbers.size(); ++i) text += (i > 0 ? ", " : "") + exact(numbers[i]);
  return text + "]";
}

}  // namespace

std::string BoundedTracking::text() const {
  std::string states, rows, columns, outputs, parameters;
  for (std::size_t i = 0; i < A.size(); ++i) {
    const std::string name = "x" + std::to_string(i), comma = i > 0 ? ", " : "";
    states += comma + "{name: " + name + ", unit: m}";
    rows += comma + list(A[i]);
    columns += comma + "[" + exact(B[i]) + "]";
    outputs += comma + (i == 0 ? "1" : "0");
    parameters += "  - {name: e_" + name + ", role: error, of: " + name + ", unit: m, range: [" +
                  exact(-ranges[i]) + ", " + exact(ranges[i]) + "]}\n";
  }
  return "polyfly_problem: 1\nname: bounded\ntype: tracking_mpc\nmodel:\n  time: discrete\n  states: [" +
         states + "]\n  inputs: [{name: u, unit: m, range: [" + exact(-limit) + ", " + exact(limit) +
         "]}]\n  A: [" + rows + "]\n  B: [" + columns + "]\n  C: [[" + outputs +
         "]]\nsampling_time: 1\nhorizon: " + std::to_string(horizon) + "\nweights: {Q: " + list(Q) +
         ", R: [" + exact(R) + "]" +
         (ends_at_zero       ? ", terminal: equality"
          : terminal.empty() ? ""
                             : ", terminal: " + list(terminal)) +
         "}\nparameters:\n" + parameters;
}

double BoundedTracking::law(const std::vector<double>& x) const {
  const std::size_t nx = A.size(), N = static_cast<std::size_t>(horizon);
  Rows a = zero(nx, nx), b = zero(nx, 1), q = zero(nx, nx);
  for (std::size_t i = 0; i < nx; ++i) {
    for (std::size_t j = 0; j < nx; ++j) a[i][j] = real(A[i][j]);
    b[i][0] = real(B[i]);
    q[i][i] = real(Q[i]);
  }
  Rows last = zero(nx, nx);
  for (std::size_t i = 0; i < terminal.size(); ++i) last[i][i] = real(terminal[i]);
  if (terminal.empty()) last = riccati(a, b, q, real(R));
  // x_k = (gamma, free), with gamma on z and free from x.
  Rows H = zero(N, N), state = zero(nx, N + 1);
  std::vector<Real> gradient(N, real(0.0));
  for (std::size_t i = 0; i < nx; ++i) state[i][N] = real(x[i]);
  for (std::size_t k = 0; k < N; ++k) {
    state = product(a, state);
    for (std::size_t i = 0; i < nx; ++i) state[i][k] += b[i][0];
    const Rows weighted = product(k + 1 < N ? q : last, state);
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t s = 0; s < nx; ++s) {
        for (std::size_t j = 0; j < N; ++j) H[i][j] += state[s][i] * weighted[s][j];
        gradient[i] += state[s][i] * weighted[s][N];
      }
    }
  }
  for (std::size_t k = 0; k < N; ++k) H[k][k] += real(R);
  Rows end = zero(ends_at_zero ? nx : 0, N + 1);
  if (ends_at_zero) end = state;
  return BoundedOptimum{H, gradient, end, real(limit)}.find()[0].get_d();
}

}  // namespace polyfly
