// The linear part of HorizonQp: Riccati recursion, roll-out, responses to unit multipliers. All O(N).
#include <cmath>

#include "fixedwing_lateral/horizon_qp.hpp"

namespace polyfly {
namespace {

constexpr int kNorth = 0;
constexpr int kEast = 1;
constexpr int kHeading = 2;
constexpr int kRoll = 3;
constexpr int kRate = 4;
constexpr int kStates = 5;

/// The upper triangle of a symmetric matrix over (n, e, psi, phi, p).
struct Symmetric {
  double nn, ne, nh, nr, np, ee, eh, er, ep, hh, hr, hp, rr, rp, pp;
};

struct Column {
  double n, e, h, r, p;
};

inline Column times(const Symmetric& P, const Column& v) noexcept {
  return {P.nn * v.n + P.ne * v.e + P.nh * v.h + P.nr * v.r + P.np * v.p,
          P.ne * v.n + P.ee * v.e + P.eh * v.h + P.er * v.r + P.ep * v.p,
          P.nh * v.n + P.eh * v.e + P.hh * v.h + P.hr * v.r + P.hp * v.p,
          P.nr * v.n + P.er * v.e + P.hr * v.h + P.rr * v.r + P.rp * v.p,
          P.np * v.n + P.ep * v.e + P.hp * v.h + P.rp * v.r + P.pp * v.p};
}

inline double dot(const Column& a, const Column& b) noexcept {
  return a.n * b.n + a.e * b.e + a.h * b.h + a.r * b.r + a.p * b.p;
}

/// A' y for the structure of HorizonStage.
inline void transposed(const HorizonStage& stage, const RollTransition& roll, const double* y,
                       double* result) noexcept {
  const double heading = y[kHeading] + stage.n_psi * y[kNorth] + stage.e_psi * y[kEast];
  const double bank = stage.n_phi * y[kNorth] + stage.e_phi * y[kEast] + stage.psi_phi * y[kHeading] +
                      roll.phi_phi * y[kRoll] + roll.p_phi * y[kRate];
  const double rate = stage.n_p * y[kNorth] + stage.e_p * y[kEast] + stage.psi_p * y[kHeading] +
                      roll.phi_p * y[kRoll] + roll.p_p * y[kRate];
  result[kNorth] = y[kNorth];
  result[kEast] = y[kEast];
  result[kHeading] = heading;
  result[kRoll] = bank;
  result[kRate] = rate;
}

/// B' y.
inline double alongInput(const HorizonStage& stage, const RollTransition& roll, const double* y) noexcept {
  return stage.n_u * y[kNorth] + stage.e_u * y[kEast] + stage.psi_u * y[kHeading] + roll.phi_u * y[kRoll] +
         roll.p_u * y[kRate];
}

inline double dot(const double* a, const double* b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4];
}

/// A x + B u.
inline void advance(const HorizonStage& stage, const RollTransition& roll, const double* x, double u,
                    double* next) noexcept {
  next[kNorth] =
      x[kNorth] + stage.n_psi * x[kHeading] + stage.n_phi * x[kRoll] + stage.n_p * x[kRate] + stage.n_u * u;
  next[kEast] =
      x[kEast] + stage.e_psi * x[kHeading] + stage.e_phi * x[kRoll] + stage.e_p * x[kRate] + stage.e_u * u;
  next[kHeading] = x[kHeading] + stage.psi_phi * x[kRoll] + stage.psi_p * x[kRate] + stage.psi_u * u;
  next[kRoll] = roll.phi_phi * x[kRoll] + roll.phi_p * x[kRate] + roll.phi_u * u;
  next[kRate] = roll.p_phi * x[kRoll] + roll.p_p * x[kRate] + roll.p_u * u;
}

Symmetric weightOf(const HorizonStage& stage) noexcept {
  return {stage.Q_nn, stage.Q_ne,     stage.Q_npsi, 0.0, 0.0,         stage.Q_ee, stage.Q_epsi, 0.0,
          0.0,        stage.Q_psipsi, 0.0,          0.0, stage.Q_phi, 0.0,        stage.Q_p};
}

}  // namespace

