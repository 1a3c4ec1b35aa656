"""A control law in a loop: from state and reference to the input."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ._polyfly import Error, Map, Problem, RobustProblem, parse_problem, parse_robust_problem

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike

# Smaller entries of a steady state, beside the greatest of its column, are rounding.
_ROUNDING = 1e-12

_STEADY_ROLES = ("input_reference", "state_reference", "reference", "disturbance")


def _problem_of(source, parse):
    return parse(source.problem_text, source.path + ": problem text") if isinstance(source, Map) else source


def _is_robust(source):
    try:
        return isinstance(_problem_of(source, parse_robust_problem), RobustProblem)
    except Error:
        return False


class Law:
    """Computes the input of a tracking problem at each sample.

    `source` is a Map, which is looked up, or a Problem, which is solved online. Another function of theta may take the
    place of the law: `Law(problem, law=...)`. One object serves one loop.
    """

    def __init__(self, source: Map | Problem, law: Callable[[np.ndarray], ArrayLike] | None = None) -> None:
        if _is_robust(source):
            raise Error(f"{source.name}: is a robust_mpc, which RobustLaw flies")
        self.problem = _problem_of(source, parse_problem)
        self._law = law if law is not None else (source if isinstance(source, Map) else source.online())
        # Steady state and input are linear in disturbance and output (Eq. 6): a column for each.
        outputs, disturbances = self.problem.C.shape[0], self.problem.Bd.shape[1]
        unit = np.eye(disturbances + outputs)
        states = [self.problem.steady_state(column[disturbances:], column[:disturbances]) for column in unit]
        target = np.vstack([np.column_stack([state.x for state in states]), np.column_stack([state.u for state in states])])
        target[np.abs(target) < _ROUNDING * np.max(np.abs(target), axis=0)] = 0.0
        self._x_target, self._u_target = np.vsplit(target, [self.problem.A.shape[0]])
        self._no_disturbance = np.zeros(disturbances)
        # Parameters are x and d themselves; else errors, whose references cover all of d.
        self._absolute = any(entry.role == "state" for entry in self.problem.parameters)
        self._constants = self._assumed()
        self.reset()

    def _assumed(self):
        """(name, role, index, value) of what the law takes as constant of a steady state, because it is no entry of theta."""
        problem = self.problem
        constants = [(entry.signal.name, entry.role, entry.index, entry.signal.lower) for entry in problem.fixed_parameters
                     if entry.role in _STEADY_ROLES]
        given = {(entry.role, entry.index) for entry in [*problem.parameters, *problem.fixed_parameters]}
        if self._absolute:
            wanted = [(f"of role {role}, index {index}", role, index) for role, count in
                      (("reference", problem.C.shape[0]), ("disturbance", problem.Bd.shape[1])) for index in range(count)]
        else:
            wanted = [(f"{signal.name}_ref", "input_reference", index) for index, signal in enumerate(problem.inputs)]
            wanted += [(f"{problem.states[index].name}_ref", "state_reference", index) for index in problem.bounded_states]
        return constants + [(*entry, 0.0) for entry in wanted if entry[1:] not in given]

    def _sized(self, field, value, size):
        value = np.atleast_1d(np.asarray(value, dtype=float))
        if value.shape != (size,):
            raise Error(f"{self.problem.name}: {field}: must be a vector of {size} numbers, got the shape {value.shape}")
        return value

    def reset(self) -> None:
        """Forgets the last input."""
        self._u_previous = None

    def theta(self, state: ArrayLike, reference: ArrayLike, disturbance: ArrayLike | None = None) -> np.ndarray:
        """The parameter of the law at a state, for an output that is to be held at `reference`.

        Raises Error where the steady state (Eq. 6) needs a parameter that the law does not have, or has with another value.
        """
        x = self._sized("state", state, self._x_target.shape[0])
        r = self._sized("reference", reference, self.problem.C.shape[0])
        given = self._no_disturbance if disturbance is None else self._sized("disturbance", disturbance,
                                                                             len(self._no_disturbance))
        target = np.concatenate([given, r])
        x_ref, u_ref = self._x_target @ target, self._u_target @ target
        values = {"error": x - x_ref, "input_reference": u_ref, "state_reference": x_ref, "state": x,
                  "reference": r, "disturbance": given if self._absolute else self._no_disturbance,
                  "previous_input": u_ref if self._u_previous is None else self._u_previous}
        for name, role, index, constant in self._constants:
            if not np.isclose(values[role][index], constant, rtol=_ROUNDING, atol=0.0):
                raise Error(f"{self.problem.name}: parameters: {name}: the law takes it as {constant:g}, "
                            f"but state, reference and disturbance make it {values[role][index]:g}; give it a range")
        return np.array([values[entry.role][entry.index] for entry in self.problem.parameters])

    def step(self, state: ArrayLike, reference: ArrayLike, disturbance: ArrayLike | None = None) -> np.ndarray:
        """The input for the next period. Raises OutsideError where the law has none; the last input stands then."""
        u = np.asarray(self._law(self.theta(state, reference, disturbance)))
        self._u_previous = u
        return u


class RobustLaw:
    """Computes the input of a robust problem at each sample.

    `source` is a Map, which is looked up, or a RobustProblem, which is solved online. The law has no memory.
    """

    def __init__(self, source: Map | RobustProblem) -> None:
        self.problem = _problem_of(source, parse_robust_problem)
        self._law = source if isinstance(source, Map) else source.online()
        self._errors, self._shifts = self.problem.error_parameters, self.problem.state_shifts
        self._places = {signal.name: place for place, signal in enumerate(self.problem.parameters)
                        if place not in self._errors}

    def theta(self, state: ArrayLike, reference: ArrayLike = 0.0, parameters: Mapping[str, float] | None = None) -> np.ndarray:
        """The parameter of the law at a state.

        reference    state to be held: a number for each state, or one for all
        parameters   {name: r} of the parameters of role reference, 0 where left out: they move the reference further
        """
        theta = np.zeros(len(self.problem.parameters))
        for name, value in (parameters or {}).items():
            if name not in self._places:
                raise Error(f"{self.problem.name}: parameters: {name} is none of role reference")
            theta[self._places[name]] = value
        theta[self._errors] = np.asarray(state, dtype=float) - reference - self._shifts @ theta
        return theta

    def step(self, state: ArrayLike, reference: ArrayLike = 0.0, parameters: Mapping[str, float] | None = None) -> np.ndarray:
        """The input for the next period, as `theta` takes them. Raises OutsideError where the law has none."""
        return np.atleast_1d(self._law(self.theta(state, reference, parameters)))[:1]
