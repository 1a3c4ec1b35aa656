"""Every script of the gallery runs and is shown."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import run_test
from oracles import ROOT

GALLERY = ROOT / "offline_mpt/python/gallery"
HELPERS = {"make_gallery"}


class Gallery(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = pathlib.Path(cls.temporary.name)
        command = [sys.executable, "-B", GALLERY / "make_gallery.py", cls.folder]
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode != 0:
            raise AssertionError(run.stderr)
        cls.page = (cls.folder / "index.html").read_text(encoding="utf-8")
        cls.names = sorted({path.stem for path in GALLERY.glob("*.py")} - HELPERS)

    def test_each_script_is_shown_with_its_picture(self):
        self.assertEqual(7, len(self.names))
        for name in self.names:
            picture = (self.folder / f"{name}.svg").read_text(encoding="utf-8")
            self.assertIn("<svg", picture, name)
            self.assertTrue(picture.rstrip().endswith("</svg>"), name)
            self.assertIn(f'<img src="{name}.svg"', self.page)

    def test_scripts_are_short(self):
        for name in self.names:
            lines = (GALLERY / f"{name}.py").read_text(encoding="utf-8").splitlines()
            self.assertTrue(15 <= len(lines) <= 40, f"{name}: {len(lines)} lines")

    def test_what_the_scripts_print(self):
        for sentence in ("9 regions, 36 facets: proven", "turned to 90.0 degrees",
                         "every bound holds for each of them, now and later"):
            self.assertIn(sentence, self.page)

    def test_the_same_picture_again(self):
        for name in ("wind", "certificate"):
            again = self.folder / "again.svg"
            subprocess.run([sys.executable, "-B", GALLERY / f"{name}.py", again], check=True, capture_output=True)
            self.assertEqual((self.folder / f"{name}.svg").read_bytes(), again.read_bytes(), name)


if __name__ == "__main__":
    run_test.main("python_gallery_test")
