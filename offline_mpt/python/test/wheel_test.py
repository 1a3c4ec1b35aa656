"""The wheel that `pip install .` makes: its record, and the module in it."""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import zipfile
from importlib import metadata

import polyfly as pf
import run_test
from oracles import ROOT

sys.path.insert(0, str(pathlib.Path(ROOT) / "offline_mpt" / "python"))
import build_wheel  # noqa: E402  (pip imports it from there, too)


class Wheel(unittest.TestCase):
    def test_a_wheel_holds_the_module_and_tells_its_version(self):
        with tempfile.TemporaryDirectory() as folder:
            name = build_wheel.write_wheel(pathlib.Path(pf.__file__).parents[2], folder)
            with zipfile.ZipFile(os.path.join(folder, name)) as wheel:
                wheel.extractall(folder)
                names = set(wheel.namelist())
            (about,) = metadata.distributions(path=[folder])
            self.assertEqual(("polyfly", pf.__version__), (about.metadata["Name"], about.version))
            rows = {row[0]: row[1:] for row in csv.reader(about.read_text("RECORD").split("\n")) if row}
            self.assertEqual(names, set(rows))
            for path, (digest, size) in rows.items():
                data = pathlib.Path(folder, path).read_bytes()
                if not path.endswith("RECORD"):
                    self.assertEqual((build_wheel.digest(data), str(len(data))), (digest, size), path)
            code = "import polyfly; print(polyfly.__file__, polyfly.__version__)"
            printed = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True,
                                     env={**os.environ, "PYTHONPATH": folder}).stdout
            self.assertEqual([os.path.join(folder, "polyfly", "__init__.py"), pf.__version__], printed.split())


if __name__ == "__main__":
    run_test.main("python_wheel_test")
