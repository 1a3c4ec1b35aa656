"""Problems in and out, the builder, online solutions, laws in a loop."""
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
import polyfly as pf
import run_test
from oracles import (BEMPORAD, LATERAL, MASS, MASS_BOX, MASS_WEIGHTS, ROOT, constrained_input, mass_input, minimiser,
                     random_parameters)


def mass(limit=1.0, model=MASS):
    return pf.MPC(**model).cost(**MASS_WEIGHTS).bounds(u=(-limit, limit)).parameters(MASS_BOX)


def lateral():
    """What lateral_asl.yaml states, by the builder."""
    angle = 0.436
    A = [[0, 1, 0], [0, -0.01, 9.81], [0, 0, -5]]
    return (pf.MPC(A, [0, 0, 4.5], Ts=0.1, horizon=20, C=[[1, 0, 0]], Bd=[0, 1, 0], name="lateral_asl",
                   states=[("p", "m"), ("v", "m/s"), ("phi", "rad")], inputs=[("u", "rad")],
                   disturbances=[("d", "m/s^2")])
            .cost([40, 20, 10], [35], [0.3]).bounds(u=(-angle, angle))
            .parameters({"e_p": (-3, 3), "e_v": (-3, 3), "e_phi": (-0.6, 0.6), "u_prev": (-angle, angle),
                         "u_ref": (-0.2, 0.2)}))


class Builder(unittest.TestCase):
    def test_input_is_the_optimum(self):
        law = mass().explicit()
        for error in random_parameters([-3, -2], [3, 2], 60, seed=11):
            expected = mass_input(error, MASS_WEIGHTS, MASS["Ts"], MASS["horizon"], 1.0)
            np.testing.assert_allclose(law(error), expected, atol=1e-7)

    def test_states_are_named_by_their_errors(self):
        self.assertEqual(["p", "v"], [state.name for state in mass().problem().states])

    def test_the_same_map_as_the_file(self):
        built, read = lateral().explicit(), pf.load(LATERAL).solve()
        np.testing.assert_array_equal(built.planes, read.planes)
        np.testing.assert_array_equal(built.laws, read.laws)
        self.assertEqual([repr(signal) for signal in read.parameters], [repr(signal) for signal in built.parameters])

    def test_the_tool_solves_the_saved_problem_to_the_same_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            files = [pathlib.Path(folder) / name for name in ("mass.yaml", "tool.map", "module.map")]
            problem, by_tool, by_module = files
            mass().save(problem)
            subprocess.run([os.environ["OFFLINE_MPT_PROGRAM"], "solve", problem, "-o", by_tool, "--quiet"], check=True)
            mass().explicit().save(by_module)
            self.assertEqual(by_tool.read_bytes(), by_module.read_bytes())

    def test_bounds_of_states(self):
        bounded = mass(limit=5.0).bounds(e=([-np.inf, -0.5], [np.inf, 0.5]), u=(-5, 5))
        problem = bounded.problem()
        self.assertEqual([(-np.inf, np.inf), (-0.5, 0.5)], [(state.lower, state.upper) for state in problem.states])
        law, model = bounded.explicit(), problem.discretise()
        thetas = random_parameters([-3, -0.5], [3, 0.5], 200, seed=4)
        inputs = law.evaluate(thetas)
        known = ~np.isnan(inputs[:, 0])
        self.assertGreater(np.count_nonzero(known), 100)
        after = thetas[known] @ model.A.T + inputs[known] @ model.B.T
        self.assertLess(np.max(np.abs(after[:, 1])), 0.5 + 1e-6)

    def test_bounds_as_pairs_of_each_state(self):
        pairs = mass().bounds(e=[(-1, 2), (-0.5, 3)], u=(-1, 1)).problem()
        self.assertEqual([(-1, 2), (-0.5, 3)], [(state.lower, state.upper) for state in pairs.states])

    def test_sentences(self):
        for build, sentence in (
                (lambda: pf.MPC(**MASS).problem(), "mass: cost, bounds of u and parameters must be given"),
                (lambda: mass().cost([10, -1], [0.5]).problem(), "mass:[0-9]+: weights.Q"),
                (lambda: mass().cost([10, 1], [0.5], terminal="zero").problem(), "weights.terminal"),
                (lambda: mass().parameters({**MASS_BOX, "e_v": (2, -2)}).problem(), "mass:[0-9]+: parameters.*range"),
                (lambda: mass().parameters({**MASS_BOX, "w": (0, 1)}).problem(), "w is none of e_p, e_v"),
                (lambda: mass().bounds(u=(-1, np.nan)).problem(), "mass:[0-9]+: .*range"),
                (lambda: mass().bounds(x=([1, 2, 3], 4), u=(-1, 1)).problem(), "x must be a pair .* lists of 2"),
                (lambda: mass().bounds(x=[[-1, 1], [-2, 2]], u=(-1, 1)).problem(), "x can be read as"),
                (lambda: mass(model={**MASS, "B": [[0], [1], [2]]}).problem(), "mass:[0-9]+: model.B")):
            with self.subTest(sentence=sentence), self.assertRaisesRegex(pf.Error, sentence):
                build()


