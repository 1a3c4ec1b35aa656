"""The set that `invariance` names is robustly invariant within the bounds, and the greatest such set."""
from exact import require, times_matrix
from polyhedron import Polyhedron, half_space, side, without_entry, without_implied

# Of the recursion that shows the set to be the greatest one, and of the half-spaces that one step leaves.
MOST_SET_STEPS = 40
MOST_SET_ROWS = 400


class Invariance:
    """Half-spaces of theta = (errors, references). The errors move, the references stay."""

    def __init__(self, models, problem):
        self._models, self._problem = models, problem
        self._p = len(problem.ranges)

    def confirm(self, rows):
        """Shows that the set lies within the bounds of the states, and that from all of it an input within its range leads
        back into it, whatever the disturbance."""
        invariant_set = Polyhedron(rows)
        require(all(map(invariant_set.is_within, self._state_bounds())),
                "a bound of a state does not hold in all of the invariant set")
        is_invariant = all(map(invariant_set.is_within, self._led(rows)))
        require(is_invariant, "the set that the problem calls invariant is not")

    def is_greatest(self, rows):
        """Whether it is shown that each such set within the ranges of the references lies in this one. It tries few steps. A
        half-space that holds in each invariant set gives further ones: some input must lead into it."""
        known = self._state_bounds()
        for j, (lower, upper) in enumerate(self._problem.ranges):
            if j not in self._problem.errors:
                known += [side(self._p, j, 1, upper), side(self._p, j, -1, -lower)]
        for _ in range(MOST_SET_STEPS):
            outer = Polyhedron(known)
            if all(map(outer.is_within, rows)):
                return True
            known += [row for row in self._led(known) if not outer.is_within(row)]
            if len(known) > MOST_SET_ROWS:
                return False
            known = without_implied(known)
        return False

    def _state_bounds(self):
        """Ranges of x, which is the error and what the references add."""
        rows = []
        for state, (lower, upper) in self._problem.state_ranges.items():
            normal = [row[state] for row in self._problem.state_shift]
            normal[self._problem.errors[state]] += 1
            rows += [half_space(normal, upper), half_space([-entry for entry in normal], -lower)]
        return rows

    def _led(self, rows):
        """What theta must meet so that some input in its range leads into the set, whatever the disturbance."""
        lower, upper = self._problem.input_range
        on_input = [entry for entry, in self._problem.input_shift] + [1]
        with_input = [self._one_step_before(row) for row in rows]
        with_input += [half_space(on_input, upper), half_space([-entry for entry in on_input], -lower)]
        return [row[:self._p] + row[-1:] for row in without_entry(with_input, self._p)]

    def _one_step_before(self, row):
        on_errors = [row[error] for error in self._problem.errors]
        normal = [*row[:-1], *times_matrix(on_errors, self._models["B"])]
        for error, entry in zip(self._problem.errors, times_matrix(on_errors, self._models["A"])):
            normal[error] = entry
        drift, = times_matrix(on_errors, self._models["drift"])
        effects = times_matrix(on_errors, self._models["G"])
        return half_space(normal, row[-1] - drift - sum(map(abs, effects)))
