#!/usr/bin/env python3
"""Runs matlab/write_program.m under Octave on programs as MPT3 and YALMIP have them. Skipped where Octave is not installed.

OFFLINE_MPT is the tool that solves what was written.
"""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

MATLAB = pathlib.Path(__file__).resolve().parent.parent / "matlab"
LOWER, UPPER = [-1, -2], [1, 2]
# The program of all cases: three variables, of which the last is fixed by an equality, and two parameters.
PROGRAM = {
    "H": [[2, 0.1, 0], [0.1, 1, 0], [0, 0, 1]], "f": [0.3, -0.7, 0], "F": [[1, 0.2], [0, 1 / 3], [0, 0]],
    "A": [[1, 1, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 1, 1]], "b": [1.1, 0.9, 0.8, 0.7, 0.1],
    "B": [[0.1, 0], [0, 0], [0, 0], [0, 0], [0.5, -0.25]], "eq_ids": [4], "lb": LOWER, "ub": UPPER,
    "A_theta": [[1, 1]], "b_theta": [2.5],
}
OPT = """
S.H = [2 0.1 0; 0.1 1 0; 0 0 1]; S.f = [0.3; -0.7; 0]; S.pF = [1 0.2; 0 1/3; 0 0];
S.A = [1 1 0]; S.b = 1.1; S.pB = [0.1 0]; S.Ae = [0 1 1]; S.be = 0.1; S.pE = [0.5 -0.25];
S.lb = [-Inf; -0.7; -Inf]; S.ub = [0.9; 0.8; Inf]; S.Ath = [1 1]; S.bth = 2.5;
"""
YALMIP = """
S.H = [2 0.1 0; 0.1 1 0; 0 0 1]; S.Cf = [0.3 -0.7 0]; S.F = sparse([1 0 0; 0.2 1/3 0]);
S.G = sparse([1 1 0]); S.W = 1.1; S.E = [0.1 0]; S.Aeq = [0 1 1]; S.beq = 0.1; S.Beq = [-0.5 0.25];
S.lb = [-Inf; -0.7; -Inf; -1; -2]; S.ub = [0.9; 0.8; Inf; 1; 2]; S.bndA = [1 1]; S.bndb = 2.5; S.qp = 1;
S.requested_variables = [1 2];
"""
# A linear program: YALMIP calls its cost H, and the cost that depends on parameters D.
LINEAR_OPT = """
S.H = []; S.f = [1; 2]; S.pF = [0.5 0; 0 0.25]; S.A = [-1 0; 0 -1]; S.b = [1; 1]; S.pB = [1 0; 0 1];
S.Ae = []; S.be = []; S.pE = []; S.lb = [-5; -5]; S.ub = [5; 5]; S.Ath = []; S.bth = [];
"""
LINEAR_YALMIP = """
S.H = [1 2]; S.D = [0.5 0; 0 0.25]; S.F = [0 0]; S.Cf = [1 2]; S.G = [-1 0; 0 -1]; S.W = [1; 1]; S.E = [1 0; 0 1];
S.Aeq = zeros(0, 2); S.beq = zeros(0, 1); S.Beq = zeros(0, 2);
S.lb = [-5; -5; -1; -2]; S.ub = [5; 5; 1; 2]; S.bndA = []; S.bndb = []; S.qp = 0; S.requested_variables = [1 2];
"""


@unittest.skipIf(shutil.which("octave-cli") is None, "Octave is not installed")
class WriteProgram(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="write_program_test_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def run_tool(self, *words):
        return subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True, check=False)

    def written(self, name, text):
        """The problem that the script writes of a program in Octave's language."""
        path = self.folder / (name + ".json")
        code = f"addpath('{MATLAB}'); {text} write_program(S, '{path}', {LOWER}, {UPPER});"
        result = self.run_tool("octave-cli", "--norc", "--eval", code)
        self.assertEqual(0, result.returncode, result.stdout)
        return json.loads(path.read_text(encoding="utf-8"))

    def solved(self, name):
        result = self.run_tool(os.environ["OFFLINE_MPT"], "solve", "--quiet", self.folder / (name + ".json"), "-o",
                               self.folder / (name + ".map"))
        self.assertEqual(0, result.returncode, result.stdout)
        return self.folder / (name + ".map")

    def test_every_bit_of_the_program_is_written(self):
        self.assertEqual(PROGRAM, self.written("opt", OPT))
        self.assertEqual({**PROGRAM, "out": [0, 1]}, self.written("yalmip", YALMIP))

    def test_what_is_written_can_be_solved(self):
        for name, text in (("opt", OPT), ("yalmip", YALMIP)):
            self.written(name, text)
            self.solved(name)

    def test_a_linear_program_is_the_same_in_both_forms(self):
        opt = self.written("opt", LINEAR_OPT)
        self.assertEqual([[0, 0], [0, 0]], opt["H"])
        self.assertEqual([[0.5, 0], [0, 0.25]], opt["F"])
        self.assertEqual({**opt, "out": [0, 1]}, self.written("yalmip", LINEAR_YALMIP))
        self.assertEqual(0, self.run_tool(os.environ["OFFLINE_MPT"], "diff", self.solved("opt"), self.solved("yalmip")).returncode)


if __name__ == "__main__":
    unittest.main(verbosity=2)
