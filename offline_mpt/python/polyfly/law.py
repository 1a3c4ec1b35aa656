"""A control law in a loop: from state and reference to the input."""
import numpy as np

from ._polyfly import Map, parse_problem


class Law:
    """Computes the input of a tracking problem at each sample.

    `source` is a Map, which is looked up, or a Problem, which is solved online. Another function of theta may take the
    place of the law: `Law(problem, law=...)`. One object serves one loop.
    """

    def __init__(self, source, law=None):
        is_map = isinstance(source, Map)
        self.problem = parse_problem(source.problem_text, source.path + ": problem text") if is_map else source
        self._law = law if law is not None else (source if is_map else source.online())
        # Steady state and input are linear in disturbance and output (Eq. 6): a column for each.
        outputs, disturbances = self.problem.C.shape[0], self.problem.Bd.shape[1]
        unit = np.eye(disturbances + outputs)
        states = [self.problem.steady_state(column[disturbances:], column[:disturbances]) for column in unit]
        self._x_target = np.column_stack([state.x for state in states])
        self._u_target = np.column_stack([state.u for state in states])
        self._no_disturbance = np.zeros(disturbances)
        self.reset()

    def reset(self):
        """Forgets the last input."""
        self._u_previous = None

    def theta(self, state, reference, disturbance=None):
        """The parameter of the law at a state, for an output that is to be held at `reference`."""
        given = self._no_disturbance if disturbance is None else np.atleast_1d(disturbance)
        target = np.concatenate([given, np.atleast_1d(reference)])
        u_ref = self._u_target @ target
        values = {"error": np.asarray(state, dtype=float) - self._x_target @ target, "input_reference": u_ref,
                  "previous_input": u_ref if self._u_previous is None else self._u_previous}
        return np.array([values[entry.role][entry.index] for entry in self.problem.parameters])

    def step(self, state, reference, disturbance=None):
        """The input for the next period. Raises OutsideError where the law has none; the last input stands then."""
        u = np.asarray(self._law(self.theta(state, reference, disturbance)))
        self._u_previous = u
        return u
