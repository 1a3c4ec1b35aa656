#!/usr/bin/env python3
"""check_problem: model and rows of a robust map's certificate against the problem file, by arithmetic of its own."""
import random
import unittest
from fractions import Fraction

from certificate import RobustCertificate
from exact import Refused
from invariance import Invariance
from proven_map import ProvenMap, refusal_of, replaced
from robust_match import match_robust
from robust_problem import RobustProblem
from robust_rows import match_rows

STATES = (("p", "m", "[-1.5, 1.5]"), ("v", "m/s", "[-1.5, 1.5]"), ("phi", "rad", "[-0.35, 0.35]"), ("rate", "rad/s", "[-3, 3]"))
MODELS = {2: ("[[0, 1], [0, -0.01]]", "[[0], [1]]"),
          3: ("[[0, 1, 0], [0, -0.01, 9.81], [0, 0, -5]]", "[[0], [0], [4.5]]"),
          4: ("[[0, 1, 0, 0], [0, -0.01, 9.81, 0], [0, 0, 0, 1], [0, 0, -144, -19.2]]", "[[0], [0], [0], [129.6]]")}


def row_of(size, *ones):
    return "[" + ", ".join(str(int(j in ones)) for j in range(size)) + "]"


def made_robust(states=3, horizon=3, bounded_position=False, torque=False, references=False, tie_break=None, **keys):
    """An axis p' = v, v' = g phi - 0.01 v + w, phi' = (0.9 u - phi) / 0.2, or of second order; with two states v' = u + w.
    `input`, `disturbance` and `outputs` are of the model, other keys of the file."""
    A, B = MODELS[states]
    input_range, disturbance = keys.pop("input", "[-0.35, 0.35]"), keys.pop("disturbance", "[-0.5, 0.5]")
    outputs = keys.pop("outputs", f"[{row_of(states, 0)}]")
    text = "polyfly_problem: 1\nname: made\ntype: robust_mpc\nmodel:\n  states:\n"
    for i, (name, unit, ends) in enumerate(STATES[:states]):
        is_bounded = i in (1, 2) or (i == 0 and bounded_position)
        text += f"    - {{name: {name}, unit: {unit}{', range: ' + ends if is_bounded else ''}}}\n"
    text += f"  inputs:\n    - {{name: u, unit: rad, range: {input_range}}}\n  disturbances:\n"
    text += f"    - {{name: w, unit: m/s^2, range: {disturbance}}}\n"
    text += "    - {name: t, unit: rad/s, range: [-0.1, 0.2]}\n" if torque else ""
    effects = [[int(i == 1)] + [int(i == states - 1)] * torque for i in range(states)]
    text += f"  A: {A}\n  B: {B}\n  G: {effects}\n  C: {outputs}\nsampling_time: 0.08\n"
    chosen = {"horizon": horizon, "stack": "paper", "feedback_predictions": "free", "invariance": "none", "floor": "0",
              "peak_in_map": "false", "tie_break": f"{{Q: {[40, 20, 10, 1][:states]}, R: [35]}}", **keys}
    text += "".join(f"{key}: {value}\n" for key, value in chosen.items()) + "parameters:\n"
    for name, unit, ends in STATES[:states]:
        text += f"  - {{name: e_{name}, role: error, of: {name}, unit: {unit}, range: {ends}}}\n"
    if references:
        text += f"""  - {{name: v_ref, role: reference, unit: m/s, range: [-0.8, 0.8], state: {row_of(states, 1)}, input: [0]}}
  - {{name: phi_ref, role: reference, unit: rad, range: [-0.15, 0.15], state: [0, 0, 1], input: ["10/9"]}}
"""
    return text


def drawn_robust(seed):
    """A made problem by chance: numbers, bounds, stack, feedback, and perhaps a reference."""
    draw = random.Random(seed)
    text = made_robust(states=draw.choice((2, 3)), horizon=draw.choice((2, 3)), torque=draw.random() < 0.35,
                       stack=draw.choice(("paper", "shift")), feedback_predictions=draw.choice(("free", "zero", "fixed")),
                       floor=f"{draw.uniform(0, 0.08):.4g}", peak_in_map="true",
                       disturbance=f"[{-draw.uniform(0.05, 0.5):.4g}, {draw.uniform(0.05, 0.5):.4g}]",
                       bounded_position=draw.random() < 0.2, input=f"[-{draw.uniform(0.3, 0.6):.4g}, 0.4]")
    text = replaced(text, "-0.01", f"{-draw.uniform(0, 0.4):.4g}")
    text = replaced(text, "sampling_time: 0.08", f"sampling_time: {draw.choice(('0.05', '0.08', '0.1', '0.16'))}")
    return text


def match(proven, text, lines=None):
    region_map, certificate = proven.map, proven.read(lines)
    if not isinstance(certificate, RobustCertificate):
        raise Refused("is no robust certificate")
    return match_robust(certificate, RobustProblem(text), region_map)


