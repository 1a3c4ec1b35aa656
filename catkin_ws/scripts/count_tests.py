#!/usr/bin/env python3
"""Counts test cases out of result files and prints `N passed, N failed` (and `, N skipped` where any).

usage: count_tests.py [--ctest TEST_XML GTEST_FOLDER]... [--catkin FOLDER] [--check NAME FILE]...

A ctest program that wrote a GoogleTest file counts with its cases, any other as one case; a program that
failed without a failed case (it crashed, or a sanitizer stopped it) counts as one failure more. What failed
is named before, with the begin of what it said, in lines that begin with "  failed:". Exit
status 1 when something failed or nothing ran. FILE of a check holds the exit status of one script.
"""
import os
import re
import sys
import xml.etree.ElementTree as xml


SAID = 1200  # characters of what a failed case said
NOT_IN_XML = re.compile(rb"[\x00-\x08\x0b\x0c\x0e-\x1f]")


class Count:
    def __init__(self):
        self.passed = self.failed = self.skipped = 0

    def add(self, other):
        self.passed += other.passed
        self.failed += other.failed
        self.skipped += other.skipped

    def text(self):
        end = f", {self.skipped} skipped" if self.skipped else ""
        return f"{self.passed} passed, {self.failed} failed{end}"


def tell(where, case, complaint):
    """Names a failed case. What it said is in an attribute (GoogleTest), in the element or beside it (a rostest)."""
    said = complaint.get("message") or complaint.text or case.findtext("system-out") or ""
    print(f"  failed: {where}: {case.get('classname') or ''} {case.get('name')}")
    for line in said.strip()[:SAID].splitlines():
        print(f"  failed:     {line.rstrip()}")


def root_of(path):
    """The root of a result file. rostest writes what a program printed as it is, also the colours of a terminal."""
    with open(path, "rb") as file:
        return xml.fromstring(NOT_IN_XML.sub(b"", file.read()))


def count_cases(path):
    """Cases of one GoogleTest or JUnit file. A file that cannot be read is one case that failed."""
    count = Count()
    try:
        root = root_of(path)
    except xml.ParseError as error:
        print(f"  failed: {os.path.basename(path)}: {error}")
        count.failed = 1
        return count
    for case in root.iter("testcase"):
        complaint = next((found for found in (case.find("failure"), case.find("error")) if found is not None), None)
        if complaint is not None:
            count.failed += 1
            tell(os.path.basename(path), case, complaint)
        elif case.find("skipped") is not None or case.get("status") == "notrun":
            count.skipped += 1
        else:
            count.passed += 1
    return count


def count_ctest(test_xml, gtest_folder):
    """TEST_XML is what `ctest -T Test` leaves; CMake writes JUnit files only since 3.21."""
    total = Count()
    for test in root_of(test_xml).findall("Testing/Test"):
        name, status = test.findtext("Name"), test.get("Status")
        own = os.path.join(gtest_folder, name + ".xml")
        count = Count()
        if os.path.exists(own):
            count = count_cases(own)
            if status == "failed" and not count.failed:
                count.failed = 1
        elif status == "passed":
            count.passed = 1
        elif test.findtext("Results/NamedMeasurement[@name='Completion Status']/Value") == "Disabled":
            count.skipped = 1
        else:
            count.failed = 1
        if count.failed:
            print(f"  failed: {name}: {count.text()}")
        total.add(count)
    return total


def count_catkin(folder):
    """rostest leaves one file for each launch file (rostest-*), whose cases are its programs, and one with the
    cases of each of these programs (rosunit-*). The latter are counted, and of the former what failed without a
    case that failed: a program that crashed, or left no file."""
    total = Count()
    for where, _, names in sorted(os.walk(folder)):
        found = {}
        for name in sorted(names):
            if name.endswith(".xml"):
                found[name] = count_cases(os.path.join(where, name))
        programs = [count for name, count in found.items() if not name.startswith("rostest-")]
        for count in programs:
            total.add(count)
        failed = sum(count.failed for name, count in found.items() if name.startswith("rostest-"))
        if failed and not any(count.failed for count in programs):
            total.failed += failed
        if found and not programs:
            total.failed += 1
    return total


def main(arguments):
    total = Count()
    while arguments:
        kind = arguments.pop(0)
        if kind == "--ctest":
            results, folder = arguments.pop(0), arguments.pop(0)
            count, label = count_ctest(results, folder), os.path.basename(os.path.dirname(results))
        elif kind == "--catkin":
            count, label = count_catkin(arguments.pop(0)), "rostest"
        elif kind == "--check":
            label, path = arguments.pop(0), arguments.pop(0)
            count = Count()
            with open(path) as file:
                if file.read().strip() == "0":
                    count.passed = 1
                else:
                    count.failed = 1
                    print(f"  failed: {label}")
        else:
            sys.exit(__doc__)
        print(f"{label + ':':9} {count.text()}")
        total.add(count)
    print(total.text())
    return 1 if total.failed or not total.passed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
