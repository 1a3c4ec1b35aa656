"""Robust problems: the builder, and laws in a loop under disturbances."""
import fractions
import unittest

import numpy as np
import polyfly as pf
import run_test
from oracles import ROOT, least_peak, random_parameters

VERTICAL = ROOT / "region_maps/problems/robust/aslquad_vertical.yaml"
# A mass in discrete time.
A, B, G, C = [[1, 0.1], [0, 1]], [[0.005], [0.1]], [[0.005], [0.1]], [[1, 0]]


def vertical():
    """What aslquad_vertical.yaml states, by the builder."""
    return (pf.RobustMPC([[0, 1], [0, 0]], [0, 1], [0, 1], Ts=0.08, horizon=6, C=[1, 0], stack="paper",
                         invariance="first_step", floor=0.02, name="aslquad_vertical",
                         states=[("p_z", "m"), ("v_z", "m/s")], inputs=[("T_cmd", "m/s^2")],
                         disturbances=[("w_z", "m/s^2")])
            .feedback("free").tie_break(Q=[40, 20], R=[2])
            .bounds(x=([-np.inf, -1], [np.inf, 1]), u=(-4, 4), w=(-0.5, 0.5))
            .reference("v_z_ref", state=[0, 1], input=[0], unit="m/s")
            .reference("T_cmd_ref", state=[0, 0], input=[1], unit="m/s^2")
            .parameters({"e_p_z": (-4, 4), "e_v_z": (-2, 2), "v_z_ref": (-0.8, 0.8), "T_cmd_ref": (-2, 2)}))


def mass(**options):
    options = {"time": "discrete", "stack": "shift", **options}
    return (pf.RobustMPC(A, B, G, Ts=0.1, horizon=2, C=C, name="mass", **options)
            .tie_break(gain=[[-1, -2]]).bounds(u=(-2, 2), w=(-0.3, 0.2)).parameters({"e_p": (-1, 1), "e_v": (-1, 1)}))


def flown(seed, steps, low, high):
    """A flight of the mass with disturbances between two numbers: rows of states and input."""
    random = np.random.default_rng(seed)
    x, rows = np.zeros(2), []
    for _ in range(steps):
        u = random.uniform(-0.1, 0.1, 1)
        rows.append(np.concatenate([x, u]))
        x = np.array(A) @ x + np.array(B) @ u + np.array(G) @ random.uniform(low, high, 1)
    return np.array(rows)


class DisturbanceRanges(unittest.TestCase):
    def test_what_was_there_is_found(self):
        ranges, unexplained = pf.disturbance_ranges(mass().problem(), [flown(1, 5001, -0.3, 0.4)])
        self.assertLess(unexplained, 1e-9)
        np.testing.assert_allclose((-0.3, 0.4), ranges["w"][:2], atol=0.01)
        self.assertGreaterEqual(ranges["w"].confidence, 0.95)
        self.assertTrue(0.99 <= ranges["w"].covered < 1)

    def test_the_confidence_is_kept_and_not_exceeded(self):
        problem, held = mass().problem(), 0
        for trial in range(600):
            found = pf.disturbance_ranges(problem, [flown(trial, 201, -1, 1)], coverage=0.9, confidence=0.8)[0]["w"]
            self.assertGreaterEqual(found.confidence, 0.8)
            held += (found.upper - found.lower) / 2 >= 0.9
        self.assertTrue(0.77 * 600 < held < 0.93 * 600, held)

    def test_too_few_samples_reach_less(self):
        flight = flown(3, 101, -1, 1)
        found = pf.disturbance_ranges(mass().problem(), [flight])[0]["w"]
        self.assertLess(found.confidence, 0.95)
        self.assertEqual(1.0, found.covered)
        self.assertLess(pf.disturbance_ranges(mass().problem(), [flight], every=10)[0]["w"].confidence, found.confidence)

    def test_gaps_split_a_flight_and_a_wrong_model_shows(self):
        flight, problem = flown(4, 400, -0.4, 0.4), mass().problem()
        gap = flight.copy()
        gap[100:300, 1] = np.nan
        whole = pf.disturbance_ranges(problem, [flight[:100], flight[300:]])
        self.assertEqual(whole, pf.disturbance_ranges(problem, [gap]))
        flight[:, 0] *= 1.5
        self.assertGreater(pf.disturbance_ranges(problem, [flight])[1], 0.2)

    def test_bad_input_is_refused(self):
        problem, row = mass().problem(), np.zeros((1, 3))
        for flights, options in (([row], {}), ([np.zeros((2, 2))], {}), ([np.zeros((2, 3))], {"coverage": 1.0}),
                                 ([np.zeros((2, 3))], {"every": 0}), ([], {})):
            with self.assertRaises(pf.Error):
                pf.disturbance_ranges(problem, flights, **options)