def refusal(proven, text, lines=None):
    """Empty: model and rows are those of the problem. Else why they are not."""
    return refusal_of(match, proven, text, lines)


def without_invariance(**keys):
    return made_robust(states=2, bounded_position=True, **{"input": "[-3, 3]", **keys})


class MadeProblems(unittest.TestCase):
    def test_their_rows_are_confirmed(self):
        for keys in ({"stack": "shift"}, {"feedback_predictions": "fixed", "horizon": 4},
                     {"feedback_predictions": "zero", "peak_in_map": "true"},
                     {"states": 2, "floor": "5e-2", "outputs": '[[1, 0], ["1/3", 0.25]]'},
                     {"disturbance": "[-0.1, 0.4]"}, {"states": 4}):
            text = made_robust(**keys)
            proven = ProvenMap(text)
            self.assertTrue(proven.certificate, proven.said)
            self.assertEqual("", refusal(proven, text), keys)

    def test_rows_of_drawn_problems_are_confirmed(self):
        for seed in range(4):
            text = drawn_robust(seed)
            proven = ProvenMap(text)
            self.assertTrue(proven.certificate, proven.said)
            self.assertEqual("", refusal(proven, text), text)

    def test_a_fixed_feedback_has_its_gain(self):
        """A gain of its own, and the delay of the controller, which the model does not have."""
        own = "feedback_gain: {Q: [3, 2, 1], R: [7]}\n"
        text = replaced(made_robust(feedback_predictions="fixed", horizon=4), "model:\n", own + "model:\n  delay: 0.02\n")
        proven = ProvenMap(text)
        self.assertEqual("", refusal(proven, text))
        for start, end in ((own, ""), ("R: [7]", "R: [7.000001]"),
                           ("{Q: [3, 2, 1], R: [7]}", "{gain: [[-0.1, -0.2, -0.3]]}"),
                           ("feedback_predictions: fixed", "feedback_predictions: free")):
            self.assertNotEqual("", refusal(proven, replaced(text, start, end)), end)

    def test_a_discrete_model_is_exact(self):
        text = made_robust(states=2, tie_break="{gain: [[-0.8, -1.2]]}")
        for start, end in (("A: [[0, 1], [0, -0.01]]", "time: discrete\n  A: [[1, 0.1], [0, 1]]"),
                           ("B: [[0], [1]]", "B: [[0.005], [0.1]]"), ("G: [[0], [1]]", 'G: [[0.005], ["1/10"]]'),
                           ("{Q: [40, 20], R: [35]}", "{gain: [[-0.8, -1.2]]}")):
            text = replaced(text, start, end)
        proven = ProvenMap(text)
        self.assertEqual(0, match(proven, text).difference)
        for start, end in (("0.005", "0.00500000000000001"), ("-1.2", "-1.20000000000001")):
            self.assertNotEqual("", refusal(proven, replaced(text, start, end)), end)


class InvariantSets(unittest.TestCase):
    def test_they_bound_the_first_step_or_the_last(self):
        keys = {}
        without = ProvenMap(without_invariance())
        for rule in ("first_step", "terminal"):
            text = without_invariance(invariance=rule, **keys)
            proven = ProvenMap(text)
            found = match(proven, text)
            self.assertGreater(found.invariance_rows, 4)
            self.assertTrue(found.is_greatest)
            for other in ("first_step", "terminal", "none"):
                changed = replaced(text, "invariance: " + rule, "invariance: " + other)
                self.assertEqual(rule == other, not refusal(proven, changed), (rule, other))
            self.assertNotEqual("", refusal(without, text))
            keys = {"stack": "shift", "feedback_predictions": "fixed"}

    def test_a_smaller_one_is_not_the_greatest(self):
        """The greatest set of tighter bounds is invariant within the wider ones, and a smaller set than the greatest there."""
        wide, tight = (without_invariance(invariance="first_step", input=ends) for ends in ("[-3, 3]", "[-2, 2.5]"))
        invariance = Invariance(ProvenMap(wide).read().models, RobustProblem(wide))
        for text in (wide, tight):
            _, rows = match_rows(ProvenMap(text).read(), RobustProblem(text))
            invariance.confirm(rows)
            self.assertEqual(text == wide, invariance.is_greatest(rows))

    def test_a_set_that_is_not_invariant_is_refused(self):
        texts = [without_invariance(invariance=rule) for rule in ("first_step", "terminal")]
        for text in texts + [made_robust(references=True, invariance="first_step")]:
            self.check_loosened(text)

    def check_loosened(self, text):
        """Each row alone that is loosened by a 64th is refused. A row of references alone may be: they stay."""
        proven = ProvenMap(text)
        found, lines, of_the_set = match(proven, text), proven.lines, 0
        for k, line in enumerate(lines):
            if not line.startswith("row "):
                continue
            _, bound, rest = line.split(" ", 2)
            above, _, below = bound.partition("/")
            loosened = Fraction(int(above, 16), int(below or "1", 16)) + Fraction(1, 64)
            changed = f"row {loosened.numerator:x}/{loosened.denominator:x} {rest}"
            refused = refusal(proven, text, [*lines[:k], changed, *lines[k + 1:]])
            self.assertTrue(refused or line.endswith(" 0 0 0 0"), line)
            of_the_set += "invariant" in refused
        self.assertGreater(found.invariance_rows, 4)
        self.assertTrue(found.is_greatest)
        self.assertGreaterEqual(of_the_set + 2, found.invariance_rows)


