#pragma once

/// Tolerances of the independent oracle.
namespace polyfly::tolerance {

/// An input with a greater range has none.
constexpr double kNoRange = 1e100;

/// Greatest residual that counts as solved.
constexpr double kInteriorPointAccuracy = 1e-9;

/// Rank of the factorisations of InteriorPointQp.
constexpr double kInteriorPointRank = 1e-11;

/// A row is active if its multiplier exceeds its slack by one of these factors. They are tried in turn.
constexpr double kActiveBias[] = {1.0, 1e3, 1e-3, 1e6};

/// A smaller residual needs no other guess of the active set.
constexpr double kPolished = 1e-11;

/// From a smaller residual the active set is worth guessing.
constexpr double kPolishStart = 1e-3;

/// A multiplier or slack below minus this changes the active set [scaled].
constexpr double kWrongSign = 1e-12;

/// An LU solution with a smaller residual is trusted.
constexpr double kTrustedSolution = 1e-10;

/// Residual of a row that is only rounding [scaled].
constexpr double kRowRounding = 1e-15;

/// A shorter step is no progress.
constexpr double kStalledStep = 1e-6;

/// Residual at which the Newton iteration ends [scaled].
constexpr double kResidualGoal = 1e-11;

/// Mean complementarity product at which the iteration ends when residuals are small [scaled].
constexpr double kEarlyGapGoal = 1e-12;

/// Mean complementarity product from which on kLateResidualGoal is enough [scaled].
constexpr double kGapGoal = 1e-14;

/// Mean complementarity product that tells multipliers from slacks of 1e-10 [scaled].
constexpr double kCarefulGapGoal = 1e-22;

/// Greatest residual that the final correction can remove [scaled].
constexpr double kLateResidualGoal = 1e-6;

/// The equalities imply a row that is shorter.
constexpr double kImpliedByEqualities = 1e-11;

/// Equalities hold if their error is smaller [scaled].
constexpr double kConsistentEqualities = 1e-9;

/// Added to the diagonal of a normal matrix that is not positive definite.
constexpr double kRegularisation = 1e-14;

/// Size of the multipliers from which on a Farkas certificate is tried [scaled].
constexpr double kCertificateSum = 1e2;

/// A Farkas certificate excludes all solutions up to this norm [scaled].
constexpr double kCertificateRadius = 1e7;

/// Size of the iterates from which on unboundedness is tested [scaled].
constexpr double kRayGrowth = 1e6;

/// Residual of a direction of unlimited descent.
constexpr double kRayTolerance = 1e-7;

/// Two rows are opposite if their entries cancel up to this.
constexpr double kOppositeEntries = 1e-12;

/// A parameter may be this far outside of A_theta theta <= b_theta [scaled].
constexpr double kParameterSet = 1e-9;

/// Least eigenvalue that counts as positive.
constexpr double kLeastEigenvalue = 1e-10;

/// Rank of the equalities.
constexpr double kOracleRank = 1e-11;

/// Greatest residual at which a solution of an auxiliary program is used.
constexpr double kUsableResidual = 1e-9;

/// A greater distance to the feasible set cannot be due to rounding.
constexpr double kCertainDistance = 1e-8;

/// A direction that approaches a face slower never meets it [scaled].
constexpr double kParallelFace = 1e-9;

/// Shorter directions are used up [scaled].
constexpr double kShortDirection = 1e-9;

/// Distances from a face at which parameters are drawn [scaled].
constexpr double kOffsets[] = {0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4};

/// Difference up to which the ranges of map and program are the same.
constexpr double kSameRange = 1e-12;

/// A pivot of squared lengths that is a smaller share of its diagonal entry is rounding of 32 digits.
constexpr double kRankOfSquares = 1e-24;

/// A row moves a multiplier by a smaller share only by rounding of 32 digits [rows of unit length].
constexpr double kNoShare = 1e-16;

/// Multiple of the identity that makes a cost strictly convex, as a share of the greatest entry of H.
constexpr double kRegularisedHessian = 1e-14;

/// Greatest error of u that the check of `solve` accepts, as a share of the input's range.
constexpr double kCheckedError = 1e-6;

/// How much of it each row may be violated by.
constexpr double kCheckedRow = 1e-4;

/// Parameters nearer to the edge of the feasible set may go either way [scaled].
constexpr double kCheckedEdge = 1e-7;

/// Distance behind a facet at which the map is checked [scaled].
constexpr double kCheckedBehind = 1e-6;

/// Outputs that are smaller in all samples count as zero.
constexpr double kNoOutput = 1e-25;

}  // namespace polyfly::tolerance
