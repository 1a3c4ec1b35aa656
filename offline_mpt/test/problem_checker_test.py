#!/usr/bin/env python3
"""check_problem: the program of a certificate against the problem file, by arithmetic of its own."""
import os
import random
import re
import unittest
from fractions import Fraction
from types import SimpleNamespace

import polyfly
from balls import BITS, UNIT, Balls, solved
from exact import Refused
from fields import document_of
from optimal_control import DiscreteSystem, discretised, terminal_weight
from expected_program import expected_program
from program_match import match_expected, match_tracking
from tracking_problem import TrackingProblem

PROBLEMS = os.path.join(os.environ["POLYFLY_ROOT"], "region_maps", "problems")
TINY = Fraction(1, 1 << 400)
# Off by so much of the greatest entry of its row, or of its matrix.
OFF = Fraction(1, 10**9)


def fractions(array):
    rows = array if array.ndim == 2 else array[:, None]
    return [[*map(Fraction, row)] for row in rows.tolist()]


def certificate_of(text):
    """The numbers of a problem's program, as its certificate has them."""
    program = polyfly.parse_problem(text, "made").condense()
    names = {"S": program.B, **{name: getattr(program, name) for name in "H f F A b A_theta b_theta E C c".split()}}
    matrices = {name: fractions(array) for name, array in names.items()}
    matrices["box"] = [[Fraction(signal.lower), Fraction(signal.upper)] for signal in program.parameters]
    return SimpleNamespace(program=matrices, equalities=set(program.equalities))


def refusal(certificate, text, expected=None):
    """Empty: the program is that of the problem, or the expected one. Else why it is not."""
    try:
        problem = TrackingProblem(text)
        if expected:
            match_expected(certificate, problem, expected)
        else:
            match_tracking(certificate, problem)
    except Refused as error:
        return str(error)
    return ""


def changed(certificate, name, row, column, by):
    """A certificate with another number."""
    matrix = [list(entries) for entries in certificate.program[name]]
    matrix[row][column] += by
    return SimpleNamespace(program={**certificate.program, name: matrix}, equalities=certificate.equalities)


def greatest(rows):
    return max((abs(entry) for row in rows for entry in row), default=0) or 1


def replaced(text, start, end):
    assert start in text, start
    return text.replace(start, end, 1)


def made_problem(seed, horizon=4):
    """Two inputs and three states, with numbers that depend on the seed."""
    number = random.Random(seed).uniform
    return f"""polyfly_problem: 1
name: made
type: tracking_mpc
model:
  states:
    - {{name: x1, unit: m, range: [-4, 3]}}
    - {{name: x2, unit: m/s}}
    - {{name: x3, unit: rad, range: [-1, 1]}}
  inputs:
    - {{name: u1, unit: rad, range: [-0.5, 0.4]}}
    - {{name: u2, unit: N, range: [-2, 2]}}
  A:
    - [0, 1, {number(-0.3, 0.3)}]
    - [0, {number(-1, 0.2)}, {number(-9, 9)}]
    - [{number(-0.2, 0.2)}, 0, {number(-5, -1)}]
  B:
    - [0, {number(0.5, 1)}]
    - [{number(-0.2, 0.2)}, {number(0.1, 1)}]
    - [{number(2, 5)}, 0]
  C:
    - [1, 0, 0]
    - [0, 1, 0]
sampling_time: {number(0.05, 0.3)}
horizon: {horizon}
weights:
  Q: [{number(1, 50)}, {number(1, 20)}, {number(0.1, 5)}]
  R:
    - [{number(5, 9)}, 0.5]
    - [0.5, {number(1, 4)}]
  R_delta: [{number(0, 1)}, 0.3]
parameters:
  - {{name: e1, role: error, of: x1, unit: m, range: [-3, 3]}}
  - {{name: r1, role: input_reference, of: u1, unit: rad, range: [-0.2, 0.25]}}
  - {{name: e2, role: error, of: x2, unit: m/s, range: [-3, 3]}}
  - {{name: e3, role: error, of: x3, unit: rad, range: [-0.5, 0.6]}}
  - {{name: before2, role: previous_input, of: u2, unit: N, range: [-2, 2]}}
"""