class References(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = made_robust(references=True, torque=True)
        cls.proven = ProvenMap(cls.text)

    def test_another_problem_is_refused(self):
        self.assertEqual("", refusal(self.proven, self.text))
        for start, end in (("-0.01, 9.81", "-0.0100001, 9.81"), ("[4.5]", "[4.50001]"), ("[0, 1]]\n  C", "[0, 1.00001]]\n  C"),
                           ("C: [[1, 0, 0]]", "C: [[1, 1e-9, 0]]"), ("range: [-0.5, 0.5]", "range: [-0.4, 0.5]"),
                           ("range: [-0.5, 0.5]", "range: [-0.4, 0.4]"), ("range: [-0.1, 0.2]", "range: [-0.1, 0.21]"),
                           ("unit: rad, range: [-0.35, 0.35]}\n  inputs", "unit: rad, range: [-0.35, 0.36]}\n  inputs"),
                           ("unit: m/s, range: [-1.5, 1.5]}\n", "unit: m/s}\n"),
                           ("{name: p, unit: m}", "{name: p, unit: m, range: [-9, 9]}"),
                           ("{name: u, unit: rad, range: [-0.35, 0.35]}", "{name: u, unit: rad, range: [-0.35, 0.351]}"),
                           ("sampling_time: 0.08", "sampling_time: 0.0801"), ("horizon: 3", "horizon: 4"),
                           ("horizon: 3", "horizon: 2"), ("stack: paper", "stack: shift"),
                           ("feedback_predictions: free", "feedback_predictions: zero"),
                           ("feedback_predictions: free", "feedback_predictions: fixed"), ("floor: 0\n", "floor: 1e-6\n"),
                           ("peak_in_map: false", "peak_in_map: true"), ("invariance: none", "invariance: first_step"),
                           ("invariance: none", "invariance: terminal"), ("Q: [40, 20, 10]", "Q: [40, 20, 10.0001]"),
                           ("R: [35]", "R: [34.9]"), ("state: [0, 1, 0], input: [0]", "state: [0, 0.999, 0], input: [0]"),
                           ("10/9", "11/9"), ("role: error, of: p, unit: m, range: [-1.5, 1.5]",
                                              "role: error, of: p, unit: m, range: [-1.5, 1.6]"),
                           ("range: [-0.8, 0.8]", "range: [-0.8, 0.7]"), ("floor: 0\n", "floor: 0\nunknown: 1\n"),
                           ("type: robust_mpc", "type: tracking_mpc"), ("sampling_time: 0.08", "sampling_time: .inf"),
                           ("sampling_time: 0.08", "sampling_time: .nan"),
                           ("{name: u, unit: rad, ", "{name: u, unit: rad, rate: [-1, 1], "),
                           ("role: error, of: v", "role: error, of: p")):
            self.assertNotEqual("", refusal(self.proven, replaced(self.text, start, end)), end)

    def test_a_loosened_or_repeated_row_is_refused(self):
        lines = self.proven.lines
        self.assertEqual("", refusal(self.proven, self.text, lines))
        places = [k for k, line in enumerate(lines) if line.startswith("row ")]
        self.assertGreater(len(places), 20)
        for k in places:
            loosened = "row 7fff " + lines[k].split(" ", 2)[2]
            self.assertIn("of the problem is none of the certificate",
                          refusal(self.proven, self.text, [*lines[:k], loosened, *lines[k + 1:]]), lines[k])
            self.assertNotEqual("", refusal(self.proven, self.text, [*lines[:k], lines[k], *lines[k:]]), lines[k])

    def test_a_cut_or_longer_line_is_refused(self):
        """By a rule, or because it cannot be read: the command refuses both."""
        lines = self.proven.lines
        for key in ("row ", "model A ", "errors ", "state_range ", "predictions ", "map ", "problem ", "equalities "):
            k = next(k for k, line in enumerate(lines) if line.startswith(key))
            for changed in ([lines[k].rsplit(" ", 1)[0]], [lines[k] + " 0"], [lines[k], lines[k]], [key + "x"]):
                with self.assertRaises(Exception, msg=changed):
                    match(self.proven, self.text, [*lines[:k], *changed, *lines[k + 1:]])


if __name__ == "__main__":
    unittest.main()