bool HorizonQp::recursion() noexcept {
  Symmetric P = weightOf(stages_[N_]);
  double p[kStates];
  for (int i = 0; i < kStates; ++i) p[i] = stages_[N_].q[i];
  for (int k = N_ - 1; k >= 0; --k) {
    const HorizonStage& s = stages_[k];
    Gain& gain = gains_[k];
    const Column P_gap = times(P, {s.gap[0], s.gap[1], s.gap[2], s.gap[3], s.gap[4]});
    // Columns of A and B; those of n and e are unit vectors.
    const Column heading{s.n_psi, s.e_psi, 1.0, 0.0, 0.0};
    const Column bank{s.n_phi, s.e_phi, s.psi_phi, roll.phi_phi, roll.p_phi};
    const Column rate{s.n_p, s.e_p, s.psi_p, roll.phi_p, roll.p_p};
    const Column input{s.n_u, s.e_u, s.psi_u, roll.phi_u, roll.p_u};
    const Column P_heading{P.nn * s.n_psi + P.ne * s.e_psi + P.nh, P.ne * s.n_psi + P.ee * s.e_psi + P.eh,
                           P.nh * s.n_psi + P.eh * s.e_psi + P.hh, 0.0, 0.0};
    const Column P_bank = times(P, bank);
    const Column P_rate = times(P, rate);
    const Column P_input = times(P, input);
    const double D = s.R + dot(input, P_input);
    if (!(D > 0.0) || !std::isfinite(D)) return false;
    const double D_inverse = 1.0 / D;
    const Column BPA{P_input.n, P_input.e, dot(heading, P_input), dot(bank, P_input), dot(rate, P_input)};
    const Column K{-D_inverse * BPA.n, -D_inverse * BPA.e, -D_inverse * BPA.h, -D_inverse * BPA.r,
                   -D_inverse * BPA.p};
    gain.K[kNorth] = K.n;
    gain.K[kEast] = K.e;
    gain.K[kHeading] = K.h;
    gain.K[kRoll] = K.r;
    gain.K[kRate] = K.p;
    gain.D_inverse = D_inverse;
    Symmetric next;
    next.nn = s.Q_nn + P.nn + K.n * BPA.n;
    next.ne = s.Q_ne + P.ne + K.n * BPA.e;
    next.ee = s.Q_ee + P.ee + K.e * BPA.e;
    next.nh = s.Q_npsi + P_heading.n + K.n * BPA.h;
    next.eh = s.Q_epsi + P_heading.e + K.e * BPA.h;
    next.hh = s.Q_psipsi + s.n_psi * P_heading.n + s.e_psi * P_heading.e + P_heading.h + K.h * BPA.h;
    next.nr = P_bank.n + K.n * BPA.r;
    next.er = P_bank.e + K.e * BPA.r;
    next.hr = dot(heading, P_bank) + K.h * BPA.r;
    next.rr = s.Q_phi + dot(bank, P_bank) + K.r * BPA.r;
    next.np = P_rate.n + K.n * BPA.p;
    next.ep = P_rate.e + K.e * BPA.p;
    next.hp = dot(heading, P_rate) + K.h * BPA.p;
    next.rp = dot(bank, P_rate) + K.r * BPA.p;
    next.pp = s.Q_p + dot(rate, P_rate) + K.p * BPA.p;
    P = next;

    // The linear term of the cost to go, and with it the move's constant part.
    const double y[kStates] = {p[kNorth] + P_gap.n, p[kEast] + P_gap.e, p[kHeading] + P_gap.h,
                               p[kRoll] + P_gap.r, p[kRate] + P_gap.p};
    const double h = s.r + alongInput(s, roll, y);
    feedforward_[k] = -h * D_inverse;
    transposed(s, roll, y, p);
    for (int i = 0; i < kStates; ++i) p[i] += s.q[i] + gain.K[i] * h;
  }
  return std::isfinite(dot(p, p));
}

void HorizonQp::rollOut(const double* x_0) noexcept {
  double* x = x_.data();
  for (int i = 0; i < kStates; ++i) x[i] = x_0[i];
  for (int k = 0; k < N_; ++k) {
    const HorizonStage& stage = stages_[k];
    const double u = dot(gains_[k].K, x) + feedforward_[k];
    advance(stage, roll, x, u, x + kStates);
    x += kStates;
    for (int i = 0; i < kStates; ++i) x[i] += stage.gap[i];
    free_value_[k] = u;
    free_value_[N_ + k] = x[kRoll];
  }
}

void HorizonQp::followMoves(const double* x_0) noexcept {
  double* x = x_.data();
  for (int i = 0; i < kStates; ++i) x[i] = x_0[i];
  for (int k = 0; k < N_; ++k) {
    advance(stages_[k], roll, x, value_[k], x + kStates);
    x += kStates;
    for (int i = 0; i < kStates; ++i) x[i] += stages_[k].gap[i];
  }
}

// Column `channel`: how moves and roll answer to a unit of reward for the channel's value.
void HorizonQp::respond(int channel) noexcept {
  double* answer = &responses_[static_cast<std::size_t>(channel) * channels_];
  const bool is_move = channel < N_;
  // Last move on which the channel depends.
  const int last = is_move ? channel : channel - N_;
  double y[kStates] = {0.0, 0.0, 0.0, is_move ? 0.0 : -1.0, 0.0};
  for (int k = last; k >= 0; --k) {
    const double h = alongInput(stages_[k], roll, y) - (is_move && k == last ? 1.0 : 0.0);
    feedforward_response_[k] = -h * gains_[k].D_inverse;
    double p[kStates];
    transposed(stages_[k], roll, y, p);
    for (int i = 0; i < kStates; ++i) y[i] = p[i] + gains_[k].K[i] * h;
  }
  double x[kStates] = {0.0, 0.0, 0.0, 0.0, 0.0};
  for (int k = 0; k < N_; ++k) {
    const double u = dot(gains_[k].K, x) + (k <= last ? feedforward_response_[k] : 0.0);
    double next[kStates];
    advance(stages_[k], roll, x, u, next);
    for (int i = 0; i < kStates; ++i) x[i] = next[i];
    answer[k] = u;
    answer[N_ + k] = x[kRoll];
  }
}

}  // namespace polyfly
