#!/usr/bin/env python3
"""GLOSSARY.md agrees with the code: its paths exist, and no file or type is named by a word that it replaces."""

import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
GLOSSARY = (ROOT / "GLOSSARY.md").read_text(encoding="utf-8")
TYPE = re.compile(r"^\s*(?:class|struct|enum class|enum|using)\s+(\w+)", re.MULTILINE)
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


if __name__ == "__main__":
    unittest.main(verbosity=2)
