#pragma once

#include <vector>

#include "polytope_sets/double_description.hpp"
#include "polytope_sets/rational.hpp"

namespace polyfly {

/// a . x <= b, or a . x = b where it stands for an equality.
struct ExactHalfSpace {
  RationalVector a;
  Rational b;
};

/// Whole numbers r without a common factor: r . (x_0, x) >= 0 where a . x / x_0 <= b.
std::vector<Integer> coneRow(const ExactHalfSpace& row);

/// Whole numbers without a common factor in the proportions of (1, x).
std::vector<Integer> homogeneous(const RationalVector& point);

/// x / x_0 of (x_0, x); x where x_0 = 0.
RationalVector pointOf(const std::vector<Integer>& ray);

/// {x : a . x <= b for all rows, a . x = b for all equalities}, in exact fractions. May be empty, flat,
/// unbounded, and described by more rows than it needs.
struct ExactPolytope {
  int dimension = 0;
  std::vector<ExactHalfSpace> rows;
  std::vector<ExactHalfSpace> equalities;

  static ExactPolytope box(const RationalVector& lower, const RationalVector& upper);
};

/// The polyhedron's generators: all x = convex combination of vertices + sum of rays with weights >= 0 + any
/// combination of lines. Vertices are unique only where there is no line. Empty: no vertex.
struct Generators {
  std::vector<RationalVector> vertices;
  std::vector<RationalVector> rays;
  std::vector<RationalVector> lines;
};

/// Exact generators, by double description: any dimension; the cost grows with the number of vertices met on
/// the way, see DoubleDescription.
Generators generators(const ExactPolytope& set);

/// Vertices of a set that must be bounded. Throws Error when it is not. Empty: none.
std::vector<RationalVector> vertices(const ExactPolytope& set);

/// The least polyhedron with these generators, without redundant rows; no vertex gives the empty set. Throws
/// Error when a generator does not have `dimension` entries.
ExactPolytope hull(int dimension, const Generators& generators);
ExactPolytope hull(int dimension, const std::vector<RationalVector>& points);

/// The same set without redundant rows. Each row left is a facet, in the order they had, the first of equal ones.
/// What holds with equality everywhere is an equality, each independent of those before. Rows and equalities are
/// scaled to whole numbers without a common factor. The empty set is the one row 0 . x <= -1.
ExactPolytope minimal(const ExactPolytope& set);

/// True also for the empty set.
bool isBounded(const ExactPolytope& set);

/// Dimension of the smallest flat that holds the set; -1 when it is empty.
int affineDimension(const ExactPolytope& set);

bool contains(const ExactPolytope& set, const RationalVector& point);
/// Whether `outer` contains every point of `inner`.
bool contains(const ExactPolytope& outer, const ExactPolytope& inner);
/// Whether both sets have the same points.
bool equal(const ExactPolytope& first, const ExactPolytope& second);

/// The operations below throw Error when dimensions do not fit; their results are minimal (see minimal)
/// except for intersect and preimage.
ExactPolytope intersect(const ExactPolytope& first, const ExactPolytope& second);

/// {x : M x + m in set}.
ExactPolytope preimage(const ExactPolytope& set, const RationalMatrix& M, const RationalVector& m = {});

/// {x_keep : x in set}, coordinates in the order of `keep` (from 0, each at most once). Fourier and Motzkin's elimination,
/// one coordinate at a time, with redundant rows removed after each. It is good for few dropped coordinates of a set with
/// many vertices. A step can square the number of rows before they are removed.
ExactPolytope project(const ExactPolytope& set, const std::vector<int>& keep);

/// Simplices that make up a bounded set with interior, each by `dimension` + 1 places among its vertices (Cohen and Hickey,
/// 1979). Where two touch, they share a face.
std::vector<std::vector<std::size_t>> triangulate(const ExactPolytope& set,
                                                  const std::vector<RationalVector>& vertices);

}  // namespace polyfly
