#!/usr/bin/env python3
"""Tests what `cmake --install` leaves: the programs of test/examples/, compiled against it in a folder that it was moved to.

POLYFLY_BUILD is the folder of a plain build with all libraries and tools. With GTEST_OUTPUT=xml:FOLDER/ the cases are left
in FOLDER/install_test.xml.
"""
import os
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest

import run_test

BUILD = os.environ["POLYFLY_BUILD"]
PROBLEMS = os.path.join(run_test.ROOT, "region_maps", "problems")
AXES = ("longitudinal", "lateral", "vertical")
# Within the box of multirotor_lateral.yaml, with the input at no bound, at its bound, and at a corner of the box.
THETAS = (("0.1", "-0.05", "0.02", "0.01", "0"), ("1.5", "0.5", "0", "0", "0"), ("-2", "0", "0.1", "0.05", "-0.02"))
# Text of programs that find the package in other ways than the examples.
ONE_COMPONENT = """cmake_minimum_required(VERSION 3.16)
project(reader LANGUAGES CXX)
set(CMAKE_DISABLE_FIND_PACKAGE_Eigen3 ON)
find_package(polyfly REQUIRED COMPONENTS region_maps OPTIONAL_COMPONENTS no_such_component)
if(polyfly_no_such_component_FOUND OR TARGET polyfly::mpc_core OR TARGET region_maps)
  message(FATAL_ERROR "found too much")
endif()
"""
NO_COMPONENT = """cmake_minimum_required(VERSION 3.16)
project(reader LANGUAGES CXX)
find_package(polyfly REQUIRED COMPONENTS no_such_component)
"""
LATER_VERSION = """cmake_minimum_required(VERSION 3.16)
project(reader LANGUAGES CXX)
find_package(polyfly 0.9 REQUIRED)
"""


