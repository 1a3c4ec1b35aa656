"""Problems in and out, the builder, online solutions, laws in a loop."""
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
import polyfly as pf
import run_test
from oracles import BEMPORAD, LATERAL, MASS, MASS_BOX, MASS_WEIGHTS, ROOT, mass_input, minimiser, random_parameters


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
        bounded = mass(limit=5.0).bounds(x=([-np.inf, -0.5], [np.inf, 0.5]), u=(-5, 5))
        problem = bounded.problem()
        self.assertEqual([(-np.inf, np.inf), (-0.5, 0.5)], [(state.lower, state.upper) for state in problem.states])
        law, model = bounded.explicit(), problem.discretise()
        thetas = random_parameters([-3, -0.5], [3, 0.5], 200, seed=4)
        inputs = law.evaluate(thetas)
        known = ~np.isnan(inputs[:, 0])
        self.assertGreater(np.count_nonzero(known), 100)
        after = thetas[known] @ model.A.T + inputs[known] @ model.B.T
        self.assertLess(np.max(np.abs(after[:, 1])), 0.5 + 1e-6)

    def test_sentences(self):
        for build, sentence in (
                (lambda: pf.MPC(**MASS).problem(), "mass: cost, bounds of u and parameters must be given"),
                (lambda: mass().cost([10, -1], [0.5]).problem(), "mass:[0-9]+: weights.Q"),
                (lambda: mass().cost([10, 1], [0.5], terminal="zero").problem(), "weights.terminal"),
                (lambda: mass().parameters({**MASS_BOX, "e_v": (2, -2)}).problem(), "mass:[0-9]+: parameters.*range"),
                (lambda: mass().parameters({**MASS_BOX, "w": (0, 1)}).problem(), "w is none of e_p, e_v"),
                (lambda: mass().bounds(u=(-1, np.nan)).problem(), "mass:[0-9]+: .*range"),
                (lambda: mass().bounds(x=([1, 2, 3], 4), u=(-1, 1)).problem(), "x must be a pair .* lists of 2"),
                (lambda: mass(model={**MASS, "B": [[0], [1], [2]]}).problem(), "mass:[0-9]+: model.B")):
            with self.subTest(sentence=sentence), self.assertRaisesRegex(pf.Error, sentence):
                build()


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
