#!/usr/bin/env python3
"""Runs the unittest modules of this folder as one test of ctest, of which each case counts.

usage: run_tests.py NAME MODULE...

With GTEST_OUTPUT=xml:FOLDER/ the results go to FOLDER/NAME.xml in the form that GoogleTest writes.
"""
import os
import sys
import unittest
import xml.etree.ElementTree as xml


class Recorder(unittest.TextTestResult):
    """Keeps what became of each case."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.cases = []

    def startTest(self, test):
        super().startTest(test)
        module, name, case = test.id().rsplit(".", 2)
        self.cases.append(xml.Element("testcase", classname=f"{module}.{name}", name=case, status="run"))

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        xml.SubElement(self.cases[-1], "skipped", message=reason)

    def addFailure(self, test, err):
        super().addFailure(test, err)
        self._fail(self.failures[-1][1])

    def addError(self, test, err):
        super().addError(test, err)
        if not self.cases:  # The module cannot be imported, or its set-up failed.
            self.cases.append(xml.Element("testcase", classname="", name=str(test), status="run"))
        self._fail(self.errors[-1][1])

    def addSubTest(self, test, subtest, err):
        super().addSubTest(test, subtest, err)
        if err is not None:
            self._fail((self.failures + self.errors)[-1][1])

    def _fail(self, message):
        xml.SubElement(self.cases[-1], "failure", message=message)


def main(name, modules):
    sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
    suite = unittest.defaultTestLoader.loadTestsFromNames(modules)
    result = unittest.TextTestRunner(verbosity=2, resultclass=Recorder).run(suite)
    folder = os.environ.get("GTEST_OUTPUT", "")
    if folder.startswith("xml:"):
        root = xml.Element("testsuites", name=name)
        xml.SubElement(root, "testsuite", name=name).extend(result.cases)
        xml.ElementTree(root).write(os.path.join(folder[len("xml:"):], name + ".xml"), encoding="utf-8")
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