def run(*command, **more):
    """The standard output of a command that must end well."""
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False,
                            **more)
    if result.returncode != 0:
        raise AssertionError(f"{command} ended with {result.returncode}:\n{result.stdout}{result.stderr}")
    return result.stdout


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="install_test_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        first = os.path.join(cls.folder, "first")
        cls.prefix = os.path.join(cls.folder, "moved here")
        run("cmake", "--install", BUILD, "--prefix", first)
        os.rename(first, cls.prefix)
        cls.examples = os.path.join(cls.folder, "examples")
        run("cmake", "-S", os.path.join(run_test.ROOT, "test", "examples"), "-B", cls.examples,
            f"-DCMAKE_PREFIX_PATH={cls.prefix}", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1")
        run("cmake", "--build", cls.examples, "--parallel", "2")
        cls.maps = [os.path.join(cls.folder, axis + ".map") for axis in AXES]
        for axis, path in zip(AXES, cls.maps):
            cls.example("solve_problem", os.path.join(PROBLEMS, f"multirotor_{axis}.yaml"), path)

    @classmethod
    def example(cls, name, *arguments):
        return run(os.path.join(cls.examples, name), *arguments)

    def configure(self, text):
        """Configures a project with this CMakeLists.txt; whether it could be."""
        source = tempfile.mkdtemp(dir=self.folder)
        with open(os.path.join(source, "CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write(text)
        result = subprocess.run(["cmake", "-S", source, "-B", os.path.join(source, "build"),
                                 f"-DCMAKE_PREFIX_PATH={self.prefix}"], stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, universal_newlines=True, check=False)
        return result.returncode == 0, result.stdout

    def pkg_config(self, *arguments):
        prefix = self.prefix
        if tuple(map(int, run("pkg-config", "--version").split(".")[:2])) < (1, 8):
            # That of Debian 11 escapes no space of a path.
            prefix = os.path.join(self.folder, "without_space")
            if not os.path.lexists(prefix):
                os.symlink(self.prefix, prefix)
        paths = os.path.join(prefix, "lib", "pkgconfig")
        return shlex.split(run("pkg-config", *arguments, env={**os.environ, "PKG_CONFIG_PATH": paths}))

    def test_the_solver_of_the_library_is_that_of_the_tool(self):
        tool = os.path.join(self.prefix, "bin", "offline_mpt")
        map_of_tool = os.path.join(self.folder, "tool.map")
        run(tool, "solve", "--quiet", os.path.join(PROBLEMS, "multirotor_lateral.yaml"), "-o", map_of_tool)
        with open(map_of_tool, "rb") as expected, open(self.maps[1], "rb") as solved:
            self.assertEqual(expected.read(), solved.read())

    def test_the_map_answers_as_the_online_solver_does(self):
        inputs = set()
        for theta in THETAS:
            looked_up = float(self.example("look_up", self.maps[1], *theta))
            online = float(self.example("online_qp", os.path.join(PROBLEMS, "multirotor_lateral.yaml"), *theta))
            self.assertAlmostEqual(looked_up, online, delta=1e-8)
            inputs.add(looked_up)
        self.assertEqual(len(THETAS), len(inputs))

    def test_a_map_is_verified(self):
        self.assertEqual("proven", self.example("verify_map", self.maps[2]).split("\n")[-2])

    def test_a_law_flies(self):
        self.assertLess(float(self.example("fly_law", *self.maps)), 0.02)

    def test_a_path_is_followed(self):
        self.assertLess(float(self.example("follow_path")), 1.0)

    def test_tools_are_installed(self):
        tools = os.listdir(os.path.join(self.prefix, "bin"))
        self.assertEqual({"calibrate", "check_certificate", "check_problem", "mission", "offline_mpt"}, set(tools))
        for tool in tools:
            self.assertRegex(run(os.path.join(self.prefix, "bin", tool), "--version"), r"^\w+ \d+\.\d+\.\d+\n$")
        # One version of all.
        self.assertEqual(1, len({run(os.path.join(self.prefix, "bin", tool), "--version").split()[1] for tool in tools}))

    def test_problem_files_are_installed(self):
        self.assertEqual({name for name in os.listdir(PROBLEMS) if name.endswith(".yaml")},
                         {name for name in os.listdir(os.path.join(self.prefix, "share", "polyfly", "problems"))
                          if name.endswith(".yaml")})

    def test_one_component_needs_no_package_of_another(self):
        done, output = self.configure(ONE_COMPONENT)
        self.assertTrue(done, output)

    def test_what_is_not_installed_is_not_found(self):
        for text, word in ((NO_COMPONENT, "no_such_component"), (LATER_VERSION, "0.9")):
            done, output = self.configure(text)
            self.assertFalse(done, output)
            self.assertIn(word, output)

    def test_pkg_config_compiles_and_links(self):
        for example, component in (("look_up", "region_maps"), ("verify_map", "offline_mpt_exact")):
            source = os.path.join(run_test.ROOT, "test", "examples", example + ".cpp")
            program = os.path.join(self.folder, example + "_by_pkg_config")
            flags = self.pkg_config("--cflags", "--libs", "polyfly_" + component)
            run("c++", "-std=c++17", source, "-o", program, *flags)
        self.assertEqual("proven", run(program, self.maps[2]).split("\n")[-2])

    def test_public_headers_include_no_private_one(self):
        include = os.path.join(self.prefix, "include", "polyfly")
        headers = sorted(os.path.relpath(os.path.join(folder, name), include)
                         for folder, _, names in os.walk(include) for name in names)
        self.assertIn(os.path.join("region_maps", "region_map.hpp"), headers)
        # The layout of the file and of memory is no user's concern.
        for private in ("format.hpp", "read_file.hpp"):
            self.assertNotIn(os.path.join("region_maps", private), headers)
        source = os.path.join(self.folder, "headers.cpp")
        with open(source, "w", encoding="utf-8") as file:
            file.writelines(f'#include "{header}"\n' for header in headers)
        modules = [name[:-3] for name in sorted(os.listdir(os.path.join(self.prefix, "lib", "pkgconfig")))]
        run("c++", "-std=c++17", "-fsyntax-only", source, *self.pkg_config("--cflags", *modules))

    def test_no_file_names_a_folder_of_the_build(self):
        for folder, _, names in os.walk(os.path.join(self.prefix, "lib")):
            for name in names:
                if name.endswith((".cmake", ".pc")):
                    with open(os.path.join(folder, name), encoding="utf-8") as file:
                        text = file.read()
                    for path in (BUILD, run_test.ROOT, os.path.join(self.folder, "first")):
                        # not as the end of another path
                        self.assertNotRegex(text, rf"(?<![\w}}])(-[IL])?{re.escape(path)}", name)


if __name__ == "__main__":
    run_test.main("install_test")
