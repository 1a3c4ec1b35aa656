#!/usr/bin/env python3
"""The command check_problem: what it confirms and refuses of files, its options and exit codes."""
import copy
import json
import os
import subprocess
import tempfile
import unittest

from fields import document_of
from files import xxh64
from json_problem import match_json
from proven_map import ProvenMap, refusal_of, sealed

COMMAND = os.environ["CHECK_PROBLEM"]
PROBLEMS = os.path.join(os.environ["POLYFLY_ROOT"], "region_maps", "problems")
PROGRAM = {"name": "two", "H": [[1.5064, 0.4838], [0.4838, 1.5258]], "f": [0, 0],
           "F": [[9.6652, 5.2115], [7.0732, -7.0879]], "A": [[1, 0], [-1, 0], [0, 1], [0, -1]], "b": [2, 2, 2, 2],
           "B": [[0, 0]] * 4, "lb": [-1.5, -1.5], "ub": [1.5, 1.5], "eq_ids": [], "out": [0],
           "parameters": [{"name": "x1", "unit": "m"}, {"name": "x2", "unit": "m/s"}],
           "inputs": [{"name": "u", "unit": "N", "lower": -2, "upper": 2}]}


class Command(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(PROBLEMS, "look_ahead", "vertical.yaml"), encoding="utf-8") as file:
            cls.text = file.read()
        cls.proven = ProvenMap(cls.text)
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.map, cls.cert = cls.write("right.map", cls.proven.content), cls.write("right.cert", cls.proven.certificate)

    @classmethod
    def write(cls, name, content):
        path = os.path.join(cls.folder, name)
        with open(path, "wb") as file:
            file.write(content)
        return path

    def outcome(self, *arguments, **keys):
        """Exit code, output, and the one line of errors."""
        done = subprocess.run([COMMAND, *arguments], stdin=subprocess.DEVNULL, capture_output=not keys, text=True, **keys)
        self.assertLessEqual((done.stderr or "").count("\n"), 1, done.stderr)
        return done.returncode, done.stdout, done.stderr

    def assert_refused(self, code, rule, *arguments):
        found, out, error = self.outcome(*arguments)
        self.assertEqual((code, ""), (found, out), error)
        self.assertIn(rule, error)

    def test_right_files_are_confirmed(self):
        code, out, error = self.outcome(self.cert, "--map", self.map, "--problem", self.write("same.yaml", self.text.encode()))
        self.assertEqual((0, ""), (code, error))
        self.assertRegex(out, "^confirmed: the program is that of the problem, within .*e-17 of the greatest entry")
        self.assertIn("the map's signals, ranges and period are those of the problem", out)

    def test_help_and_version(self):
        code, out, _ = self.outcome("--help")
        self.assertEqual((0, "usage: check_problem CERTIFICATE --map MAP"), (code, out[:42]))
        self.assertRegex(self.outcome("--version")[1], r"^check_problem \d+\.\d+\.\d+\n$")

    def test_bad_command_lines_and_missing_files_give_2(self):
        for rule, arguments in (("file", ()), ("--map", (self.cert,)), ("--nosuch", (self.cert, "--map", self.map, "--nosuch")),
                                ("--map", (self.cert, "--map")), ("other", (self.cert, "other", "--map", self.map)),
                                ("--time-limit", (self.cert, "--map", self.map, "--time-limit", "0")),
                                ("no such file", (self.cert, "--map", self.map + "x")),
                                ("no such file", (self.cert + "x", "--map", self.map)),
                                ("is no file", (self.folder, "--map", self.map)),
                                ("is empty", (self.write("empty", b""), "--map", self.map))):
            self.assert_refused(2, rule, *arguments)
        with open("/dev/full", "w", encoding="utf-8") as full:
            self.assertEqual(2, self.outcome(self.cert, "--map", self.map, stdout=full, stderr=subprocess.DEVNULL)[0])

    def test_other_and_damaged_files_give_1(self):
        other = self.write("other.yaml", self.text.replace("name:", "name: x", 1).encode())
        self.assert_refused(1, "not the one", self.cert, "--map", self.map, "--problem", other)
        flipped = bytearray(self.proven.content)
        for at in range(0, len(flipped), 97):
            flipped[at] ^= 1
            self.assertNotEqual("", refusal_of(type(self.proven.map), bytes(flipped)), at)
            flipped[at] ^= 1
        self.assert_refused(1, "right.map: refused: the map is ", self.cert, "--map", self.write("right.map", bytes(flipped[:-1])))
        self.write("right.map", self.proven.content)
        for content, rule in ((self.proven.certificate[:-9], "checksum"), (b"x", "not a certificate"),
                              (self.proven.certificate.replace(b"0x1", b"0x3", 1), "checksum")):
            self.assert_refused(1, rule, self.write("wrong.cert", content), "--map", self.map)

    def test_lines_that_are_missing_twice_or_unknown_give_1(self):
        lines = self.proven.lines
        for key in ("map ", "problem ", "equalities ", "H ", "S "):
            k = next(k for k, line in enumerate(lines) if line.startswith(key))
            for changed in ([], [lines[k]] * 2, ["odd 1", lines[k]], [lines[k] + " 1"]):
                content = sealed([*lines[:k], *changed, *lines[k + 1:]])
                self.assert_refused(1, "refused", self.write("wrong.cert", content), "--map", self.map)

    def test_a_reduced_map_is_refused(self):
        content = bytearray(self.proven.content)
        content[80] = 1
        content[24:32] = bytes(8)
        content[24:32] = xxh64(bytes(content)).to_bytes(8, "little")
        self.assert_refused(1, "reduced", self.cert, "--map", self.write("reduced.map", bytes(content)))


class Json(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.proven = ProvenMap(json.dumps(PROGRAM), ".json")

    def refusal(self, change=lambda problem: None, region_map=None):
        problem = json.loads(self.proven.map.problem)
        change(problem)
        return refusal_of(match_json, self.proven.read(), json.dumps(problem, indent="\t"), region_map or self.proven.map)

    def test_each_number_matters(self):
        self.assertEqual("", self.refusal())
        for key in ("H", "f", "F", "A", "b", "B", "lb", "ub", "out", "eq_ids"):
            def change(problem, key=key):
                row = problem[key]
                row = row[0] if row and isinstance(row[0], list) else row
                row[:1] = [row[0] + 1e-9 if row and key != "out" else 1]
            self.assertNotEqual("", self.refusal(change), key)
        for ids in ([-1], [4], [0.5], [1e30]):
            self.assertIn("eq_ids", self.refusal(lambda problem, ids=ids: problem.update(eq_ids=ids)))
        self.assertIn("twice", refusal_of(document_of, '{"H": 1, "H": 1}'))

    def test_signals_are_those_of_the_problem(self):
        for name, place, value, rule in (("names", 0, "x2", "in the place of"), ("units", 2, "m", "unit"),
                                         ("bounds", 2, (-2.0, 3.0), "range")):
            wrong = copy.copy(self.proven.map)
            values = list(getattr(wrong, name))
            values[place] = value
            setattr(wrong, name, values)
            self.assertIn(rule, self.refusal(region_map=wrong))
        wrong = copy.copy(self.proven.map)
        wrong.period = 0.1
        self.assertIn("period", self.refusal(region_map=wrong))


if __name__ == "__main__":
    unittest.main()
