"""Pages, C code and comparisons of maps: what the tool gives."""
import _thread
import json
import os
import pathlib
import subprocess
import tempfile
import threading
import unittest

import numpy as np
import polyfly as pf
import run_test
from oracles import BEMPORAD, LATERAL, ROOT, random_parameters

CODE_FILES = ("clip.c", "clip.h", "clip_test.c", "clip.json")


def tool(*arguments):
    """Exit code of `offline_mpt`, which is to write nothing on standard error."""
    result = subprocess.run([os.environ["OFFLINE_MPT_PROGRAM"], *map(str, arguments)], capture_output=True, text=True)
    if result.stderr:
        raise AssertionError(result.stderr)
    return result.returncode


class FolderCase(unittest.TestCase):
    """A folder with a map in it."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.path = self.folder / "law.map"
        pf.MPQP(*BEMPORAD.values()).solve().save(self.path)
        self.map = pf.open(self.path)

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())


class Explore(FolderCase):
    def test_page_is_that_of_the_tool(self):
        vertical = self.folder / "vertical.map"
        pf.load(ROOT / "region_maps/problems/multirotor_vertical.yaml").solve().save(vertical)
        for path in (self.path, vertical):
            self.assertEqual(0, tool("explore", path, "-o", self.folder / "tool.html"))
            pf.open(path).explore(self.folder / "module.html")
            self.assertEqual((self.folder / "tool.html").read_bytes(), (self.folder / "module.html").read_bytes())

    def test_samples_are_those_of_the_tool(self):
        samples = random_parameters([0, -1.5, -1.5], [9, 1.5, 1.5], 20, seed=4)
        samples[3, 1] = np.nan
        file = self.folder / "samples"
        file.write_text("\n".join(",".join(map(repr, row)) for row in samples.tolist()), encoding="utf-8")
        self.assertEqual(0, tool("explore", self.path, "--samples", file, "-o", self.folder / "tool.html"))
        page = self.folder / "module.html"
        self.map.explore(page, samples=samples)
        self.assertEqual((self.folder / "tool.html").read_bytes(), page.read_bytes())
        self.map.explore(page)
        self.assertNotEqual((self.folder / "tool.html").read_bytes(), page.read_bytes())

    def test_wrong_samples_and_outputs_are_refused(self):
        page = self.folder / "page.html"
        with self.assertRaisesRegex(pf.Error, "law.map: samples: must have rows of 3 numbers, got 4 x 2"):
            self.map.explore(page, samples=np.zeros((4, 2)))
        with self.assertRaisesRegex(pf.Error, "flight.times"):
            self.map.explore(page, samples=[[np.nan, 0, 0]])
        before = self.path.read_bytes()
        with self.assertRaisesRegex(pf.Error, "law.map: is read or written by this command already"):
            self.map.explore(self.path)
        with self.assertRaisesRegex(pf.Error, "page.html: folder '.*missing' does not exist"):
            self.map.explore(self.folder / "missing/page.html")
        self.assertEqual(before, self.path.read_bytes())
        self.assertEqual(["law.map"], self.names())

    def test_a_map_in_memory_has_no_file_to_protect(self):
        target = self.folder / "mpqp"
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        pf.MPQP(*BEMPORAD.values()).solve().explore("mpqp")
        self.assertIn(b"<html", target.read_bytes())


class Export(FolderCase):
    def written(self, folder):
        self.assertEqual(sorted(CODE_FILES), sorted(path.name for path in folder.iterdir()))
        return [(folder / name).read_bytes() for name in CODE_FILES]

    def test_files_are_those_of_the_tool(self):
        vertical = self.folder / "vertical.map"
        pf.load(ROOT / "region_maps/problems/multirotor_vertical.yaml").solve().save(vertical)
        for path in (self.path, vertical):
            for kind in ("double", "float"):
                by_tool = self.folder / path.stem / kind / "tool"
                by_module = self.folder / path.stem / kind / "module"
                self.assertEqual(0, tool("export", path, "--name", "clip", "--type", kind, "-o", by_tool))
                pf.open(path).export("clip", by_module, type=kind)
                self.assertEqual(self.written(by_tool), self.written(by_module))

    def test_the_checker_confirms_the_code_of_a_map_in_memory(self):
        code = self.folder / "code"
        pf.MPQP(*BEMPORAD.values()).solve().export("clip", code, "float")
        checked = subprocess.run([os.environ["CHECK_CERTIFICATE"], "--export", code, "--map", self.path],
                                 capture_output=True, text=True)
        self.assertEqual(0, checked.returncode, checked.stdout + checked.stderr)

    def test_the_folder_is_the_working_one_and_the_type_double(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        self.map.export("clip")
        self.assertEqual(sorted((*CODE_FILES, "law.map")), self.names())
        self.assertIn('"type": "double"', pathlib.Path("clip.json").read_text(encoding="utf-8"))

    def test_ctrl_c_leaves_nothing(self):
        law = pf.load(LATERAL).solve()
        with self.assertRaises(KeyboardInterrupt):
            threading.Thread(target=_thread.interrupt_main).start()
            law.export("clip", self.folder / "code", "float")
        self.assertEqual(["law.map"], self.names())

    def test_wrong_arguments_write_nothing(self):
        with self.assertRaisesRegex(pf.Error, "type: must be double or float, got 'half'"):
            self.map.export("clip", self.folder, "half")
        with self.assertRaisesRegex(pf.Error, "type: int16 was removed.*use float"):
            self.map.export("clip", self.folder, "int16")
        with self.assertRaisesRegex(pf.Error, "2clip"):
            self.map.export("2clip", self.folder / "code")
        with self.assertRaisesRegex(pf.Error, "the folder to write to must have a name"):
            self.map.export("clip", "")
        with self.assertRaisesRegex(pf.Error, "law.map.*folder"):
            self.map.export("clip", self.path)
        self.assertEqual(["law.map"], self.names())


class Diff(FolderCase):
    def setUp(self):
        super().setUp()
        # A bound of z that is looser changes laws; a box that is smaller leaves parameters without an answer.
        looser = {**BEMPORAD, "b": np.array([2.0, 2.0, 2.5, 2.0]), "hi": np.array([1.5, 1.0])}
        self.other_path = self.folder / "other.map"
        pf.MPQP(*looser.values()).solve().save(self.other_path)
        self.other = pf.open(self.other_path)

    def test_numbers_are_those_of_the_tool(self):
        report = pf.diff(self.map, self.other, tolerance=1e-6)
        file = self.folder / "diff.json"
        self.assertEqual(1, tool("diff", self.path, self.other_path, "--tolerance", "1e-6", "--json", file, "--quiet"))
        self.assertEqual(file.read_text(encoding="utf-8"), report.json)
        expected = json.loads(report.json)
        for name in ("same", "first_regions", "second_regions", "pairs", "different_pairs", "tolerance"):
            self.assertEqual(expected[name], getattr(report, name), name)
        for name in ("greatest", "differences"):
            parts = [{"input": self.map.inputs[part.input].name, "size": part.size, "first_region": part.first_region,
                      "second_region": part.second_region, "theta": list(part.theta)} for part in getattr(report, name)]
            self.assertEqual(expected[name], parts)
        self.assertGreater(len(report.differences), 0)
        self.assertTrue(report.first_covers_second)
        self.assertFalse(report.second_covers_first)
        cover = report.second_covers_first
        self.assertEqual(expected["second_covers_first"],
                         {"covers": False, "region": cover.region, "theta": list(cover.witness)})
        self.assertIn("different answers", str(report))
        self.assertFalse(report)

    def test_no_sample_differs_by_more(self):
        report = pf.diff(self.map, self.other)
        thetas = random_parameters(BEMPORAD["lo"], [1.5, 1.0], 20_000, seed=6)
        sampled = np.max(np.abs(self.map.evaluate(thetas) - self.other.evaluate(thetas)), axis=0)
        self.assertGreater(np.max(sampled), 0.1)
        for greatest, size in zip(report.greatest, sampled):
            self.assertLessEqual(size, greatest.size + 1e-12)
            self.assertGreaterEqual(size, 0.9 * greatest.size)
        with self.assertRaises(pf.OutsideError):
            self.other(report.second_covers_first.witness)
        self.map(report.second_covers_first.witness)

    def test_a_map_and_itself(self):
        # Rounded half-spaces of regions that touch in a vertex overlap, where both answers count: they differ by rounding.
        rounding = 4 * np.finfo(float).eps
        report = pf.diff(self.map, self.map, tolerance=rounding, threads=2)
        self.assertTrue(report.same)
        self.assertEqual(0, report.different_pairs)
        self.assertLessEqual(report.greatest[0].size, rounding)
        self.assertIn("the same answers", str(report))

    def test_threads_change_nothing(self):
        self.assertEqual(pf.diff(self.map, self.other, threads=1).json, pf.diff(self.map, self.other, threads=3).json)

    def test_wrong_arguments_are_refused(self):
        for tolerance in (-1.0, np.nan, np.inf):
            with self.assertRaisesRegex(pf.Error, "tolerance: must be a finite number of at least 0"):
                pf.diff(self.map, self.other, tolerance=tolerance)
        with self.assertRaisesRegex(pf.Error, "threads: must be 0"):
            pf.diff(self.map, self.other, threads=257)
        with self.assertRaisesRegex(pf.Error, "parameter"):
            pf.diff(self.map, pf.load(LATERAL).solve(region_limit=1))

    def test_ctrl_c_ends_it(self):
        seen = []

        def interrupt(text):
            seen.append(text)
            _thread.interrupt_main()

        law = pf.load(LATERAL).solve()
        with self.assertRaises(KeyboardInterrupt):
            pf.diff(law, law, progress=interrupt)
        self.assertEqual(1, len(seen))
        self.assertRegex(seen[0], f"compared [0-9]+ of {len(law.regions)} regions")


if __name__ == "__main__":
    run_test.main("python_output_test")
