#!/usr/bin/env python3
"""Runs every command and every line of Python in docs/python.md, with the package as pip installs it.

Usage: page_test.py GIGABAKE SOURCE_DIR
"""
import re
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli/support"))
from package_imports import environment

try:
    import matplotlib.image
    import numpy
except ImportError as error:
    print(f"skipped: {error} (python3-matplotlib)")
    sys.exit(77)

import harness

PYTHON = "/usr/bin/python3"
# The build runs without a network, with the distribution's setuptools.
PIP = f"{PYTHON} -m pip --disable-pip-version-check install --no-index --no-deps --no-build-isolation --no-compile"


def blocks():
    """Returns pairs (language, text) of the page's blocks, in order."""
    text = (SOURCE / "docs/python.md").read_text(encoding="utf-8")
    return re.findall(r"^```(\w*)\n(.*?)^```", text, re.M | re.S)


class Page(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        ignored = shutil.ignore_patterns("__pycache__", "build", "*.egg-info", ".mypy_cache")
        shutil.copytree(SOURCE / "python", cls.root / "python", ignore=ignored)
        programs = cls.root / "programs"
        programs.mkdir()
        (programs / "gigabake").symlink_to(Path(sys.argv[1]).resolve())
        (programs / "python3").symlink_to(PYTHON)
        pip = programs / "pip"
        pip.write_text(f'#!/bin/sh\n[ "$1" = install ] && shift\nexec {PIP} --target installed "$@"\n')
        pip.chmod(0o755)
        cls.environment = {**environment(sys.argv[1]), **harness.MPI_ENVIRONMENT,
                           "PYTHONPATH": str(cls.root / "installed")}
        del cls.environment["GIGABAKE"]
        cls.environment["PATH"] = f"{programs}:{cls.environment['PATH']}"
        cls.outputs, lines = [], []
        for language, text in blocks():
            if language == "python":
                lines.append(text)
            else:
                cls.outputs.append(cls.shell(text))
        (cls.root / "page.py").write_text("\n".join(lines), encoding="utf-8")
        cls.printed = cls.shell("python3 page.py")

    @classmethod
    def shell(cls, text):
        result = harness.run(["bash", "-euc", text], 600, cwd=cls.root, env=cls.environment)
        assert result.returncode == 0, f"{text}\n{result.stdout}\n{result.stderr}"
        return result.stdout

    def test_pip_installs_the_typed_package(self):
        installed = self.root / "installed"
        self.assertTrue((installed / "gigabake/py.typed").is_file())
        self.assertEqual(sorted(path.name for path in (installed / "gigabake").glob("*.py")),
                         sorted(path.name for path in (SOURCE / "python/gigabake").glob("*.py")))

    def test_the_levels_are_those_of_info(self):
        counts = [int(count.replace(",", "")) for count in re.findall(r"([\d,]+) voxels of", self.outputs[1])]
        info = harness.Gigabake(sys.argv[1]).info(self.root / "SCENE/scene.xml")
        self.assertEqual(counts, [level["voxels"] for level in info["lods"]])

    def test_the_lines_of_python_print_arrays_answers_and_the_error(self):
        self.assertIn("[[", self.printed)
        self.assertEqual(self.printed.count("hit ["), 2)
        self.assertIn("scene.xml  does not exist", self.printed)

    def test_the_example_draws_the_scene(self):
        pixels = matplotlib.image.imread(self.root / "section.png")
        self.assertGreater(len(numpy.unique(pixels.reshape(-1, pixels.shape[-1]), axis=0)), 200)
        low, high = map(float, re.search(r"heights from (\S+) to (\S+) m", self.outputs[2]).groups())
        self.assertTrue(-50 < low < high < 50, (low, high))


if __name__ == "__main__":
    SOURCE = Path(sys.argv[2]).resolve()
    harness.main(argv=sys.argv[:1], verbosity=2)