TERMINAL = """  terminal:
    - [30, 1, 0]
    - [1, 20, 0.5]
    - [0, 0.5, 9]
terminal_set:
  T:
    - [1, 0.5, 0]
    - [-1, 0, 0.25]
  t: [2, 1.5]
"""
CONSTRAINTS = """constraints:
  - {of: x2, range: [-2.5, 2], soft: {linear: 40, quadratic: 3}}
  - {of: x3, upper: 0.8, soft: {quadratic: 3, slack: horizon}, measured_from: reference}
  - {name: sum, of: {u1: 1, x2: -0.05}, unit: rad, range: [-0.6, 0.45], soft: {linear: 2, quadratic: 1, slack: horizon}}
  - {name: hard, of: {u2: 1, u1: 0.5}, unit: N, lower: -2.2, measured_from: reference}
"""


def full_problem(seed):
    """The same with what a problem file may state besides."""
    text = made_problem(seed, 5)
    text = replaced(text, "model:\n", "model:\n  time: discrete\n" if seed % 2 else "model:\n  delay: 0.03\n")
    text = replaced(text, "range: [-2, 2]}\n", "range: [-2, 2], change: [-0.7, 0.9]}\n")
    text = replaced(text, "  A:\n", "  disturbances:\n    - {name: d1, unit: m}\n"
                                    "  B_d:\n    - [0.1]\n    - [1]\n    - [-0.3]\n  A:\n")
    text = replaced(text, "horizon: 5\n", "horizon: 5\n" + ("control_horizon: 3\n" if seed % 3 else "moves: [1, 2, 2]\n"))
    text = replaced(text, "parameters:\n", TERMINAL + CONSTRAINTS + "parameters:\n")
    if seed % 4 < 2:
        return text + """  - {name: x1_ref, role: state_reference, of: x1, unit: m, value: 0.5}
  - {name: x2_ref, role: state_reference, of: x2, unit: m/s, range: [-1, 1]}
  - {name: x3_ref, role: state_reference, of: x3, unit: rad, value: 0}
  - {name: d, role: disturbance, of: d1, unit: m, range: [-0.1, 0.2]}
"""
    text = re.sub("  - .name: r1, .*\n", "", text.replace("role: error", "role: state"))
    return text + """  - {name: r_x1, role: reference, of: x1, unit: m, range: [-1, 1]}
  - {name: r_x2, role: reference, of: x2, unit: m/s, value: 0.3}
  - {name: d, role: disturbance, of: d1, unit: m, value: 0.05}
"""


def unstable_problem(seed, terminal):
    """A plant that is unstable enough for the prediction beside a feedback."""
    text = full_problem(seed).replace("time: discrete\n", "time: continuous\n")
    text = re.sub("horizon: 5\n.*\n", "horizon: 7\n", text, count=1)
    text = re.sub("sampling_time: .*", "sampling_time: 0.2", text)
    text = replaced(text, "  A:\n    - [0, 1,", "  A:\n    - [12, 1,")
    return replaced(text, TERMINAL, "  terminal: equality\n") if terminal == "equality" else text