# A mass in discrete time, with a given terminal weight, and what the oracle takes of it.
DISCRETE = np.array([[1.0, 0.2], [0.0, 1.0]]), np.array([[0.02], [0.2]])
WEIGHTS = np.diag([4.0, 1.0]), np.array([[0.5]]), np.array([[9.0, 2.0], [2.0, 3.0]])
SPEED = (1, -0.4, 0.4)


def discrete_mass(horizon):
    return (pf.MPC(*DISCRETE, Ts=0.2, horizon=horizon, C=[[1, 0]], time="discrete", name="discrete_mass",
                   states=["p", "v"])
            .cost(Q=[4, 1], R=[0.5], terminal=WEIGHTS[2]).parameters({"e_p": (-1, 1), "e_v": (-0.8, 0.8)}))


class Constraints(unittest.TestCase):
    def compare(self, law, horizon, shift=0.0, soft=None):
        """Against the oracle, where the velocity is held within SPEED, `shift` away from its reference."""
        state, lower, upper = SPEED
        solved = 0
        for error in random_parameters([-1, -0.8], [1, 0.8], 40, seed=7):
            theta = [*error, shift] if len(law.parameters) == 3 else error
            expected = constrained_input(DISCRETE, WEIGHTS, horizon, error, 1.5,
                                         (state, lower - shift, upper - shift), soft)
            if expected is None:
                with self.assertRaises(pf.OutsideError):
                    law(theta)
                continue
            self.assertAlmostEqual(law(theta)[0], expected, delta=1e-6)
            solved += 1
        return solved

    def test_bounds_of_x_in_discrete_time(self):
        law = discrete_mass(3).bounds(x=([-np.inf, -0.4], [np.inf, 0.4]), u=(-1.5, 1.5)).explicit()
        self.assertTrue(5 < self.compare(law, 3) < 40)
        self.assertTrue(law.verify(samples=300))
        self.assertTrue(law.certify())

    def test_bounds_of_x_move_against_the_error_with_the_reference(self):
        mpc = discrete_mass(3).bounds(x=([-np.inf, -0.4], [np.inf, 0.4]), u=(-1.5, 1.5))
        law = mpc.explicit({"e_p": (-1, 1), "e_v": (-0.8, 0.8), "v_ref": (-0.3, 0.3)})
        self.assertGreater(self.compare(law, 3, shift=0.25), 5)
        fixed = mpc.explicit({"e_p": (-1, 1), "e_v": (-0.8, 0.8), "v_ref": 0.25})
        self.assertEqual(["e_p", "e_v"], [signal.name for signal in fixed.parameters])
        self.assertGreater(self.compare(fixed, 3, shift=0.25), 5)

    def test_soft_bounds(self):
        mpc = discrete_mass(2).bounds(x=([-np.inf, -0.4], [np.inf, 0.4]), u=(-1.5, 1.5),
                                      soft={"linear": 0.8, "quadratic": 2.0})
        law = mpc.explicit()
        self.assertEqual(40, self.compare(law, 2, soft=(0.8, 2.0)))
        self.assertTrue(law.verify(samples=300))
        self.assertTrue(law.certify())
        number = mpc.bounds(x=([-np.inf, -0.4], [np.inf, 0.4]), u=(-1.5, 1.5), soft=100.0).text()
        self.assertIn("- {of: v, range: [-0.4, 0.4], soft: {linear: 100.0, quadratic: 0.1}}", number)

    def test_one_constraint_at_a_time(self):
        one_by_one = discrete_mass(3).bounds(u=(-1.5, 1.5))
        one_by_one.constraint("v", lower=-0.4).constraint("v", upper=0.4, name="top")
        at_once = discrete_mass(3).bounds(x=([-np.inf, -0.4], [np.inf, 0.4]), u=(-1.5, 1.5))
        self.assertTrue(pf.diff(one_by_one.explicit(), at_once.explicit()))
        summed = one_by_one.constraint({"p": 1, "v": 0.5}, upper=0.7, name="ahead", unit="m", soft=10.0,
                                       measured_from="reference")
        self.assertIn("- {of: {p: 1.0, v: 0.5}, name: ahead, unit: m, upper: 0.7, soft: {linear: 10.0, "
                      "quadratic: 0.01}, measured_from: reference}", summed.text())
        law = summed.explicit()
        self.assertTrue(law.verify(samples=200))

    def test_a_law_knows_the_reference_of_the_state(self):
        mpc = discrete_mass(3).bounds(x=([-0.5, -np.inf], [0.5, np.inf]), u=(-1.5, 1.5))
        law = pf.Law(mpc.explicit({"e_p": (-1, 1), "e_v": (-0.8, 0.8), "p_ref": (-0.5, 0.5)}))
        np.testing.assert_allclose(law.theta([0.1, 0.2], 0.4), [-0.3, 0.2, 0.4], atol=1e-12)
        x = np.array([-0.4, 0.0])
        for _ in range(60):
            x = DISCRETE[0] @ x + DISCRETE[1] @ law.step(x, 0.5)
            self.assertLess(x[0], 0.5 + 1e-9)
        np.testing.assert_allclose(x, [0.5, 0.0], atol=1e-3)

    def test_sentences(self):
        def bounded():
            return discrete_mass(3).bounds(u=(-1, 1))

        for build, sentence in (
                (lambda: bounded().cost([4, 1], [0.5], terminal=-np.eye(2)), "weights.terminal"),
                (lambda: bounded().bounds(x=(-1, 1), u=(-1, 1), soft={"linear": 1.0}), "constraints.*quadratic"),
                (lambda: bounded().constraint("w", upper=1), "constraints.*must name a state or an "),
                (lambda: bounded().constraint({"p": 1, "v": 1}, upper=1), "constraints.*name"),
                (lambda: bounded().parameters({"e_p": (-1, 1), "e_v": (-1, 1), "v_ref": (1, -1)}), "parameters.*range"),
                (lambda: pf.MPC(*DISCRETE, Ts=0.2, horizon=3, C=[[1, 0]], time="often", states=["p", "v"])
                 .cost([4, 1], [0.5]).bounds(u=(-1, 1)).parameters({"e_p": (-1, 1), "e_v": (-1, 1)}), "model.time")):
            with self.subTest(sentence=sentence), self.assertRaisesRegex(pf.Error, sentence):
                build().problem()


