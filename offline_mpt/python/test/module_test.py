"""The module as a whole: names, types, help texts, interruption."""
import _thread
import ast
import inspect
import pathlib
import subprocess
import sys
import threading
import unittest

import numpy as np
import polyfly as pf
import run_test
from oracles import LATERAL, ROOT
from polyfly import _polyfly, statement

PACKAGE = pathlib.Path(pf.__file__).parent
# More than any machine does while it is waited for.
ENDLESS = 10**12


def declared(path):
    """{name: members} of a stub; a function has None."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    found = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            found[node.name] = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            found[node.name] = None
    return found


def members(kind):
    shown = {"__init__", "__call__", "__len__", "__getitem__", "__bool__", "_repr_svg_"}
    return {name for name, value in vars(kind).items() if name in shown or not name.startswith("_")}


class Names(unittest.TestCase):
    def test_stub_and_module_agree(self):
        stub = declared(PACKAGE / "_polyfly.pyi")
        self.assertEqual({name for name in vars(_polyfly) if not name.startswith("_")}, set(stub))
        for name, listed in stub.items():
            if listed is not None and not issubclass(getattr(_polyfly, name), Exception):
                self.assertEqual(members(getattr(_polyfly, name)) - {"__init__"}, listed, name)

    def test_the_stub_tells_types(self):
        stub = (PACKAGE / "_polyfly.pyi").read_text(encoding="utf-8")
        for line in ("def evaluate(self, thetas: ArrayLike, threads: int = 1) -> NDArray[Any]: ...",
                     "progress: Any = None) -> Union[CertifyReport, RobustProof]: ...", "def load_problem(path: Union[str, os.PathLike[str]]) -> Problem"):
            self.assertIn(line, stub)

    def test_functions_of_the_python_files_tell_types(self):
        for kind in (pf.Law, pf.Layer, pf.MPC, pf.RobustLaw, pf.RobustMPC, statement.Statement):
            for name in members(kind):
                annotated = inspect.getfullargspec(vars(kind)[name])
                self.assertLessEqual({*annotated.args[1:], *annotated.kwonlyargs, "return"}, set(annotated.annotations), name)

    def test_all_is_there(self):
        for name in pf.__all__:
            self.assertTrue(hasattr(pf, name), name)

    def test_help_texts_name_types_of_python(self):
        for name, kind in vars(_polyfly).items():
            if isinstance(kind, type) and not name.startswith("_"):
                for member, value in vars(kind).items():
                    self.assertNotIn("::", getattr(value, "__doc__", None) or "", f"{name}.{member}")

    def test_errors_are_value_errors(self):
        self.assertTrue(issubclass(pf.Error, ValueError))
        self.assertTrue(issubclass(pf.OutsideError, pf.Error))

    def test_import_needs_numpy_alone(self):
        code = "import sys, json, pathlib, typing, numpy; before = set(sys.modules); import polyfly; print(sorted(set(sys.modules) - before))"
        printed = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
        self.assertEqual(["polyfly", "polyfly._polyfly", "polyfly.disturbance", "polyfly.law", "polyfly.layer", "polyfly.mat",
                          "polyfly.mpc", "polyfly.program", "polyfly.robust", "polyfly.statement"], ast.literal_eval(printed))


class Interruption(unittest.TestCase):
    def test_an_exception_of_progress_ends_the_work(self):
        class Enough(Exception):
            pass

        seen = []

        def stop(text):
            seen.append(text)
            raise Enough

        law = pf.load(LATERAL).solve()
        with self.assertRaises(Enough):
            law.verify(samples=ENDLESS, progress=stop)
        self.assertRegex(seen[0], f"[0-9]+ of {ENDLESS} samples")
        self.assertEqual(1, len(seen))

    def test_solve_checks_its_answers(self):
        seen = []
        size = 100
        rows = np.vstack([np.eye(size), -np.eye(size)])
        hessian = np.eye(size) + 0.9 * np.ones((size, size)) / size
        pf.MPQP(hessian, np.zeros(size), np.linspace(1, 3, size)[:, None], rows, np.ones(2 * size),
                np.zeros((2 * size, 1)), [-1], [1]).solve(threads=1, progress=seen.append)
        self.assertTrue(any(text.startswith("check: ") for text in seen), seen)

    def test_ctrl_c_ends_the_work(self):
        law = pf.load(LATERAL).solve()
        with self.assertRaises(KeyboardInterrupt):
            threading.Thread(target=_thread.interrupt_main).start()
            law.verify(samples=ENDLESS)

    def test_ctrl_c_ends_an_exploration(self):
        text = LATERAL.read_text(encoding="utf-8").replace("horizon: 20", "horizon: 80")
        problem = pf.parse_problem(text.replace("[-0.2, 0.2]", "[-0.6, 0.6]"), "large")
        with self.assertRaises(KeyboardInterrupt):
            threading.Thread(target=_thread.interrupt_main).start()
            problem.solve()

    def test_a_limit_keeps_what_was_found(self):
        law = pf.load(LATERAL).solve(region_limit=50)
        self.assertEqual(("limited", 50), (law.status, len(law.regions)))


class Threads(unittest.TestCase):
    def test_the_map_does_not_depend_on_threads(self):
        problem = pf.load(ROOT / "region_maps/problems/multirotor_vertical.yaml")
        self.assertEqual(problem.solve(threads=1).checksum, problem.solve(threads=2).checksum)

    def test_several_threads_look_up_at_once(self):
        law = pf.load(LATERAL).solve()
        answers = []
        theta = [0.5, -0.2, 0.0, 0.0, 0.0]
        workers = [threading.Thread(target=lambda: answers.append(law(theta)[0])) for _ in range(4)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertEqual(1, len(set(answers)))


if __name__ == "__main__":
    run_test.main("python_module_test")
