#!/usr/bin/env python3
"""check_problem: program, safe set and answers of a filter against the problem file, by arithmetic of its own."""
import copy
import unittest
from fractions import Fraction
from types import SimpleNamespace

from fields import document_of
from filter_answers import Answers
from filter_problem import FilterProblem, is_completed_text, match_filter
from polyhedron import Polyhedron, half_space, without_entry, without_implied
from proven_map import ProvenMap, refusal_of, replaced
from safe_set import confirm_safe_set
from signals import match_yaml_signals

OFF = Fraction(1, 10**9)

TWO_INPUTS = """polyfly_problem: 1
name: two
type: safety_filter
sampling_time: 0.1
margin: 1e-4
model:
  states:
    - {name: p, unit: m, range: [-1, 2]}
    - {name: v, unit: m/s, range: [-1.5, 1.5], error: 0.01}
  inputs:
    - {name: a, unit: m/s^2, range: [-2, 3], weight: 3}
    - {name: s, unit: m/s, range: [-0.2, 0.1], wish: [-1, 1]}
  disturbances:
    - {name: w, unit: m/s^2, range: [-0.2, 0.3]}
  A: [[0, 1], [0, -0.1]]
  B: [[0, 1], [1, 0.2]]
  B_d: [[0.1], [1]]
"""


def made_filter(period=0.05, delay=0.0, margin=1e-8, disturbance=0.0, error=0.0, input_error=0.0, A="[[0, 1], [0, 0]]"):
    disturbances = f"  disturbances:\n    - {{name: w, unit: m/s^2, range: [{-disturbance}, {disturbance}]}}\n  B_d: [[0], [1]]\n"
    return f"""polyfly_problem: 1
name: made
type: safety_filter
sampling_time: {period}
delay: {delay}
margin: {margin}
model:
  states:
    - {{name: p, unit: m, range: [-1.5, 1.5], error: {error}}}
    - {{name: v, unit: m/s, range: [-1.5, 1.5], error: {error}}}
  inputs:
    - {{name: a, unit: m/s^2, range: [-2, 2], wish: [-5, 5], error: {input_error}}}
{disturbances if disturbance else ''}  A: {A}
  B: [[0], [1]]
"""


def uncertain_filter(**keys):
    return made_filter(**{"margin": 1e-5, "disturbance": 0.3, "input_error": 1e-6, "error": 1e-3, "A": "[[0, 1], [0, -0.2]]", **keys})


def refusal(certificate, problem):
    """Empty: program and safe set are those of the problem. Else why they are not."""
    return refusal_of(match_filter, certificate, problem) or refusal_of(confirm_safe_set, problem)


def refusal_of_answers(region_map, problem):
    return refusal_of(lambda: Answers(problem, region_map).confirm())


class Programs(unittest.TestCase):
    def test_what_solve_makes_is_confirmed(self):
        texts = [uncertain_filter(delay=delay, margin=1e-4) for delay in (0.0, 0.02, 0.05)]
        for text in (made_filter(margin=1e-4), TWO_INPUTS, *texts):
            proven = ProvenMap(text)
            self.assertEqual("", refusal(proven.read(), FilterProblem(proven.map.problem)), text)

    def test_the_file_behind_a_completed_text_is_known(self):
        file = made_filter()
        whole = ProvenMap(file).map.problem
        self.assertTrue(is_completed_text(whole, file))
        self.assertTrue(is_completed_text(whole, file[:-1]))
        self.assertFalse(is_completed_text(file, file))
        self.assertFalse(is_completed_text(whole + "margin: 1\n", file))
        self.assertFalse(is_completed_text(whole, replaced(file, "made", "fade")))


