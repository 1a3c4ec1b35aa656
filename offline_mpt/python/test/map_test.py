"""Look-ups, views, proofs and files of maps."""
import copy
import os
import pathlib
import pickle
import subprocess
import tempfile
import unittest

import numpy as np
import polyfly as pf
from polyfly import _polyfly
import run_test
from oracles import BEMPORAD, ROOT, minimiser, random_parameters


def bemporad(**options):
    return pf.MPQP(*BEMPORAD.values(), **options)


class Lookups(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.map = bemporad().solve()
        cls.thetas = random_parameters(BEMPORAD["lo"], BEMPORAD["hi"], 300, seed=7)

    def test_input_is_the_minimiser(self):
        self.assertEqual(9, len(self.map.regions))
        for theta in self.thetas:
            z = minimiser(BEMPORAD["H"], BEMPORAD["F"] @ theta, BEMPORAD["A"], BEMPORAD["b"])
            np.testing.assert_allclose(self.map(theta), z, atol=1e-9)

    def test_evaluate_is_the_call_for_each_row(self):
        expected = np.array([self.map(theta) for theta in self.thetas])
        np.testing.assert_array_equal(expected, self.map.evaluate(self.thetas))

    def test_threads_change_nothing(self):
        thetas = random_parameters([-2, -2], [2, 2], 50_000, seed=3)
        one = self.map.evaluate(thetas, threads=1)
        np.testing.assert_array_equal(one, self.map.evaluate(thetas, threads=3))
        np.testing.assert_array_equal(one, self.map.evaluate(thetas, threads=0))
        outside = np.any(np.abs(thetas) > 1.5 + 1e-6, axis=1)
        self.assertTrue(np.all(np.isnan(one[outside])))
        self.assertFalse(np.any(np.isnan(one[np.all(np.abs(thetas) < 1.5, axis=1)])))

    def test_empty_arrays(self):
        self.assertEqual((0, 2), self.map.evaluate(np.zeros((0, 2))).shape)
        self.assertEqual((0,), self.map.locate(np.zeros((0, 2))).shape)

    def test_locate_names_a_region_that_holds_the_parameter(self):
        for theta, index in zip(self.thetas, self.map.locate(self.thetas, threads=2)):
            half_spaces = self.map.regions[index].half_spaces
            self.assertTrue(np.all(half_spaces[:, :-1] @ theta <= half_spaces[:, -1] + 1e-7))
            self.assertTrue(self.map.regions[index].contains(theta))
        self.assertEqual([-1], list(self.map.locate([[9.0, 0.0]])))

    def test_jacobian_is_the_slope_of_the_input(self):
        checked = 0
        for theta, index in zip(self.thetas, self.map.locate(self.thetas)):
            half_spaces, step = self.map.regions[index].half_spaces, 1e-5
            if np.any(half_spaces[:, :-1] @ theta > half_spaces[:, -1] - 1e-3):
                continue
            slope = np.column_stack([(self.map(theta + step * unit) - self.map(theta - step * unit)) / (2 * step)
                                     for unit in np.eye(2)])
            np.testing.assert_allclose(self.map.jacobian(theta), slope, atol=1e-8)
            np.testing.assert_array_equal(self.map.jacobian(theta), self.map.regions[index].K)
            checked += 1
        self.assertGreater(checked, 100)

    def test_other_numbers_are_converted(self):
        np.testing.assert_array_equal(self.map([1, 0]), self.map(np.array([1.0, 0.0])))
        np.testing.assert_array_equal(self.map(np.array([1, 0], dtype=np.float32)), self.map([1, 0]))
        strided = np.array([[1.0, 9.0, 0.0]])[:, ::2]
        np.testing.assert_array_equal(self.map.evaluate(strided)[0], self.map([1, 0]))

    def test_no_answer_is_an_exception(self):
        with self.assertRaisesRegex(pf.OutsideError, "mpqp: theta: theta_1 must be -1.5 to 1.5, got 2"):
            self.map([0, 2])
        with self.assertRaisesRegex(pf.OutsideError, "mpqp: theta: must hold finite numbers only"):
            self.map.jacobian([0, np.nan])
        with self.assertRaisesRegex(pf.Error, "mpqp: theta: must have 2 numbers, got 3"):
            self.map([0, 0, 0])
        with self.assertRaisesRegex(pf.Error, "mpqp: thetas: must have rows of 2 numbers, got 2"):
            self.map.evaluate([0, 0])
        with self.assertRaisesRegex(ValueError, "threads: must be 0"):
            self.map.evaluate(self.thetas, threads=-1)

    def test_infeasible_parameters_have_no_region(self):
        # z <= theta_0 and z >= 0.5: no solution below one half.
        program = pf.MPQP([[1.0]], [0.0], [[0.0]], [[1.0], [-1.0]], [0.0, -0.5], [[1.0], [0.0]], [0.0], [1.0])
        law = program.solve()
        np.testing.assert_allclose(law([0.75]), 0.5)
        with self.assertRaisesRegex(pf.OutsideError, r"mpqp: theta: no region holds \(0.25\)"):
            law([0.25])


class Regions(unittest.TestCase):
    def setUp(self):
        self.map = bemporad().solve()

    def test_vertices_are_where_rows_meet(self):
        for region in self.map.regions:
            a, c = region.half_spaces[:, :-1], region.half_spaces[:, -1]
            corners = []
            for i in range(len(c)):
                for j in range(i):
                    if abs(np.linalg.det(a[[i, j]])) < 1e-12:
                        continue
                    point = np.linalg.solve(a[[i, j]], c[[i, j]])
                    if np.all(a @ point <= c + 1e-9) and not any(np.allclose(point, other) for other in corners):
                        corners.append(point)
            vertices = region.vertices
            self.assertEqual(len(corners), len(vertices))
            for corner in corners:
                self.assertLess(np.min(np.max(np.abs(vertices - corner), axis=1)), 1e-9)

    def test_law_is_affine(self):
        for region in self.map.regions:
            centre = region.vertices.mean(axis=0)
            np.testing.assert_allclose(region.K @ centre + region.k, self.map(centre), atol=1e-12)

    def test_a_sequence(self):
        count = len(self.map.regions)
        self.assertEqual(list(range(count)), [region.index for region in self.map.regions])
        self.assertEqual(count - 1, self.map.regions[-1].index)
        for index in (count, -count - 1):
            with self.assertRaises(IndexError):
                self.map.regions[index]

    def test_arrays_are_views_and_keep_the_map(self):
        region = self.map.regions[3]
        gain = region.K
        self.assertTrue(np.shares_memory(gain, self.map.laws))
        self.assertTrue(np.shares_memory(self.map.jacobian(region.vertices.mean(axis=0)), self.map.laws))
        self.assertTrue(np.shares_memory(self.map.planes, self.map.planes))
        copied = gain.copy()
        for array in (gain, region.k, region.active, self.map.planes, self.map.laws):
            with self.assertRaises(ValueError):
                array[...] = 0
        del region, self.map
        np.testing.assert_array_equal(copied, gain)


class ObjectsWithoutValue(unittest.TestCase):
    """No type makes an object whose C++ value was never written."""

    def test_every_type_of_the_module_refuses_new(self):
        types = [value for value in vars(_polyfly).values()
                 if isinstance(value, type) and not issubclass(value, BaseException)]
        self.assertGreater(len(types), 15)
        for bound in types:
            self.assertRaises(TypeError, bound.__new__, bound)
            self.assertRaises(TypeError, object.__new__, bound)
            own = type("Own", (bound,), {})
            self.assertRaises(TypeError, own.__new__, own)

    def test_copies_are_refused_as_well(self):
        law = pf.MPQP(*BEMPORAD.values()).solve()
        for value in (law, law.regions[0], law.parameters[0]):
            self.assertRaises(TypeError, copy.copy, value)
            self.assertRaises(TypeError, pickle.dumps, value)


class Files(unittest.TestCase):
    def test_saved_and_opened(self):
        law = bemporad(name="saved").solve()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "law.map"
            law.save(path)
            opened = pf.open(path)
            self.assertEqual(str(path), opened.path)
            self.assertEqual((law.checksum, law.bytes, "saved", "complete"),
                             (opened.checksum, opened.bytes, opened.name, opened.status))
            np.testing.assert_array_equal(law.laws, opened.laws)
            copy = pathlib.Path(folder) / "copy.map"
            os.truncate(path, 0)  # what was read stays
            np.testing.assert_array_equal(law.laws, opened.laws)
            path.unlink()
            opened.save(copy)
            self.assertEqual(law.checksum, pf.open(copy).checksum)

    def test_damaged_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "law.map"
            bemporad().solve().save(path)
            data = bytearray(path.read_bytes())
            data[len(data) // 2] ^= 1
            path.write_bytes(data)
            with self.assertRaisesRegex(pf.Error, "law.map: .*checksum"):
                pf.open(path)
            with self.assertRaisesRegex(pf.Error, "missing.map"):
                pf.open(pathlib.Path(folder) / "missing.map")

    def test_certificate_convinces_the_checker(self):
        with tempfile.TemporaryDirectory() as folder:
            law, path, proof = bemporad().solve(), os.path.join(folder, "law.map"), os.path.join(folder, "law.cert")
            law.save(path)
            report = law.certify()
            self.assertTrue(report.passed, str(report))
            report.save(proof)
            command = [os.environ["CHECK_CERTIFICATE"], proof, "--map", path]
            checked = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(0, checked.returncode, checked.stdout + checked.stderr)


class Proofs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.problem = pf.load(ROOT / "region_maps/problems/multirotor_vertical.yaml")
        cls.map = cls.problem.solve()

    def test_verify(self):
        report = self.map.verify(samples=400, seed=5, threads=1)
        self.assertTrue(report)
        self.assertEqual(400, report.samples)
        self.assertLess(report.max_scaled_error, 1e-9)
        self.assertIn("PASSED", str(report))
        self.assertEqual(str(report), str(self.map.verify(samples=400, seed=5, threads=2)))

    def test_a_wrong_map_fails(self):
        part = self.problem.solve(region_limit=len(self.map.regions) // 3)
        self.assertEqual("limited", part.status)
        self.assertFalse(part.verify(samples=400, seed=5))
        report = part.certify()
        self.assertFalse(report.passed)
        self.assertIn("gap", {defect.kind for defect in report.defects})
        with self.assertRaises(pf.Error):
            report.save("never_written.cert")

    def test_reduced_map_answers_as_the_original(self):
        small = self.map.reduce(threads=1)
        self.assertLess(len(small.regions), len(self.map.regions))
        self.assertEqual(self.map.checksum, small.reduced_from)
        lower, upper = zip(*((signal.lower, signal.upper) for signal in self.map.parameters))
        thetas = random_parameters(lower, upper, 5000, seed=2)
        np.testing.assert_allclose(self.map.evaluate(thetas), small.evaluate(thetas), atol=1e-8)
        with self.assertRaisesRegex(pf.Error, "merge: was removed; regions of one law are always joined"):
            self.map.reduce(merge="greedy")
        with self.assertRaisesRegex(pf.Error, "separate: was removed; leave it out"):
            self.map.reduce(separate=True)
        with self.assertRaisesRegex(TypeError, "no argument best"):
            self.map.reduce(best=True)

    def test_picture(self):
        picture = self.map.plot("e_p_z", "e_v_z", at={"T_cmd_ref": 0.1})
        self.assertTrue(picture.svg.startswith("<?xml"))
        self.assertEqual(picture.svg, picture._repr_svg_())
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "law.png"
            self.map.plot("e_p_z", "e_v_z", output=path)
            self.assertEqual(b"\x89PNG", path.read_bytes()[:4])
        with self.assertRaisesRegex(pf.Error, "e_q"):
            self.map.plot("e_p_z", "e_q")


if __name__ == "__main__":
    run_test.main("python_map_test")
