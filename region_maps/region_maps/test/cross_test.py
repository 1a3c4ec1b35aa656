#!/usr/bin/env python3
"""Cross-compiles the reader of region maps and runs it in an emulator: its answers must be those of this machine, bit for bit.

OFFLINE_MPT is the tool that solves the maps. A machine whose compiler or emulator is not installed is skipped.
"""
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
PROBLEMS = ROOT / "region_maps" / "problems"
LOOKUPS = 5000
# Infeasible where the first parameter exceeds the second by more than 1.
PARTLY_INFEASIBLE = {"H": [[1]], "f": [0.1], "F": [[1, 0.5]], "A": [[1], [-1], [-1]], "b": [1, 1, 0],
                     "B": [[0, 0], [0, 0], [-1, 1]], "lb": [-2, -2], "ub": [2, 2]}


def run(*command, **more):
    """The standard output of a command that must end well."""
    result = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            universal_newlines=True, check=False, **more)
    if result.returncode != 0:
        raise AssertionError(f"{command} ended with {result.returncode}:\n{result.stdout}{result.stderr}")
    return result.stdout


class Cross(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="cross_test_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        tool = os.environ["OFFLINE_MPT"]
        cls.maps = [cls.folder / "lateral.map", cls.folder / "reduced.map", cls.folder / "partly.map"]
        vertical = cls.folder / "vertical.map"
        problem = cls.folder / "partly.json"
        problem.write_text(json.dumps(PARTLY_INFEASIBLE), encoding="utf-8")
        run(tool, "solve", "--quiet", PROBLEMS / "multirotor_lateral.yaml", "-o", cls.maps[0])
        run(tool, "solve", "--quiet", PROBLEMS / "multirotor_vertical.yaml", "-o", vertical)
        run(tool, "reduce", "--quiet", vertical, "-o", cls.maps[1])
        run(tool, "solve", "--quiet", problem, "-o", cls.maps[2])
        program = cls.compile("native", "c++", [])
        cls.expected = [run(program, path, LOOKUPS) for path in cls.maps]

    @classmethod
    def compile(cls, name, compiler, settings):
        """The program lookup_bits, linked with a reader that is built and installed by itself."""
        build, prefix, program = cls.folder / name, cls.folder / (name + "_installed"), cls.folder / (name + "_bits")
        run("cmake", "-S", ROOT, "-B", build, "-DPOLYFLY_READER_ONLY=ON", f"-DCMAKE_CXX_COMPILER={compiler}", *settings)
        run("cmake", "--build", build, "--parallel", "2")
        run("cmake", "--install", build, "--prefix", prefix)
        flags = run("pkg-config", "--cflags", "--libs", "polyfly_region_maps",
                    env={**os.environ, "PKG_CONFIG_LIBDIR": str(prefix / "lib" / "pkgconfig")})
        run(compiler, "-std=c++17", "-O1", "-ffp-contract=off", ROOT / "region_maps" / "region_maps" / "test" / "lookup_bits.cpp",
            "-o", program, *shlex.split(flags))
        return program

    def check(self, machine, compiler, emulator):
        for needed in (compiler, emulator):
            if shutil.which(needed) is None:
                self.skipTest(f"{needed} is not installed")
        program = self.compile(machine, compiler, ["-DCMAKE_SYSTEM_NAME=Linux", f"-DCMAKE_SYSTEM_PROCESSOR={machine}"])
        libraries = "/usr/" + compiler[:-len("-g++")]
        for path, expected in zip(self.maps, self.expected):
            found = run(emulator, "-L", libraries, program, path, LOOKUPS)
            self.assertEqual(LOOKUPS, found.count("\n"))
            # Not assertEqual: the difference of two such texts takes minutes.
            self.assertTrue(found == expected, f"{path.name}: other answers on {machine}")

    def test_the_answers_are_of_all_kinds(self):
        status = [{line[1] for line in expected.splitlines()} for expected in self.expected]
        inside, outside_box, outside_partition = "0", "1", "2"
        self.assertEqual([{inside, outside_box}] * 2 + [{inside, outside_box, outside_partition}], status)

    def test_aarch64(self):
        self.check("aarch64", "aarch64-linux-gnu-g++", "qemu-aarch64")

    def test_armhf(self):
        self.check("arm", "arm-linux-gnueabihf-g++", "qemu-arm")


if __name__ == "__main__":
    unittest.main(verbosity=2)
