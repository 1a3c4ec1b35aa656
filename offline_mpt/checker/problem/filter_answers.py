"""Answers of a safety filter's map, whose look-ups are proven, keep the state in the safe set."""
from fractions import Fraction

from exact import dot, require
from filter_model import FilterModel
from polyhedron import Polyhedron, box_of, half_space

# Tolerances of the map by which an answer may violate a half-space of its region.
REACH = 8
# Of doubles, and below any of them that is not 0.
ROUNDING = Fraction(1, 1 << 53)
LEAST = Fraction(1, 1 << 1000)


class Answers:
    """Shows what "Safety filters" in offline_mpt/checker/README.md says of the answers."""

    def __init__(self, problem, region_map):
        self._problem, self._map = problem, region_map
        self._n, self._p = problem.size, problem.size + len(problem.inputs)
        sizes = self._p, len(problem.inputs)
        require((region_map.p, region_map.q) == sizes, "the map has another number of signals")
        slack = FilterModel(problem).slack
        # What the margin is worth in each row. Rows without an input hold in all of the safe set.
        bounds = [bound + dot(map(abs, row), slack) for row, bound in zip(problem.H, problem.b)]
        self._rows = [(i, bound) for i, bound in enumerate(bounds) if any(problem.G[i])]
        self._everywhere = box_of(region_map.box, 0, self._p) + problem.set_rows(self._p)

    def confirm(self):
        for r, region in enumerate(self._map.regions):
            laws = self._map.laws[region.law]
            # The law without active rows is the wish itself.
            wishes = [[Fraction(k == self._n + j) for k in range(self._p + 1)] for j in range(len(laws))]
            require(region.active_count > 0 or laws == wishes, "an admissible wish comes back changed")
            self._require_kept(r, laws, self._reach_of(region))

    def _reach_of(self, region):
        """Where a look-up may answer with the region, and the state is in the safe set."""
        rows = list(self._everywhere)
        for row in self._map.rows[region.first_row:region.first_row + region.row_count]:
            *normal, bound = [entry if row > 0 else -entry for entry in self._map.planes[abs(row) - 1]]
            rows.append(half_space(normal, bound + REACH * Fraction(self._map.tolerance)))
        return Polyhedron(rows)

    def _error_of(self, reach, law, ends):
        """How far the answer may be from the law, by rounding in any order of sums and where it is limited to the range of the
        input."""
        total = dot(map(abs, law), [max(map(abs, sides)) for sides in self._map.box] + [1])
        require(total * LEAST <= 1, "numbers of the map are too great for doubles")
        rounding, excess = (self._p + 3) * total * ROUNDING + LEAST, Fraction(0)
        for sign, end in zip((-1, 1), ends):
            greatest = reach.greatest([sign * entry for entry in law[:-1]])
            require(greatest is not None, "the answers of a region have no bound")
            excess = max(excess, greatest + sign * (law[-1] - end) + rounding)
        return rounding + excess

    def _require_kept(self, r, laws, reach):
        """G_i u <= b_i + M_i xi + what the margin is worth in row i."""
        if reach.is_empty():
            return
        errors = [self._error_of(reach, law, ends) for law, ends in zip(laws, self._problem.inputs)]
        for i, bound in self._rows:
            G, M = self._problem.G[i], self._problem.M[i]
            *normal, constant = [dot(G, entries) for entries in zip(*laws)]
            normal[:self._n] = [entry - of_state for entry, of_state in zip(normal, M)]
            row = half_space(normal, bound - constant - dot(map(abs, G), errors))
            require(reach.is_within(row), f"an answer of region {r} needs more than the margin of row {i}")
