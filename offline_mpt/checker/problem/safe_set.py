"""The safe set of a safety filter: within the ranges, left by no admissible input, and never without one. Answers of a map,
whose look-ups are proven, keep the state in it."""
from fractions import Fraction

from balls import UNIT, Balls
from exact import dot, require
from filter_model import FilterModel
from polyhedron import Polyhedron, half_space, side, without_entry, without_implied

# Tolerances of the map by which an answer may violate a half-space of its region.
REACH = 8
# Of doubles, and below any of them that is not 0.
ROUNDING = Fraction(1, 1 << 53)
LEAST = Fraction(1, 1 << 1000)


def box_of(ranges, first, size):
    """The sides of ranges of the entries from `first` on."""
    return [side(size, first + j, sign, upper if sign > 0 else -lower)
            for j, (lower, upper) in enumerate(ranges) for sign in (1, -1)]


def confirm_safe_set(problem, progress=lambda *_: None):
    """Shows what "Safety filters" in offline_mpt/checker/README.md says of the set."""
    model = FilterModel(problem)
    safe_set = Polyhedron([half_space(row, bound) for row, bound in zip(problem.H.rows, problem.k)])
    require(safe_set.has_point(), "the safe set is empty")
    require_kept(problem, model)
    # So the set is bounded, too.
    require(all(map(safe_set.is_within, box_of(zip(model.lower, model.upper), 0, problem.size))),
            "the safe set is not within the ranges less errors and excursions")
    rows = rows_with_an_input(problem)
    for i, row in enumerate(rows):
        progress("inputs of the safe set, row", i, len(rows))
        require(safe_set.is_within(row[:problem.size] + row[-1:]), "a state of the safe set has no admissible input")


def greatest_in(value, radius, ends):
    """At least a x, where x is between the ends and a at most the radius from the value, both in units of 2^-BITS."""
    return (max(value * end for end in ends) + radius * max(map(abs, ends))) / UNIT


def require_kept(problem, model):
    """H_i xi+ <= k_i where G_i u <= b_i + M_i xi. For H_i (A xi + B u) = (G_i u - M_i xi) + (H_i A + M_i) xi + (H_i B - G_i) u,
    of which the first term is at most b_i, and the others have little left to multiply."""
    H = Balls.of(problem.H)
    on_xi, on_u = H @ model.A + Balls.of(problem.M), H @ model.B - Balls.of(problem.G)
    constant = H @ model.c
    allowed = [W + slack for W, slack in zip(model.W, model.slack)]
    for i, (row, bound) in enumerate(zip(problem.H.rows, problem.k)):
        following = problem.b[i] + constant.upper(i, 0) + dot(map(abs, row), allowed)
        for value, *ends in zip(on_xi.rows[i], model.lower, model.upper):
            following += greatest_in(value, on_xi.radius, ends)
        for value, ends in zip(on_u.rows[i], problem.inputs):
            following += greatest_in(value, on_u.radius, ends)
        require(following <= bound, f"row {i} of G, b, M does not keep row {i} of H, k")


def rows_with_an_input(problem):
    """What xi must meet so that an admissible input exists. The inputs, entries behind xi, are eliminated one by one."""
    n, nu = problem.size, len(problem.inputs)
    rows = [half_space([*row, *[Fraction(0)] * nu], bound) for row, bound in zip(problem.H.rows, problem.k)]
    rows += [half_space([*(-entry for entry in M), *G], bound)
             for M, G, bound in zip(problem.M.rows, problem.G.rows, problem.b)]
    rows += box_of(problem.inputs, n, n + nu)
    for j in range(nu):
        if j > 0:
            rows = without_implied(rows)
        rows = without_entry(rows, n + j)
    return rows


class Answers:
    """Answers of a map in the safe set."""

    def __init__(self, problem, region_map):
        self._problem, self._map = problem, region_map
        self._n, self._nu = problem.size, len(problem.inputs)
        self._p = self._n + self._nu
        require((region_map.p, region_map.q) == (self._p, self._nu), "the map has another number of signals")
        slack = FilterModel(problem).slack
        # What the margin is worth in each row. Rows without an input hold in all of the safe set.
        self._rows = [(i, problem.b[i] + dot(map(abs, problem.H.rows[i]), slack))
                      for i, row in enumerate(problem.G.rows) if any(row)]
        self._everywhere = box_of([*map(tuple_of_fractions, region_map.bounds[:self._p])], 0, self._p)
        self._everywhere += [half_space([*row, *[Fraction(0)] * self._nu], bound)
                             for row, bound in zip(problem.H.rows, problem.k)]

    def confirm(self, progress):
        """Shows what "Safety filters" in offline_mpt/checker/README.md says of the answers."""
        for r, region in enumerate(self._map.regions):
            if region.active_count == 0:
                self._require_wish(self._map.laws[region.law])
        for r, region in enumerate(self._map.regions):
            progress("answers of region", r, len(self._map.regions))
            self._require_kept(r, region)

    def _require_wish(self, laws):
        """The law without active rows is the wish itself."""
        for j, law in enumerate(laws):
            require(list(law) == [float(k == self._n + j) for k in range(self._p + 1)],
                    "an admissible wish comes back changed")

    def _reach_of(self, region):
        """Where a look-up may answer with the region, and the state is in the safe set."""
        rows = list(self._everywhere)
        for row in self._map.rows[region.first_row:region.first_row + region.row_count]:
            *normal, bound = [Fraction(entry) if row > 0 else -Fraction(entry) for entry in self._map.planes[abs(row) - 1]]
            rows.append(half_space(normal, bound + REACH * Fraction(self._map.tolerance)))
        return Polyhedron(rows)

    def _rounding_of(self, law):
        """Greatest error of the law in binary64, in any order of its sums."""
        total = abs(law[-1]) + sum(abs(entry) * max(map(abs, map(Fraction, ends)))
                                   for entry, ends in zip(law, self._map.bounds))
        require(total * LEAST <= 1, "numbers of the map are too great for doubles")
        return (self._p + 3) * total * ROUNDING + LEAST

    def _error_of(self, reach, law, ends):
        """How far the answer may be from the law, by rounding and where it is limited to the range of the input."""
        rounding, excess = self._rounding_of(law), Fraction(0)
        for sign, end in zip((-1, 1), ends):
            greatest = reach.greatest([sign * entry for entry in law[:-1]])
            require(greatest is not None, "the answers of a region have no bound")
            excess = max(excess, greatest + sign * (law[-1] - end) + rounding)
        return rounding + excess

    def _require_kept(self, r, region):
        """G_i u <= b_i + M_i xi + what the margin is worth in row i."""
        reach = self._reach_of(region)
        if reach.is_empty():
            return
        laws = [[*map(Fraction, law)] for law in self._map.laws[region.law]]
        errors = [self._error_of(reach, law, ends) for law, ends in zip(laws, self._problem.inputs)]
        for i, bound in self._rows:
            G, M = self._problem.G.rows[i], self._problem.M.rows[i]
            *normal, constant = [dot(G, entries) for entries in zip(*laws)]
            for j, entry in enumerate(M):
                normal[j] -= entry
            row = half_space(normal, bound - constant - dot(map(abs, G), errors))
            require(reach.is_within(row), f"an answer of region {r} needs more than the margin of row {i}")


def tuple_of_fractions(ends):
    return tuple(map(Fraction, ends))


def confirm_answers(problem, region_map, progress=lambda *_: None):
    Answers(problem, region_map).confirm(progress)