class ChangedNumbers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.proven = ProvenMap(uncertain_filter(delay=0.02, margin=1e-4))
        cls.certificate, cls.problem = cls.proven.read(), FilterProblem(cls.proven.map.problem)

    def test_each_number_of_the_program_matters(self):
        self.assertEqual("", refusal(self.certificate, self.problem))
        for name, rows in self.certificate.program.items():
            for row, entries in enumerate(rows):
                for column, entry in enumerate(entries):
                    changed = copy.deepcopy(rows)
                    changed[row][column] += (entry or 1) * OFF
                    certificate = SimpleNamespace(program={**self.certificate.program, name: changed}, equalities=set())
                    self.assertNotEqual("", refusal_of(match_filter, certificate, self.problem), (name, row, column))
        certificate = SimpleNamespace(program=self.certificate.program, equalities={0})
        self.assertNotEqual("", refusal_of(match_filter, certificate, self.problem))

    def changes(self):
        """Paths of numbers of a problem, and changes of them: those that count as greater uncertainty only upwards."""
        problem, both = self.problem, (OFF, -OFF)
        for name in ("H", "G", "M"):
            for i, row in enumerate(getattr(problem, name)):
                yield from (((name, i, j), both) for j in range(len(row)))
        yield from ((("k", i), (-OFF,)) for i in range(len(problem.k)))
        yield from ((("b", i), both) for i in range(len(problem.b)))
        for name, by in (("A", both), ("B", both), ("B_d", (OFF,))):
            for i, row in enumerate(getattr(problem, name).rows):
                yield from (((name, "rows", i, j), by) for j in range(len(row)))
        for name in ("states", "inputs", "wishes"):
            yield from (((name, k, end), both) for k in range(len(getattr(problem, name))) for end in (0, 1))
        yield from ((("disturbances", 0, 0), (-OFF,)), (("disturbances", 0, 1), (OFF,)))
        for name in ("state_errors", "input_errors"):
            yield from (((name, k), (OFF,)) for k in range(len(getattr(problem, name))))
        yield from ((("weights", 0), both), (("sampling_time",), both), (("delay",), both), (("margin",), (OFF,)))

    def test_each_number_of_the_file_matters(self):
        tried = 0
        for path, changes in self.changes():
            for change in changes:
                tried += 1
                self.assertNotEqual("", refusal(self.certificate, self.with_change(path, change)), (path, change))
        self.assertGreater(tried, 200)

    def with_change(self, path, change):
        changed = copy.deepcopy(self.problem)
        unit = Fraction(1 << 512) if "rows" in path else 1
        set_at(changed, path, lambda value: type(value)(value + change * unit))
        return changed


def set_at(owner, path, change):
    """Changes what a path of attributes and places leads to. A pair becomes a list."""
    place, *rest = path
    part = getattr(owner, place) if isinstance(place, str) else owner[place]
    if rest:
        part = list(part) if isinstance(part, tuple) else part
        set_at(part, rest, change)
    else:
        part = change(part)
    if isinstance(place, str):
        setattr(owner, place, part)
    else:
        owner[place] = part


class SafeSets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.right = FilterProblem(ProvenMap(uncertain_filter(delay=0.02)).map.problem)

    def refusal_with(self, **parts):
        changed = copy.copy(self.right)
        for name, part in parts.items():
            setattr(changed, name, part)
        return refusal_of(confirm_safe_set, changed)

    def test_sets_that_are_not_safe_are_refused(self):
        self.assertEqual("", self.refusal_with())
        self.assertIn("empty", self.refusal_with(k=[-bound for bound in self.right.k]))
        self.assertIn("within the ranges", self.refusal_with(k=[2 * bound for bound in self.right.k]))
        for row in range(0, len(self.right.H), 4):
            for change, rule in ((Fraction(1e-6), "does not keep row"), (Fraction(-0.5), "")):
                b = list(self.right.b)
                b[row] += change
                refused = self.refusal_with(b=b)
                self.assertTrue(refused and rule in refused, (row, refused))
        self.assertIn("too long", self.refusal_with(sampling_time=Fraction(40)))

    def test_a_state_without_an_admissible_input_is_refused(self):
        # No other number of this one depends on the upper end of the input's range.
        weak = FilterProblem(ProvenMap(uncertain_filter(A="[[0, 1], [0, 0]]")).map.problem)
        self.assertEqual("", refusal_of(confirm_safe_set, weak))
        (lower, upper), = weak.inputs
        weak.inputs = [(lower, upper - Fraction(1e-3))]
        self.assertIn("no admissible input", refusal_of(confirm_safe_set, weak))

    def test_files_that_are_not_known_are_refused(self):
        text = ProvenMap(TWO_INPUTS).map.problem
        self.assertEqual("", refusal_of(FilterProblem, replaced(text, "name: two", "name: three")))
        for start, end in (("margin", "magrin"), ("weight: 3", "weight: 0"), ("weight: 3", "weihgt: 3"),
                           ("error: 0.01", "error: -0.01"), ("range: [-1, 2]", "range: [2, -1]"),
                           ("sampling_time: 0.1", "sampling_time: 0"),
                           ("sampling_time: 0.1", "sampling_time: 0.1\ndelay: 0.2"),
                           ("  B_d: [[0.1], [1]]\n", ""), ("  B_d: [[0.1], [1]]\n", "  B_d: [[0.1]]\n"),
                           ("safe_set:", "safe:"), ("type: safety_filter", "type: tracking_mpc"),
                           ("polyfly_problem: 1", "polyfly_problem: 2"), ("A: [[0, 1]", "A: [[0, .inf]")):
            self.assertNotEqual("", refusal_of(FilterProblem, replaced(text, start, end)), end)


