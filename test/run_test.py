#!/usr/bin/env python3
"""Tests ./run's promises that need no build: usage, what it installs and removes, how it counts.

Commands that it may call (dpkg-query, id, apt-get) are replaced by exported bash functions, so nothing is
installed. With GTEST_OUTPUT=xml:FOLDER/ the cases are left in FOLDER/run_test.xml.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SCRIPTS = os.path.join(ROOT, "catkin_ws", "scripts")


def run(folder, *arguments, functions=None):
    environment = {"HOME": folder, "PATH": "/usr/bin:/bin"}
    for name, body in (functions or {}).items():
        environment[f"BASH_FUNC_{name}%%"] = "() { " + body + " }"
    return subprocess.run([os.path.join(folder, "run"), *arguments], env=environment, capture_output=True, text=True,
                          stdin=subprocess.DEVNULL)


def os_release(name, number):
    """The body of a `cat` by which another system is found."""
    return f"""[ "$1" = /etc/os-release ] && printf 'ID=%s\\nVERSION_ID="%s"\\n' {name} {number} || command cat "$@";"""


class TreeCase(unittest.TestCase):
    """A copy of what ./run needs, in a folder of its own."""

    def setUp(self):
        self.tree = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.tree)
        shutil.copy(os.path.join(ROOT, "run"), self.tree)
        shutil.copytree(SCRIPTS, os.path.join(self.tree, "catkin_ws", "scripts"))
        for kind in ("bench", "experiments"):
            shutil.copytree(os.path.join(ROOT, "test", kind), os.path.join(self.tree, "test", kind))

    def path(self, *parts):
        return os.path.join(self.tree, *parts)


class Usage(TreeCase):
    def test_wrong_command_lines_give_usage_and_2(self):
        for arguments in ([], ["fly"], ["demo", "twice"], ["clean", "-f"], ["bench", "nosuch"], ["bench", "lookup", "solve"],
                          ["bench", "../run"], ["systems", "10"], ["experiments", "nosuch"], ["experiments", ""], ["lint", "nosuch"]):
            result = run(self.tree, *arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertIn("usage: ./run COMMAND", result.stderr, arguments)
            self.assertTrue(result.stderr.startswith("run: "), arguments)
        self.assertFalse(os.path.exists(self.path("build")), "a refused command line leaves nothing behind")

    def test_help_names_every_command(self):
        result = run(self.tree, "help")
        self.assertEqual(result.returncode, 0)
        for command in ("demo", "build", "test", "sanitize", "bench", "experiments", "isolated", "workspace", "lint", "systems", "package", "install", "clean"):
            self.assertIn(f"\n  {command} ", result.stdout)


class Install(TreeCase):
    def test_installs_nothing_where_nothing_is_missing(self):
        with open(self.path("catkin_ws", "scripts", "packages.txt")) as file:
            names = [name for line in file if not line.startswith("#") for name in re.split("[ :,]+", line.strip())]
        installed = "printf '%s\\n' " + " ".join(f"'installed {name}'" for name in names) + ";"
        result = run(self.tree, "install", functions={"dpkg-query": installed, "apt-get": "touch called; return 1;"})
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertFalse(os.path.exists(self.path("called")))

    def test_installs_only_what_is_missing(self):
        with open(self.path("catkin_ws", "scripts", "packages.txt"), "w") as file:
            file.write("run g++\nrun cmake\nlint clang\n")
        functions = {"dpkg-query": "echo 'installed g++';", "id": "echo 0;", "apt-get": 'echo "$*" >> called;'}
        self.assertEqual(run(self.tree, "install", functions=functions).returncode, 0)
        with open(self.path("called")) as file:
            self.assertEqual(file.read().split(), "update -q install -q -y --no-install-recommends cmake".split())

    def test_packages_have_the_names_of_the_system(self):
        with open(self.path("catkin_ws", "scripts", "packages.txt"), "w") as file:
            file.write("run g++ debian11:g++,g++-9\nrun rosout ubuntu20.04:ros-noetic-rosout\n"
                       "run cli debian11:- ubuntu20.04:-\n")
        for name, number, wanted in (("debian", "11", "g++ g++-9 rosout"), ("debian", "12", "cli g++ rosout"),
                                     ("ubuntu", "20.04", "g++ ros-noetic-rosout")):
            functions = {"dpkg-query": ":;", "id": "echo 0;", "apt-get": 'echo "$*" > called;', "cat": os_release(name, number)}
            self.assertEqual(run(self.tree, "install", functions=functions).returncode, 0)
            with open(self.path("called")) as file:
                self.assertEqual(file.read().split("--no-install-recommends ")[1].split(), wanted.split())

    def test_says_what_is_missing_without_root_and_sudo(self):
        with open(self.path("catkin_ws", "scripts", "packages.txt"), "w") as file:
            file.write("run cmake\n")
        functions = {"dpkg-query": ":;", "id": "echo 1000;", "command": '[ "$2" != sudo ];', "apt-get": "touch called;"}
        result = run(self.tree, "install", functions=functions)
        self.assertEqual(result.returncode, 1)
        self.assertIn("installing them needs root or sudo: cmake", result.stderr)
        self.assertFalse(os.path.exists(self.path("called")))


    def test_says_what_to_do_on_another_system(self):
        for name, number, fits in (("debian", "11", True), ("debian", "12", True), ("debian", "13", True),
                                   ("ubuntu", "20.04", True), ("debian", "10", False), ("ubuntu", "24.04", False)):
            functions = {"dpkg-query": ":;", "id": "echo 0;", "apt-get": "touch called;", "cat": os_release(name, number)}
            result = run(self.tree, "install", functions=functions)
            self.assertEqual(result.returncode, 0 if fits else 1, result.stderr)
            self.assertEqual(os.path.exists(self.path("called")), fits)
            if fits:
                os.remove(self.path("called"))
                continue
            self.assertIn(f"this system is '{name} {number}'", result.stderr)
            for way in ("container", "virtual machine", "cmake -S . -B build/release"):
                self.assertIn(way, result.stderr)


class Presets(unittest.TestCase):
    def test_are_read_as_cmake_reads_them(self):
        with open(os.path.join(ROOT, "CMakePresets.json")) as file:
            names = [preset["name"] for preset in json.load(file)["configurePresets"] if not preset.get("hidden")]
        for name in names:
            told = subprocess.run(["cmake", "--preset", name, "-N"], cwd=ROOT, capture_output=True, text=True).stdout
            if "Preset CMake variables" not in told:
                self.skipTest("this CMake reads no presets")
            ours = subprocess.run([sys.executable, os.path.join(SCRIPTS, "preset.py"), name], capture_output=True, text=True)
            self.assertEqual(ours.stdout.splitlines()[:6],
                             ["-S", ROOT, "-B", os.path.join(ROOT, "build", name), "-G", "Ninja"])
            variables = dict(line[2:].split("=", 1) for line in ours.stdout.splitlines()[6:])
            self.assertEqual(variables, dict(re.findall(r'^  (\w+)="(.*)"$', told, re.MULTILINE)))


class MovedTree(TreeCase):
    def configured(self, folder, place):
        os.makedirs(self.path("build", folder), exist_ok=True)
        os.makedirs(self.path("build", ".run"), exist_ok=True)
        with open(self.path("build", folder, "CMakeCache.txt"), "w") as file:
            file.write(f"CMAKE_CACHEFILE_DIR:INTERNAL={place}\n")
        with open(self.path("build", ".run", "made"), "a") as file:
            file.write(folder.split("/")[0] + "\n")

    def test_asks_for_clean_in_a_tree_that_was_moved_or_copied(self):
        nothing_missing = {"comm": ":;"}
        self.configured("release", self.path("build", "release"))
        self.assertEqual(run(self.tree, "install", functions=nothing_missing).returncode, 0)
        for folder in ("catkin/build", "isolated/build/mpc_core"):
            self.configured(folder, os.path.join(ROOT, "build"))
            result = run(self.tree, "install", functions=nothing_missing)
            self.assertEqual(result.returncode, 1)
            self.assertIn("moved or copied", result.stderr)
            self.assertIn("./run clean", result.stderr)
            self.assertEqual(run(self.tree, "clean").returncode, 0)
            self.assertEqual(run(self.tree, "install", functions=nothing_missing).returncode, 0)


class Clean(TreeCase):
    def test_removes_what_it_made_and_nothing_else(self):
        for folder in ("build/demo", "build/mine", "build/.run"):
            os.makedirs(self.path(folder))
        with open(self.path("build", ".run", "made"), "w") as file:
            file.write("demo\ndemo\nrelease\n")
        self.assertEqual(run(self.tree, "clean").returncode, 0)
        self.assertEqual(os.listdir(self.path("build")), ["mine"])
        self.assertEqual(run(self.tree, "clean").returncode, 0)
        os.rmdir(self.path("build", "mine"))
        self.assertEqual(run(self.tree, "clean").returncode, 0)
        self.assertFalse(os.path.exists(self.path("build")))


class Count(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as file:
            file.write(text)
        return path

    def count(self, *arguments):
        result = subprocess.run([sys.executable, os.path.join(SCRIPTS, "count_tests.py"), *arguments], capture_output=True,
                                text=True)
        self.printed = result.stdout
        return result.returncode, result.stdout.splitlines()[-1]

    def ctest(self, **statuses):
        """What `ctest -T Test` leaves of tests with these statuses."""
        tests = "".join(f'<Test Status="{status}"><Name>{name}</Name><Results/></Test>' for name, status in statuses.items())
        return self.write("r/ctest.xml", f"<Site><Testing><TestList><Test>./a</Test></TestList>{tests}</Testing></Site>")

    def test_cases_of_programs_are_summed(self):
        results = self.ctest(a_test="passed", script="passed")
        self.write("g/a_test.xml", '<testsuites><testsuite><testcase name="x" status="run"/><testcase name="y" '
                   'status="run"/><testcase name="z" status="run"><skipped/></testcase></testsuite></testsuites>')
        self.assertEqual(self.count("--ctest", results, self.folder + "/g"), (0, "3 passed, 0 failed, 1 skipped"))

    def test_a_crash_and_a_failed_case_are_failures(self):
        results = self.ctest(a_test="failed", b_test="failed", c_test="failed", d_test="notrun")
        self.write("g/a_test.xml", '<testsuites><testcase name="x" status="run"/><testcase name="y"><failure/></testcase>'
                   '</testsuites>')
        self.write("g/b_test.xml", '<testsuites><testcase name="x" status="run"/></testsuites>')
        self.assertEqual(self.count("--ctest", results, self.folder + "/g"), (1, "2 passed, 4 failed"))

    def test_nothing_run_is_no_success(self):
        results = self.ctest()
        self.assertEqual(self.count("--ctest", results, self.folder), (1, "0 passed, 0 failed"))

    def test_a_rostest_is_counted_by_its_programs_cases(self):
        self.write("results/pkg/rostest-a.xml", '<testsuites><testcase name="program"/></testsuites>')
        self.write("results/pkg/rosunit-program.xml", '<testsuites><testcase name="x"/><testcase name="y"/></testsuites>')
        self.write("results/other/gtest-b.xml", '<testsuites><testcase name="z"/></testsuites>')
        self.assertEqual(self.count("--catkin", self.folder + "/results"), (0, "3 passed, 0 failed"))

    def test_a_failed_case_of_a_rostest_is_one_failure(self):
        self.write("results/pkg/rostest-a.xml", '<testsuites><testcase name="program"><failure/></testcase></testsuites>')
        self.write("results/pkg/rosunit-program.xml", '<testsuites><testcase name="x"/><testcase name="y"><failure/>'
                   '</testcase></testsuites>')
        self.assertEqual(self.count("--catkin", self.folder + "/results"), (1, "1 passed, 1 failed"))

    def test_what_failed_is_named_with_what_it_said(self):
        results = self.ctest(a_test="failed")
        self.write("g/a_test.xml", '<testsuites><testcase classname="A" name="b" status="run">'
                   '<failure message="a.cpp:3&#x0A;1 is not 2"/></testcase></testsuites>')
        self.write("results/pkg/rosunit-p.xml", '<testsuites><testcase name="q"><error>gone</error></testcase></testsuites>')
        self.count("--ctest", results, self.folder + "/g", "--catkin", self.folder + "/results")
        for said in ("  failed: a_test.xml: A b", "  failed:     a.cpp:3", "  failed:     1 is not 2", "rosunit-p.xml:  q",
                     "  failed:     gone"):
            self.assertIn(said, self.printed)

    def test_a_rostest_that_crashed_is_a_failure(self):
        self.write("results/pkg/rostest-a.xml", '<testsuites><testcase name="program"><failure/></testcase></testsuites>')
        self.assertEqual(self.count("--catkin", self.folder + "/results")[0], 1)

    def test_a_file_with_the_colours_of_a_terminal_is_read(self):
        self.write("results/pkg/rosunit-p.xml", '<testsuites><testcase name="x"/><testcase name="y"><failure>\x1b[31mred'
                   '</failure></testcase></testsuites>')
        self.assertEqual(self.count("--catkin", self.folder + "/results"), (1, "1 passed, 1 failed"))

    def test_a_file_that_cannot_be_read_is_a_failure(self):
        self.write("results/pkg/rosunit-p.xml", "<testsuites>")
        self.write("results/pkg/rosunit-q.xml", '<testsuites><testcase name="x"/></testsuites>')
        self.assertEqual(self.count("--catkin", self.folder + "/results"), (1, "1 passed, 1 failed"))
        self.assertIn("  failed: rosunit-p.xml", self.printed)

    def test_a_single_check_counts_by_its_status(self):
        good, bad = self.write("good", "0\n"), self.write("bad", "1\n")
        self.assertEqual(self.count("--check", "a", good), (0, "1 passed, 0 failed"))
        self.assertEqual(self.count("--check", "a", good, "--check", "b", bad), (1, "1 passed, 1 failed"))


class Table(unittest.TestCase):
    def show(self, rows):
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump(rows, file)
            file.flush()
            return subprocess.run([sys.executable, os.path.join(SCRIPTS, "show_table.py"), file.name], capture_output=True,
                                  text=True)

    def test_rows_are_shown_with_their_peer(self):
        shown = self.show([{"name": "solve", "value": 1.5, "unit": "s", "peer": "other", "peer_value": 3}])
        self.assertEqual(shown.returncode, 0)
        self.assertIn("1.5 s   other: 3", shown.stdout)

    def test_bad_rows_are_refused(self):
        for rows in ([], {}, [{"name": "a", "value": "1", "unit": "s"}], [{"name": "", "value": 1, "unit": "s"}],
                     [{"name": "a", "value": 1}], [{"name": "a", "value": 1, "unit": "s", "peer": "b"}]):
            self.assertNotEqual(self.show(rows).returncode, 0, rows)


class Workspace(unittest.TestCase):
    def test_catkin_ws_holds_relative_links_to_packages_only(self):
        source = os.path.join(ROOT, "catkin_ws", "src")
        names = {name for name in os.listdir(source) if name != "CMakeLists.txt"}  # that one is catkin_make's
        self.assertGreaterEqual(names, {"region_maps", "online_controller", "offline_mpt", "fixedwing_lateral", "calibration",
                                        "polyfly_launch", "polyfly_test", "mav_msgs"})
        for name in names:
            link = os.path.join(source, name)
            self.assertTrue(os.path.islink(link), name)
            self.assertTrue(os.readlink(link).startswith("../../"), name)
            package = xml.parse(os.path.join(link, "package.xml")).getroot()
            self.assertEqual(package.findtext("name"), name)
            self.assertEqual(package.findtext("license"), "BSD-3-Clause")

    def test_a_clone_in_a_workspace_holds_each_package_once(self):
        try:
            from catkin_pkg.packages import find_package_paths
        except ImportError:
            self.skipTest("catkin_pkg is not installed")
        with tempfile.TemporaryDirectory() as folder:
            clone = os.path.join(folder, "polyfly")
            shutil.copytree(ROOT, clone, symlinks=True, ignore=lambda path, names: {"build", ".git"} & set(names))
            found = [os.path.basename(path) for path in find_package_paths(folder)]
        linked = set(os.listdir(os.path.join(ROOT, "catkin_ws", "src"))) - {"CMakeLists.txt"}
        names = {"launch": "polyfly_launch", "test": "polyfly_test"}
        self.assertEqual(sorted(linked), sorted(names.get(name, name) for name in found))


class Version(unittest.TestCase):
    """What repeats the version of the project, the versions of files, and who publishes them."""

    @staticmethod
    def text(*parts):
        with open(os.path.join(ROOT, *parts)) as file:
            return file.read()

    def find(self, pattern, *parts):
        found = re.search(pattern, self.text(*parts), re.MULTILINE)
        self.assertTrue(found, f"{pattern} in {parts}")
        return found.group(1)

    def setUp(self):
        self.version = self.find(r'kVersion\[\] = "([0-9.]+)"', "catkin_ws", "src", "polyfly_base", "include", "polyfly_base",
                                 "version.hpp")

    def test_manifests_have_the_version_of_the_project(self):
        packages = set(os.listdir(os.path.join(ROOT, "catkin_ws", "src"))) - {"CMakeLists.txt"}
        for name in packages - {"mav_msgs", "mavros_msgs"}:  # these have the version of what they restate
            package = xml.parse(os.path.join(ROOT, "catkin_ws", "src", name, "package.xml")).getroot()
            self.assertEqual(package.findtext("version"), self.version, name)

    def test_packages_citation_and_changes_have_it_too(self):
        self.assertEqual(self.version, self.find(r"^polyfly \(([0-9.]+)\)", "debian", "changelog"))
        self.assertEqual(self.version, self.find(r"^version: (.*)$", "CITATION.cff"))
        self.assertEqual(self.version, self.find(r"^## (.*)$", "CHANGELOG.md"))
        minor = self.version.rpartition(".")[0]
        self.assertEqual(minor, self.find(r"find_package\(polyfly ([0-9.]+)", "test", "examples", "CMakeLists.txt"))
        self.assertEqual(minor, self.find(r"^\| file \| ([0-9.]+) writes", "README.md"))

    def test_the_table_of_files_has_the_versions_of_the_code(self):
        source = os.path.join("catkin_ws", "src")
        format_file = os.path.join(source, "region_maps", "include", "region_maps", "format.hpp")
        versions = {"region map": self.find(r" kVersion = (\d+);", format_file)}
        for name, title, path in (("a map", "certificate", "core/certificate.hpp"), ("a reduction", "reduction certificate", "reduction.cpp"),
                                  ("a robust map", "robust certificate", "robust/robust_certificate.hpp")):
            versions["certificate of " + name] = self.find(rf'"polyfly {title} (\d+)"', source, "offline_mpt", "checker", path)
        for name, written in versions.items():
            self.assertEqual(written, self.find(rf"^\| {name} \| (\d+) \|", "README.md"), name)
        first = self.find(r" kFirstVersion = (\d+);", format_file)
        self.assertEqual(f"{first}, {versions['region map']}", self.find(r"^\| region map \| \d+ \| (.*) \|$", "README.md"))


class Packages(TreeCase):
    """The parts of ./run package that need no build."""

    def copy_with(self, maintainer):
        shutil.copytree(os.path.join(ROOT, "debian"), self.path("debian"), dirs_exist_ok=True)
        with open(self.path("debian", "maintainer"), "a") as file:
            file.write(maintainer)
        os.makedirs(self.path("launch"), exist_ok=True)
        os.makedirs(self.path("catkin_ws", "src"), exist_ok=True)
        shutil.copy(os.path.join(ROOT, "catkin_ws", "src", "polyfly_launch", "package.xml"), self.path("launch"))
        os.symlink("../../launch", self.path("catkin_ws", "src", "polyfly_launch"))
        script = "root=$PWD; . catkin_ws/scripts/common.sh; . catkin_ws/scripts/package.sh; copySources; maintainer"
        printed = subprocess.run(["bash", "-euc", script], cwd=self.tree, check=True, capture_output=True, text=True).stdout
        texts = []
        for name in ("debian/control", "debian/changelog", "launch/package.xml"):
            with open(self.path("build", "packages", "source", name)) as file:
                texts.append(file.read())
        return printed, texts

    def test_without_a_publisher_the_placeholder_stays(self):
        printed, texts = self.copy_with("")
        self.assertEqual("", printed)
        for text in texts:
            self.assertIn("polyfly@example.org", text)

    def test_the_publisher_is_written_once(self):
        printed, texts = self.copy_with("A. Publisher/Co <a@b.example>\n")
        self.assertEqual("A. Publisher/Co <a@b.example>\n", printed)
        for text in texts:
            self.assertNotIn("polyfly@example.org", text)
            self.assertIn("A. Publisher/Co", text)
            self.assertIn("a@b.example", text)


    def test_without_root_or_debootstrap_no_clean_root_is_tried(self):
        for user, reason in (("1000", "that needs root"), ("0", "there is no debootstrap")):
            result = subprocess.run([os.path.join(ROOT, "test", "package_test.sh"), self.tree], capture_output=True, text=True,
                                    env={"PATH": "/usr/bin:/bin", "BASH_FUNC_id%%": f"() {{ echo {user}; }}"})
            self.assertEqual(0, result.returncode, result.stderr)
            self.assertEqual(f"skipped: the packages were not tried in a clean root: {reason}\n", result.stdout)


class Completion(unittest.TestCase):
    def complete(self, *words):
        tool = """tool() { case "$*" in --help) printf 'A tool.\\n\\nOptions:\\n  -h,--help  Help\\n\\nSubcommands:\\n  solve  S\\n  set  T\\n';;
          "solve --help") printf 'Solve.\\n\\nOptions:\\n  -h,--help  Help\\n  -o,--output TEXT  File\\n  --time-limit N  As --output-not\\n';; esac; }"""
        words = " ".join(f"'{word}'" for word in words)
        script = f'{tool}\n. debian/complete.bash; COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _polyfly; echo "${{COMPREPLY[*]}}"'
        return subprocess.run(["bash", "-uc", script], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split()

    def test_subcommands_and_their_options(self):
        self.assertEqual(["solve", "set"], self.complete("tool", ""))
        self.assertEqual(["solve"], self.complete("tool", "so"))
        self.assertEqual(["--help", "--output", "--time-limit"], self.complete("tool", "solve", "file", "--"))
        self.assertEqual([], self.complete("tool", "solve", "file"))


class Tidy(TreeCase):
    """tidy.py with a clang-tidy that notes what it is asked, and complains of a file that says so."""

    def setUp(self):
        super().setUp()
        self.write("bin/clang-tidy", "#!/bin/bash\n[ \"$1\" = --version ] && exec echo 14\n"
                   "echo \"${@: -1}\" >> \"$ASKED\"\n! grep complain \"${@: -1}\"\n")
        os.chmod(self.path("bin", "clang-tidy"), 0o755)
        self.write(".clang-tidy", "Checks: all\n")
        self.write("include/one.hpp", '#include "two.hpp"\n')
        self.write("include/two.hpp", "")
        self.write("with.cpp", '#include <vector>\n#include "one.hpp"\n')
        self.write("without.cpp", "")
        commands = [{"directory": self.tree, "file": self.path(name), "command": f"c++ -I{self.path('include')} -c {name}"}
                    for name in ("with.cpp", "without.cpp", "with.cpp")]
        self.write("build/compile_commands.json", json.dumps(commands))

    def write(self, name, text):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w") as file:
            file.write(text)

    def look(self, *paths):
        """The status, and the files that were looked at."""
        asked = self.path("asked")
        open(asked, "w").close()
        environment = {"PATH": self.path("bin") + ":/usr/bin:/bin", "ASKED": asked}
        result = subprocess.run(["/usr/bin/python3", self.path("catkin_ws", "scripts", "tidy.py"), self.path("build"),
                                 self.path("notes"), *map(self.path, paths)], env=environment, capture_output=True, text=True)
        with open(asked) as file:
            return result.returncode, sorted(os.path.basename(line.strip()) for line in file)

    def test_a_clean_file_is_looked_at_once(self):
        self.assertEqual(self.look(), (0, ["with.cpp", "without.cpp"]))
        self.assertEqual(self.look(), (0, []))
        self.write("include/two.hpp", "// changed\n")
        self.assertEqual(self.look(), (0, ["with.cpp"]))
        self.write(".clang-tidy", "Checks: more\n")
        self.assertEqual(self.look("without.cpp"), (0, ["without.cpp"]))
        self.assertEqual(self.look(), (0, ["with.cpp"]))

    def test_a_finding_fails_until_it_is_mended(self):
        self.write("without.cpp", "// complain\n")
        self.assertEqual(self.look(), (1, ["with.cpp", "without.cpp"]))
        self.assertEqual(self.look(), (1, ["without.cpp"]))
        self.write("without.cpp", "// mended\n")
        self.assertEqual(self.look(), (0, ["without.cpp"]))


class Pages(unittest.TestCase):
    ENDINGS = ("md", "cpp", "hpp", "py", "sh", "launch", "cmake", "msg", "srv", "cfg", "test", "rviz", "svg")

    def test_files_that_the_pages_name_exist(self):
        files = set()
        for folder, below, names in os.walk(ROOT):
            below[:] = [name for name in below if name not in ("build", "devel", "install", "logs", ".git")]
            files.update(os.path.relpath(os.path.join(folder, name), ROOT) for name in names)
        checked = 0
        for page in sorted(name for name in files if name.endswith(".md")):
            with open(os.path.join(ROOT, page)) as file:
                text = file.read()
            for link in re.findall(r"\]\(([^)#:\s]+)\)", text):
                self.assertTrue(os.path.exists(os.path.join(ROOT, os.path.dirname(page), link)), f"{page}: {link}")
            for name in re.findall(r"`([\w./-]+\.(?:%s))`" % "|".join(self.ENDINGS), text):
                if "NAME" in name:
                    continue
                end = os.path.normpath(name).lstrip("./")
                self.assertTrue(any(("/" + file).endswith("/" + end) for file in files), f"{page}: there is no {name}")
                checked += 1
        self.assertGreater(checked, 100)


class Recorder(unittest.TextTestResult):
    """Remembers the cases for the result file."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.cases = []

    def stopTest(self, test):
        super().stopTest(test)
        self.cases.append(test)


def write_results(result, target):
    bad = {str(test) for test, _ in result.failures + result.errors}
    suites = xml.Element("testsuites")
    for test in result.cases:
        case = xml.SubElement(suites, "testcase", name=str(test), status="run")
        if str(test) in bad:
            xml.SubElement(case, "failure")
    xml.ElementTree(suites).write(target)


def main(name):
    """Runs the cases of the program; also leaves them in a result file where one is asked for."""
    suite = unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])
    outcome = unittest.TextTestRunner(resultclass=Recorder).run(suite)
    place = os.environ.get("GTEST_OUTPUT", "")
    if place.startswith("xml:"):
        write_results(outcome, os.path.join(place[4:], name + ".xml"))
    sys.exit(0 if outcome.wasSuccessful() else 1)


if __name__ == "__main__":
    main("run_test")
