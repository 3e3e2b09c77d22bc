#!/usr/bin/env python3
"""Checks that tools/skipped-tests counts each skipped test and names its reason.

It also checks that each script whose single tests can skip prints their reasons (verbosity=2), which the tool reads.

Usage: skipped_tests_test.py SOURCE_DIR
"""
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

SCRIPT = """
import unittest

class Some(unittest.TestCase):
    def test_that_passes(self):
        print("skipped: only the output of a program", flush=True)

    @unittest.skip("needs root (mount)")
    def test_by_decorator(self):
        self.fail()

    def test_while_it_runs(self):
        self.skipTest("the file system's times are off")

@unittest.skip("no GPU")
class Whole(unittest.TestCase):
    def test_of_a_class(self):
        self.fail()

unittest.main(verbosity={verbosity})
"""
GOOGLE_TEST = """[ RUN      ] Device.Works
device_test.cpp:12: Skipped
there is no CUDA device

[  SKIPPED ] Device.Works (0 ms)
"""


def output_of_script(verbosity):
    result = subprocess.run([sys.executable, "-c", SCRIPT.format(verbosity=verbosity)], stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, check=True)
    return result.stdout


class SkippedTests(unittest.TestCase):
    def report(self, *cases):
        """Returns the lines that the tool prints. cases: name, status and output of tests, as ctest records them."""
        suite = xml.etree.ElementTree.Element("testsuite")
        for name, status, output in cases:
            case = xml.etree.ElementTree.SubElement(suite, "testcase", name=name, status=status)
            if status == "notrun":
                xml.etree.ElementTree.SubElement(case, "skipped", message="SKIP_RETURN_CODE=77")
            xml.etree.ElementTree.SubElement(case, "system-out").text = output
        with tempfile.TemporaryDirectory() as folder:
            results = Path(folder) / "tests.xml"
            xml.etree.ElementTree.ElementTree(suite).write(results)
            return subprocess.run([sys.executable, SOURCE / "tools/skipped-tests", results], capture_output=True,
                                  text=True, check=True).stdout.splitlines()

    def test_each_skipped_test_is_counted_with_its_reason(self):
        lines = self.report(("cli.some_test", "run", output_of_script(2)),
                            ("cli.whole_test", "notrun", "skipped: python3-h5py is not installed\n"),
                            ("devices.Device.Works", "notrun", GOOGLE_TEST),
                            ("cli.silent_test", "notrun", ""),
                            ("core.passes", "run", "[       OK ] Core.Passes (0 ms)\n"))
        self.assertEqual(lines, ["6 skipped of 5 tests:",
                                 "  cli.silent_test: no reason was printed",
                                 "  cli.some_test: test_by_decorator: needs root (mount)",
                                 "  cli.some_test: test_of_a_class: no GPU",
                                 "  cli.some_test: test_while_it_runs: the file system's times are off",
                                 "  cli.whole_test: python3-h5py is not installed",
                                 "  devices.Device.Works: there is no CUDA device"])

    def test_a_script_that_prints_no_reasons_still_has_its_number(self):
        self.assertEqual(self.report(("cli.some_test", "run", output_of_script(1))),
                         ["1 skipped of 1 tests:", "  cli.some_test: 3 of its tests: run the script for the reason"])

    def test_without_a_skipped_test_one_line_is_printed(self):
        self.assertEqual(self.report(("core.passes", "run", "")), ["0 skipped of 1 tests."])

    def test_scripts_whose_tests_can_skip_print_the_reasons(self):
        scripts = {path: path.read_text(encoding="utf-8") for path in (SOURCE / "tests").rglob("*_test.py")}
        can_skip = [path for path, text in scripts.items() if "self.skipTest(" in text or "@unittest.skip" in text]
        self.assertGreater(len(can_skip), 10)
        self.assertEqual([str(path) for path in can_skip if "verbosity=2" not in scripts[path]], [])


if __name__ == "__main__":
    SOURCE = Path(sys.argv[1]).resolve()
    unittest.main(argv=sys.argv[:1], verbosity=2)
