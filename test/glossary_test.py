#!/usr/bin/env python3
"""GLOSSARY.md agrees with the code: its paths exist, and no file or type is named by a word that it replaces.

The solver's tolerances stand in the headers of the layers alone, each with what it is measured in."""

import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
GLOSSARY = (ROOT / "GLOSSARY.md").read_text(encoding="utf-8")
TYPE = re.compile(r"^\s*(?:class|struct|enum class|enum|using)\s+(\w+)", re.MULTILINE)
SOLVER = ROOT / "offline_mpt"
TOLERANCE = re.compile(r"^(///.*)\nconstexpr double (\w+)(?:\[\])? =\s*[^;]+;", re.MULTILINE)
SMALL_NUMBER = re.compile(r"constexpr (?:double|float) (\w+)(?:\[\])? =[^;]*(?:\de-\d|0x[\d.]+p-)")
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


def replaced_words():
    """First column of the last table: words that another term replaces."""
    table = GLOSSARY.split("## Words that names do not use", 1)[1]
    return {word.strip() for row in re.findall(r"^\| (.+?) \|", table, re.MULTILINE)[1:] for word in row.split(",")}


def words_of(name):
    return {word.lower() for word in WORD.findall(name)}


def sources():
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.cpp", "*.hpp", "*.py"], cwd=ROOT, check=True,
                            capture_output=True, text=True).stdout.split()
    return [path for path in listed if (ROOT / path).is_file()]


def solver_sources(ending):
    """Files of the solver's libraries, relative to its folder."""
    path = re.compile(r"offline_mpt/((?:src|sets/src|robust/src|safety/src)/.+)")
    return [m.group(1) for m in map(path.fullmatch, sources()) if m and m.group(1).endswith(ending)]


class Glossary(unittest.TestCase):
    def test_paths_exist(self):
        paths = re.findall(r"`([\w./]+\.(?:hpp|cpp|md))`", GLOSSARY)
        self.assertGreater(len(paths), 50)
        self.assertEqual([], [path for path in paths if not (ROOT / path).is_file()])

    def test_names_use_the_terms(self):
        replaced = replaced_words()
        self.assertGreater(len(replaced), 10)
        wrong = []
        for path in sources():
            names = {pathlib.Path(path).stem} | set(TYPE.findall((ROOT / path).read_text(encoding="utf-8")))
            wrong += [f"{path}: {name}" for name in sorted(names) if words_of(name) & replaced]
        self.assertEqual([], wrong)

    def test_tolerances_state_their_measure(self):
        names, wrong = [], []
        for header in solver_sources("tolerances.hpp"):
            text = (SOLVER / header).read_text(encoding="utf-8")
            defined = TOLERANCE.findall(text)
            wrong += [f"{header}: {name}" for comment, name in defined if not comment.endswith("].")]
            self.assertEqual(text.count("constexpr"), len(defined), header)
            names += [name for _, name in defined]
        self.assertGreater(len(names), 50)
        self.assertEqual([], wrong)
        self.assertEqual([], [name for name in names if names.count(name) > 1])

    def test_tolerances_have_one_place(self):
        wrong = []
        for path in solver_sources(".cpp") + solver_sources(".hpp"):
            if path.endswith("tolerances.hpp"):
                continue
            wrong += [f"{path}: {name}" for name in SMALL_NUMBER.findall((SOLVER / path).read_text(encoding="utf-8"))]
        self.assertEqual([], wrong)


if __name__ == "__main__":
    unittest.main(verbosity=2)