class Problems(unittest.TestCase):
    def test_text_is_written_as_it_was_read(self):
        for path in (LATERAL, ROOT / "region_maps/problems/robust/aslquad_vertical.yaml"):
            with tempfile.TemporaryDirectory() as folder:
                copy = pathlib.Path(folder) / "copy.yaml"
                pf.load(path).save(copy)
                self.assertEqual(path.read_bytes(), copy.read_bytes())

    def test_generic_programs_are_read_back(self):
        program = pf.MPQP(*BEMPORAD.values(), out=[0], name="generic")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "generic.json"
            program.save(path)
            again = pf.load(path)
        self.assertEqual(program.text, again.text)
        for name in ("H", "f", "F", "A", "b", "B", "E"):
            np.testing.assert_array_equal(getattr(program, name), getattr(again, name))
        np.testing.assert_array_equal(program.H, BEMPORAD["H"])
        self.assertEqual(program.solve().checksum, again.solve().checksum)

    def test_programs_of_matlab(self):
        try:
            from scipy.io import savemat
        except ImportError:
            self.skipTest("scipy is not installed")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "generic.mat"
            savemat(path, {**BEMPORAD, "out": 1, "other": "text"})
            found = pf.load_mat(path)
            self.assertEqual(pf.MPQP(*BEMPORAD.values(), out=[0], name="generic").text, found.text)
            savemat(path, {name: value for name, value in BEMPORAD.items() if name != "b"})
            with self.assertRaisesRegex(pf.Error, "generic.mat: b: missing"):
                pf.load_mat(path)
            path.write_bytes(b"no such thing" * 100)
            with self.assertRaisesRegex(pf.Error, "generic.mat: must be a .mat file of version 7 or older"):
                pf.load_mat(path)
        with self.assertRaisesRegex(pf.Error, "none.mat: cannot be opened: no such file"):
            pf.load_mat("none.mat")

    def test_equalities_and_bounds_of_parameters(self):
        # The point on z_0 + z_1 = theta nearest to the origin, for theta <= 0.5.
        program = pf.MPQP(np.eye(2), np.zeros(2), np.zeros((2, 1)), [[1.0, 1.0]], [0.0], [[1.0]], [-1.0], [1.0],
                          equalities=[0], A_theta=[[1.0]], b_theta=[0.5])
        law = program.solve()
        np.testing.assert_allclose(law([0.4]), [0.2, 0.2], atol=1e-12)
        with self.assertRaises(pf.OutsideError):
            law([0.9])

    def test_linear_programs(self):
        # min z_0 + z_1 with both at least |theta|.
        signs = [[-1.0], [1.0]]
        program = pf.MPLP([1.0, 1.0], np.zeros((2, 1)), np.repeat(-np.eye(2), 2, axis=0), np.zeros(4),
                          -np.array(signs * 2), [-1.0], [1.0])
        for theta in (-0.7, 0.3):
            np.testing.assert_allclose(program.solve()([theta]), [abs(theta)] * 2, atol=1e-12)

    def test_sentences(self):
        arrays = list(BEMPORAD.values())
        with self.assertRaisesRegex(pf.Error, r"mpqp: A\[0\]: must have 2 numbers, got 3"):
            pf.MPQP(*arrays[:3], np.ones((4, 3)), *arrays[4:])
        with self.assertRaisesRegex(pf.Error, "mpqp: f: must hold finite numbers only"):
            pf.MPQP(arrays[0], [np.nan, 0], *arrays[2:])
        with self.assertRaisesRegex(pf.Error, "mpqp: lb: must be below ub, entry 0"):
            pf.MPQP(*arrays[:6], arrays[7], arrays[6])
        with self.assertRaisesRegex(pf.Error, "mpqp.*H"):
            pf.MPQP(-arrays[0], *arrays[1:])
        with self.assertRaisesRegex(pf.Error, "mpqp: infeasible: no parameter in its box admits a solution"):
            pf.MPQP([[1.0]], [0.0], [[0.0]], [[1.0], [-1.0]], [0.0, -1.0], [[0.0], [0.0]], [0.0], [1.0]).solve()
        with self.assertRaisesRegex(pf.Error, "tree: must be fast, auto or small, got 'deep'"):
            pf.MPQP(*arrays).solve(tree="deep")
        with self.assertRaisesRegex(pf.Error, "missing.yaml"):
            pf.load("missing.yaml")
        with self.assertRaises(TypeError):
            pf.MPQP(*arrays[:4])