class Builder(unittest.TestCase):
    def test_the_same_map_as_the_file(self):
        built, read = vertical().explicit(), pf.load(VERTICAL).solve()
        np.testing.assert_array_equal(built.planes, read.planes)
        np.testing.assert_array_equal(built.laws, read.laws)
        self.assertEqual([repr(signal) for signal in read.parameters], [repr(signal) for signal in built.parameters])

    def test_the_peak_is_the_least_that_any_plan_guarantees(self):
        law = mass(peak_in_map=True).feedback("zero").explicit()
        for error in random_parameters([-1, -1], [1, 1], 25, seed=8):
            u, peak = law(error)
            self.assertLessEqual(abs(u), 2.0 + 1e-9)
            self.assertAlmostEqual(peak, least_peak(A, B, G, C, error, (-2, 2), (-0.3, 0.2)), delta=1e-7)

    def test_a_built_law_is_proven(self):
        law = mass().explicit()
        self.assertTrue(law.verify(samples=50, seed=3))
        proof = law.certify()
        self.assertTrue(proof)
        self.assertTrue(proof.certificate.startswith("polyfly robust certificate 2\n"))

    def test_fixed_feedback(self):
        fixed = mass().feedback("fixed", gain=[[-1, -2]])
        self.assertIn("feedback_gain: {gain: [[-1.0, -2.0]]}", fixed.text())
        self.assertNotEqual(fixed.explicit().checksum, mass().explicit().checksum)

    def test_fractions_count_as_written(self):
        text = mass().bounds(u=("-1/3", fractions.Fraction(1, 3)), w=(-0.1, 0.1)).text()
        self.assertIn("range: [-1/3, 1/3]", text)
        self.assertIn("range: [-0.1, 0.1]", text)
        self.assertEqual(1 / 3, pf.parse_robust_problem(text, "mass").inputs[0].upper)

    def test_sentences(self):
        for build, sentence in (
                (lambda: pf.RobustMPC(A, B, G, 0.1, 2, C).problem(), "robust_mpc: tie_break, bounds of u and w, and "),
                (lambda: mass(stack="other").problem(), "mass:[0-9]+: stack: must be one of paper, shift"),
                (lambda: mass(floor=-1).problem(), "mass:[0-9]+: floor"),
                (lambda: mass().bounds(u=(-2, 2), w=(0.2, 0.2)).problem(), "mass:[0-9]+: .*range"),
                (lambda: mass().bounds(u=(-2, 2), w=(-np.inf, np.inf)).problem(), "mass:[0-9]+: .*range"),
                (lambda: mass().bounds(u=(-2, 2), w=([1, 2, 3], 4)).problem(), "w must be a pair .* lists of 1"),
                (lambda: mass().parameters({"e_p": (-1, 1), "e_v": (-1, 1), "r": (0, 1)}).problem(),
                 "mass: parameters: r is none of e_p, e_v"),
                (lambda: mass().parameters({"e_p": (-1, 1)}).problem(), "x_0, |e_p is none of"),
                (lambda: mass().tie_break().problem(), "mass:[0-9]+: tie_break")):
            with self.subTest(sentence=sentence), self.assertRaisesRegex(pf.Error, sentence):
                build()


class Model(unittest.TestCase):
    def test_disturbances_count_in_their_own_units(self):
        model = mass().problem().discretise()
        for found, expected in ((model.A, A), (model.B, B), (model.Bd, G)):
            np.testing.assert_allclose(found, expected, atol=1e-15)
        # Held for 0.08 s: p += v h + h^2 / 2 (u + w).
        held = vertical().problem().discretise()
        np.testing.assert_allclose(held.A, [[1, 0.08], [0, 1]], atol=1e-11)
        np.testing.assert_allclose(held.Bd, [[0.0032], [0.08]], atol=1e-11)
        self.assertEqual(0.08, held.period)


class Loops(unittest.TestCase):
    def test_parameter_of_a_state(self):
        law = pf.RobustLaw(vertical().problem())
        np.testing.assert_allclose(law.theta([1.0, 0.7], [0.6, 0.0], {"v_z_ref": 0.3, "T_cmd_ref": -1.0}),
                                   [0.4, 0.4, 0.3, -1.0], atol=1e-15)
        np.testing.assert_array_equal(law.theta([1.0, 0.7]), [1.0, 0.7, 0.0, 0.0])
        with self.assertRaisesRegex(pf.Error, "aslquad_vertical: parameters: e_p_z is none of role reference"):
            law.theta([1.0, 0.7], 0.0, {"e_p_z": 1.0})

    def test_bounds_hold_under_every_disturbance(self):
        problem = vertical().problem()
        law, online, model = pf.RobustLaw(problem.solve()), pf.RobustLaw(problem), problem.discretise()
        random = np.random.default_rng(5)
        for start in ([1.5, 0.0], [-2.0, 0.5], [0.0, -0.9]):
            x = np.array(start)
            for _ in range(60):
                u = law.step(x)
                np.testing.assert_allclose(online.step(x), u, atol=1e-6)
                self.assertLessEqual(abs(u[0]), 4.0 + 1e-9)
                x = model.A @ x + model.B @ u + model.Bd @ random.choice([-0.5, 0.5], 1)
                self.assertLessEqual(abs(x[1]), 1.0 + 1e-9)
            self.assertLess(abs(x[0]), 0.1)

    def test_outside(self):
        with self.assertRaisesRegex(pf.OutsideError, "e_p_z must be -4 to 4, got 9"):
            pf.RobustLaw(vertical().explicit()).step([9.0, 0.0])

    def test_a_tracking_map_has_no_robust_law(self):
        with self.assertRaisesRegex(pf.Error, "type: must be robust_mpc, got 'tracking_mpc'"):
            pf.RobustLaw(pf.load(ROOT / "region_maps/problems/multirotor_vertical.yaml").solve())
        for source in (mass().problem(), mass().explicit()):
            with self.assertRaisesRegex(pf.Error, "mass: is a robust_mpc, which RobustLaw flies"):
                pf.Law(source)


if __name__ == "__main__":
    run_test.main("python_robust_test")