class Programs(unittest.TestCase):
    def test_what_condense_makes_is_confirmed(self):
        for seed in range(20):
            text = made_problem(seed, 1 + seed % 6)
            self.assertEqual("", refusal(certificate_of(text), text), seed)

    def test_constraints_and_roles_are_confirmed(self):
        for seed in range(12):
            text = full_problem(seed)
            self.assertEqual("", refusal(certificate_of(text), text), seed)

    def test_other_constraints_are_refused(self):
        text = full_problem(2)
        certificate = certificate_of(text)
        self.assertEqual("", refusal(certificate, text))
        for start, end in (("linear: 40", "linear: 41"), ("quadratic: 3}", "quadratic: 3.1}"),
                           ("slack: horizon", "slack: stage"), ("upper: 0.8", "lower: -0.8"),
                           ("-0.7, 0.9", "-0.7, 0.91"), ("x2: -0.05", "x2: 0.05"), ("t: [2, 1.5]", "t: [2, 1.6]"),
                           ("[30, 1, 0]", "[31, 1, 0]"), ("value: 0.05", "value: 0.06"),
                           (", measured_from: reference", ""), ("control_horizon: 3", "control_horizon: 4")):
            self.assertNotEqual("", refusal(certificate, replaced(text, start, end)), start)

    def test_the_prediction_beside_a_feedback_is_confirmed(self):
        for seed in (1, 3, 5, 7):
            for terminal in ("given", "equality"):
                text = unstable_problem(seed, terminal)
                certificate = certificate_of(text)
                self.assertEqual(3 if terminal == "equality" else 0, len(certificate.equalities))
                self.assertTrue(match_tracking(certificate, TrackingProblem(text)).expected.beside_feedback)
                certificate.equalities ^= {min(certificate.equalities, default=0)}
                self.assertNotEqual("", refusal(certificate, text))

    def test_a_changed_prediction_beside_a_feedback_is_refused(self):
        text = unstable_problem(1, "equality")
        certificate, expected = certificate_of(text), expected_program(TrackingProblem(text), beside_feedback=True)
        self.assertEqual("", refusal(certificate, text, expected))
        choice = random.Random(7).randrange
        for name in ("H", "F", "A", "S", "b", "E", "C"):
            rows = certificate.program[name]
            for _ in range(5):
                row, column = choice(len(rows)), choice(len(rows[0]))
                other = changed(certificate, name, row, column, max(1, greatest(rows)) * OFF)
                self.assertNotEqual("", refusal(other, text, expected), (name, row, column))

    def test_each_number_of_the_program_matters(self):
        text = made_problem(7, 2)
        certificate, expected = certificate_of(text), expected_program(TrackingProblem(text))
        self.assertEqual("", refusal(certificate, text))
        for name, rows in certificate.program.items():
            for row, entries in enumerate(rows):
                for column in range(len(entries)):
                    other = changed(certificate, name, row, column, greatest(rows) * OFF)
                    self.assertNotEqual("", refusal(other, text, expected), (name, row, column))
        for name in ("A", "S", "b"):
            certificate.program[name].pop()
        self.assertNotEqual("", refusal(certificate, text))

    def test_a_changed_program_of_each_file_is_refused(self):
        """Entries that are off by 1e-9 of the greatest in their row: of their own matrix, of constants also of those beside
        it."""
        beside = {"f": ["F", "f"], "S": ["A", "S"], "b": ["A", "S", "b"], "b_theta": ["A_theta", "b_theta"],
                  "C": ["C", "c"], "c": ["C", "c"]}
        choice = random.Random(5).randrange
        for name in ("multirotor_lateral", "multirotor_vertical", "lateral_speed_limit", "look_ahead/vertical",
                     "look_ahead/lateral", "reference/lateral_asl"):
            with open(os.path.join(PROBLEMS, name + ".yaml"), encoding="utf-8") as file:
                text = file.read()
            certificate, expected = certificate_of(text), expected_program(TrackingProblem(text))
            self.assertEqual("", refusal(certificate, text, expected), name)
            for key, rows in certificate.program.items():
                for _ in range(3 if rows and rows[0] else 0):
                    row, column = choice(len(rows)), choice(len(rows[0]))
                    size = greatest([certificate.program[part][row] for part in beside.get(key, [key])])
                    other = changed(certificate, key, row, column, size * OFF)
                    self.assertNotEqual("", refusal(other, text, expected), (name, key, row, column))


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = made_problem(3)
        cls.certificate = certificate_of(cls.text)

    def refusal_with(self, start, end):
        return refusal(self.certificate, replaced(self.text, start, end))

    def test_another_problem_is_refused(self):
        self.assertEqual("", refusal(self.certificate, self.text))
        for start, end in (("range: [-4, 3]", "range: [-4, 3.000001]"), ("range: [-0.5, 0.4]", "range: [-0.5, 0.41]"),
                           ("horizon: 4", "horizon: 5"), ("0.5]\n    - [0.5", "0.50001]\n    - [0.50001"),
                           ("0.3]\nparameters", "0.31]\nparameters"), ("range: [-0.2, 0.25]", "range: [-0.2, 0.2]"),
                           ("role: previous_input, of: u2", "role: previous_input, of: u1")):
            self.assertNotEqual("", self.refusal_with(start, end), end)

    def test_a_number_has_one_reading(self):
        for four in ("4.0", "+4", "0.4e1"):
            self.assertEqual("", self.refusal_with("horizon: 4", "horizon: " + four), four)
        for other in ("04", "0x4", "0o4", "'4'", "4.5", "-4", "1e99", ".inf", "", "[4]"):
            self.assertNotEqual("", self.refusal_with("horizon: 4", "horizon: " + other), other)
        self.assertIn("leading zeros", self.refusal_with("range: [-4, 3]", "range: [-04, 3]"))

    def test_a_file_that_is_not_known_is_refused(self):
        self.assertIn("look_ahead", self.refusal_with("horizon", "look_ahead: 1\nhorizon"))
        self.assertIn("twice", self.refusal_with("horizon", "name: again\nhorizon"))
        self.assertIn("JSON", refusal(self.certificate, '{"H": [[1]]}'))
        self.assertIn("keys", refusal(self.certificate, "- 1"))
        self.assertIn("problem", self.refusal_with("  Q: [", "  Q: [["))

    def test_texts_that_readers_take_differently_are_refused(self):
        for text in ("[a:]", "type: [b:", "{a: b, c:", "type: a\n\4odd: 1\n"):
            with self.assertRaisesRegex(Refused, "^problem: has "):
                document_of(text)
        self.assertEqual({"type": "a"}, document_of("type: a\n"))