class Online(unittest.TestCase):
    def test_online_program_finds_the_minimiser(self):
        online = pf.MPQP(*BEMPORAD.values()).online()
        for theta in random_parameters(BEMPORAD["lo"], BEMPORAD["hi"], 100, seed=9):
            z = minimiser(BEMPORAD["H"], BEMPORAD["F"] @ theta, BEMPORAD["A"], BEMPORAD["b"])
            np.testing.assert_allclose(online(theta), z, atol=1e-9)
            self.assertLess(online.kkt_residual, 1e-9)
        with self.assertRaisesRegex(pf.Error, "must hold finite numbers only"):
            online([np.nan, 0])

    def test_infeasible(self):
        online = pf.MPQP([[1.0]], [0.0], [[0.0]], [[1.0], [-1.0]], [0.0, -0.5], [[1.0], [0.0]], [0.0], [1.0]).online()
        with self.assertRaisesRegex(pf.OutsideError, "the constraints contradict each other"):
            online([0.25])
        np.testing.assert_allclose(online([0.75]), [0.5])


class Loops(unittest.TestCase):
    def test_parameter_of_a_state(self):
        law = pf.Law(pf.load(LATERAL))
        # In steady state 9.81 phi + d = 0 and phi = 0.9 u.
        disturbance = 0.5
        phi = -disturbance / 9.81
        theta = law.theta([1.0, 0.2, 0.1], 3.0, disturbance)
        np.testing.assert_allclose(theta, [-2.0, 0.2, 0.1 - phi, phi / 0.9, phi / 0.9], atol=1e-12)

    def test_map_and_online_law_fly_alike(self):
        problem = pf.load(LATERAL)
        explicit, online, model = pf.Law(problem.solve()), pf.Law(problem), problem.discretise()
        x, disturbance = np.array([-2.0, 0.0, 0.0]), 0.3
        for _ in range(150):
            u = explicit.step(x, 0.5, disturbance)
            np.testing.assert_allclose(online.step(x, 0.5, disturbance), u, atol=1e-7)
            x = model.A @ x + model.B @ u + model.Bd @ [disturbance]
        np.testing.assert_allclose(x, [0.5, 0.0, -disturbance / 9.81], atol=1e-3)

    def test_outside_keeps_the_last_input(self):
        law = pf.Law(pf.load(LATERAL).solve())
        law.step([1.0, 0.0, 0.0], 0.0)
        before = law.theta([1.0, 0.0, 0.0], 0.0)
        with self.assertRaisesRegex(pf.OutsideError, "e_p must be -3 to 3, got 9"):
            law.step([9.0, 0.0, 0.0], 0.0)
        np.testing.assert_array_equal(before, law.theta([1.0, 0.0, 0.0], 0.0))
        law.reset()
        self.assertEqual(0.0, law.theta([1.0, 0.0, 0.0], 0.0)[3])

    def test_wrong_sizes(self):
        with self.assertRaisesRegex(pf.Error, "lateral_asl: reference: must have 1 numbers, got 2"):
            pf.load(LATERAL).steady_state([1.0, 2.0])
        law = pf.Law(mass().problem())
        for arguments, sentence in ((([0.5], 0.0), "mass: state: must be a vector of 2 numbers"),
                                    (([0.5, 0.0], [0.0, 1.0]), "mass: reference: must be a vector of 1 numbers"),
                                    (([0.5, 0.0], 0.0, 1.0), "mass: disturbance: must be a vector of 0 numbers")):
            with self.subTest(sentence=sentence), self.assertRaisesRegex(pf.Error, sentence):
                law.step(*arguments)

    def test_what_a_steady_state_needs_is_named(self):
        disturbed = {**MASS, "Bd": [0, 1]}
        bounded = mass().bounds(x=[(-1, 1), (-np.inf, np.inf)], u=(-1, 1)).parameters(MASS_BOX)
        fixed = mass().bounds(x=[(-1, 1), (-np.inf, np.inf)], u=(-1, 1)).parameters({**MASS_BOX, "p_ref": 0.3})
        for law, arguments, name in ((mass(model=disturbed), ([0.5, 0.0], 0.0, 0.1), "u_ref"),
                                     (bounded, ([0.5, 0.0], 0.8), "p_ref"), (fixed, ([0.5, 0.0], 0.8), "p_ref")):
            with self.subTest(name=name), self.assertRaisesRegex(pf.Error, f"parameters: {name}: the law takes it as"):
                pf.Law(law.problem()).step(*arguments)
        for law, reference in ((mass(), 0.8), (bounded, 0.0), (fixed, 0.3)):
            pf.Law(law.problem()).step([0.5, 0.0], reference)

    def test_references_cover_the_disturbance_of_errors(self):
        text = mass(model={**MASS, "Bd": [0, 1]}).parameters({**MASS_BOX, "u_ref": (-0.5, 0.5)}).text()
        law = pf.Law(pf.parse_problem(text + "  - {name: d_more, role: disturbance, of: d, unit: '1', range: [-1, 1]}\n", "text"))
        np.testing.assert_allclose(law.theta([0.5, 0.0], 0.0, 0.1), [0.5, 0.0, -0.1, 0.0], atol=1e-12)


class Robust(unittest.TestCase):
    def test_map_is_the_online_law_and_proven(self):
        problem = pf.load(ROOT / "region_maps/problems/robust/aslquad_vertical.yaml")
        self.assertIsInstance(problem, pf.RobustProblem)
        law, online = problem.solve(), problem.online()
        lower, upper = zip(*((signal.lower, signal.upper) for signal in problem.parameters))
        compared = 0
        for theta in random_parameters(lower, upper, 40, seed=6):
            try:
                u = law(theta)
            except pf.OutsideError:
                with self.assertRaises(pf.OutsideError):
                    online(theta)
                continue
            np.testing.assert_allclose(u[0], online(theta), atol=1e-6)
            compared += 1
        self.assertGreater(compared, 5)
        self.assertTrue(law.verify(samples=50, seed=2))
        self.assertTrue(law.certify())
        with self.assertRaisesRegex(pf.Error, "a robust_mpc has no parametric program"):
            law.program()


if __name__ == "__main__":
    run_test.main("python_problem_test")