class MapAnswers(unittest.TestCase):
    def test_they_are_those_that_the_proof_allows(self):
        """Margins between which the prover changes its mind, by vertices instead of multipliers."""
        confirmed = 0
        for delay in (0.0, 0.02):
            for margin in (1e-8, 1e-4):
                proven = ProvenMap(uncertain_filter(delay=delay, period=0.1, margin=margin))
                refused = refusal_of_answers(proven.map, FilterProblem(proven.map.problem))
                self.assertEqual(proven.is_proven, not refused, (delay, margin, proven.said, refused))
                confirmed += not refused
        self.assertIn(confirmed, (1, 2, 3))

    def test_those_that_need_more_than_the_margin_are_refused(self):
        proven = ProvenMap(uncertain_filter(period=0.3))
        right, problem = proven.map, FilterProblem(proven.map.problem)
        self.assertEqual("", refusal_of_answers(right, problem))
        # Far inside of the set, most regions have no state.
        inner = copy.copy(problem)
        inner.k = [bound / 4 for bound in problem.k]
        self.assertEqual("", refusal_of_answers(right, inner))
        for place, (law,) in enumerate(right.laws):
            # One sign leads outwards. At the range of the input the actuator ends too, so neither may.
            refused = [self.refusal_with_law(proven, problem, place, [*law[:-1], law[-1] + Fraction(by)]) for by in (1e-3, -1e-3)]
            self.assertTrue(any(refused) or not any(law[:-1]), place)
        tight = copy.copy(problem)
        tight.margin = Fraction(1e-12)
        self.assertIn("needs more than the margin", refusal_of_answers(right, tight))
        place, law = next((k, law) for k, (law,) in enumerate(right.laws) if law[2] == 1)
        changed = [*law[:2], 1 - Fraction(1, 1 << 53), law[3]]
        self.assertIn("wish comes back changed", self.refusal_with_law(proven, problem, place, changed))

    @staticmethod
    def refusal_with_law(proven, problem, place, law):
        wrong = copy.copy(proven.map)
        wrong.laws = [*wrong.laws[:place], [law], *wrong.laws[place + 1:]]
        return refusal_of_answers(wrong, problem)

    def test_other_signals_are_refused(self):
        proven = ProvenMap(uncertain_filter(delay=0.05, period=0.1, margin=1e-4))
        root = document_of(proven.map.problem)

        def refusal_with(name=None, place=0, change=lambda value: value):
            wrong = copy.copy(proven.map)
            if name:
                values = list(getattr(wrong, name))
                values[place] = change(values[place])
                setattr(wrong, name, values)
            return refusal_of(match_yaml_signals, wrong, root)

        self.assertEqual("", refusal_with())
        self.assertIn("in the place of", refusal_with("names", 2, lambda name: "a_befor"))
        self.assertIn("unit", refusal_with("units", 3, lambda unit: "m"))
        self.assertIn("range", refusal_with("bounds", 3, lambda ends: (ends[0] + 1e-9, ends[1] + 1e-9)))
        self.assertIn("range", refusal_with("bounds", 4, lambda ends: (ends[0] - 1e-9, ends[1])))
        proven.map.period *= 2
        self.assertIn("period", refusal_with())


class Polyhedra(unittest.TestCase):
    def test_multipliers_decide_exactly(self):
        """A touching half-space holds, one that cuts off 1e-9 does not; of an open set nothing is known."""
        third, ninth = Fraction(1, 3), Fraction(1, 9)
        triangle = [half_space([-1, 0], 0), half_space([0, -1], 0), half_space([3, 1], third)]
        polyhedron = Polyhedron(triangle)
        self.assertTrue(polyhedron.has_point())
        for shift in (0, Fraction(1e-30)):
            self.assertTrue(polyhedron.is_within(half_space([1, 1], third + shift)))
            self.assertTrue(polyhedron.is_within(half_space([1, 0], ninth + shift)))
        for shift in (Fraction(1e-9), Fraction(1e-30)):
            self.assertFalse(polyhedron.is_within(half_space([1, 1], third - shift)))
            self.assertFalse(polyhedron.is_within(half_space([-1, 0], -shift)))
        self.assertEqual(third, polyhedron.greatest([Fraction(1), Fraction(1)]))
        corner = Polyhedron([half_space([1, 0], 0), half_space([0, 1], 0)])
        self.assertFalse(corner.is_within(half_space([-1, 0], 10**6)))
        self.assertIsNone(corner.greatest([Fraction(-1), Fraction(0)]))

    def test_empty_sets_and_lines(self):
        empty = Polyhedron([half_space([1, 0], 0), half_space([-1, 0], -1)])
        self.assertFalse(empty.has_point())
        self.assertTrue(empty.is_empty())
        line = Polyhedron([half_space([1, 0], 0), half_space([-1, 0], 0)])
        self.assertTrue(line.has_point())
        self.assertFalse(line.is_empty())

    def test_an_entry_is_eliminated(self):
        triangle = [half_space([-1, 0], 0), half_space([0, -1], 0), half_space([3, 1], Fraction(1, 3))]
        shadow = without_implied(without_entry(triangle, 1))
        self.assertEqual(2, len(shadow))
        self.assertTrue(Polyhedron(shadow).is_within(half_space([1, 0], Fraction(1, 9))))
        self.assertFalse(Polyhedron(shadow).is_within(half_space([1, 0], Fraction(1, 10))))


if __name__ == "__main__":
    unittest.main()