class Arithmetic(unittest.TestCase):
    def test_a_double_integrator_is_discretised_exactly(self):
        """exp of a nilpotent matrix is a polynomial."""
        A, B = Balls.of([[Fraction(0), Fraction(1)], [Fraction(0)] * 2]), Balls.of([[Fraction(0)], [Fraction(3)]])
        system = discretised(A, B, Balls.zeros(2, 1), Fraction(1, 10))
        for found, wanted in ((system.A, [[1, Fraction(1, 10)], [0, 1]]), (system.B, [[Fraction(3, 200)], [Fraction(3, 10)]])):
            self.assertLess((found - Balls.of([[*map(Fraction, row)] for row in wanted])).greatest(), TINY)

    def test_a_scalar_riccati_equation_is_solved(self):
        """P = q + a^2 P - (a b P)^2 / (r + b^2 P) is quadratic in P."""
        b, q, r = 0.4, 2.0, 0.7
        for a in (0.3, 1.0, 1.7):
            scalar = {name: Balls.of([[Fraction(value)]]) for name, value in (("a", a), ("b", b), ("q", q), ("r", r))}
            P, residual = terminal_weight(DiscreteSystem(scalar["a"], scalar["b"], None), scalar["q"], scalar["r"])
            half = (r - a * a * r - q * b * b) / (2.0 * b * b)
            self.assertAlmostEqual(1, float(P.greatest()) / (-half + (half * half + q * r / (b * b))**0.5), delta=1e-13)
            self.assertLess(residual, Fraction(1, 1 << 300))

    def test_balls_hold_the_exact_number(self):
        """Sums, products and quotients of random fractions lie within their bounds."""
        whole = random.Random(1).randint
        for _ in range(200):
            exact = Fraction(whole(-10**6, 10**6), whole(1, 10**6))
            ball = Balls.of([[exact]])
            for _ in range(6):
                other = Fraction(whole(1, 10**6), whole(1, 10**6))
                exact = (exact + other) * other / (other + 1) - exact
                part = Balls.of([[other]])
                ball = solved(part + Balls.identity(1), (ball + part) @ part).scaled(Fraction(1)) - ball
            error = abs(exact * UNIT - ball.rows[0][0])
            self.assertLessEqual(error, ball.radius)
            self.assertLess(Fraction(ball.radius, UNIT), TINY)
        with self.assertRaises(Refused):
            solved(Balls.identity(1) - Balls.identity(1), Balls.identity(1))

    def test_matrices_of_balls_hold_the_exact_ones(self):
        number = random.Random(2).randint
        for _ in range(50):
            a, b = ([[Fraction(number(-99, 99), 97) for _ in range(3)] for _ in range(3)] for _ in range(2))
            exact = [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
            ball = solved(Balls.of(a), Balls.of(a) @ Balls.of(b) @ Balls.of(b))
            wanted = Balls.of([[sum(b[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)])
            for found, right in ((Balls.of(a) @ Balls.of(b), Balls.of(exact)), (ball, wanted)):
                self.assertLessEqual((found.middle() - right.middle()).greatest() * UNIT, found.radius + right.radius)
                self.assertLess(found.radius, UNIT >> BITS // 2)


if __name__ == "__main__":
    unittest.main()
