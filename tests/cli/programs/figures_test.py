#!/usr/bin/env python3
"""Runs the commands of each table of measured values with a small scene, and reads their output.

Usage: figures_test.py GIGABAKE SOURCE_DIR
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

TABLE = {"title": "a table", "prepare": ["gigabake_fractal f.glb --quads 2"], "columns": [{"name": "triangles"}],
         "commands": ["gigabake bake f.glb --local --voxel-size $voxel_m -o SCENE --json"],
         "runs": {"one-gpu": [{"voxel_m": 0.25}]}, "quick": [{"voxel_m": 0.25}], "measured": {}}
FAULTS = {"no `tringles`": {"columns": [{"name": "triangles", "from": ["tringles"]}]},
          "exit status": {"commands": ["gigabake bake f.glb --no-such-option"]},
          "no value of 'cell'": {"commands": ["gigabake bake f.glb --cell-voxels $cell"]},
          "expected a command of gigabake": {"commands": ["echo {}"]}}


class Figures(harness.FolderTest):
    def figures(self, source, *arguments):
        command = [sys.executable, source / "tools/figures", *arguments, "--program", GIGABAKE]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def test_every_command_runs_and_every_column_is_found(self):
        result = self.figures(SOURCE, "--quick")
        if "without Embree" in result.stdout:
            self.skipTest("benchmarks were built without Embree")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertNotIn(" 0 rows", result.stdout.replace("hard-cases: 0 rows", "").replace("surfaces: 0 rows", ""),
                         "tests/cli/programs/hard_test.py reads the output for these two")

    def copy_with(self, **changes):
        """Returns a copy of the program with one table."""
        copy = Path(tempfile.mkdtemp(dir=self.root))
        (copy / "docs/data/performance").mkdir(parents=True)
        subprocess.run(["cp", "-r", SOURCE / "tools", copy], check=True)
        table = {**TABLE, "columns": [{"name": "triangles", "from": ["triangles"]}], **changes}
        (copy / "docs/data/performance/one.json").write_text(json.dumps(table))
        return copy

    def test_faults_of_a_table_are_reported(self):
        for expected, changes in FAULTS.items():
            with self.subTest(expected):
                result = self.figures(self.copy_with(**changes), "--quick")
                self.assertEqual(result.returncode, 1, result.stdout)
                self.assertIn(expected, result.stdout)

    def test_a_later_run_replaces_the_rows_of_its_tables(self):
        sys.path.insert(0, str(SOURCE / "tools"))
        from figures_lib import data
        run = dict.fromkeys(data.RUN_KEYS)
        before = {"machine": "m", "runs": [{**run, "commit": "a", "tables": {"one": [[1]], "two": [[2]]}}]}
        after = data.merged(before, {**run, "commit": "b", "tables": {"two": [[3]]}})
        self.assertEqual([(one["commit"], one["tables"]) for one in after["runs"]],
                         [("a", {"one": [[1]]}), ("b", {"two": [[3]]})])
        again = data.merged(after, {**run, "commit": "b", "tables": {"one": [[4]]}})
        self.assertEqual([(one["commit"], one["tables"]) for one in again["runs"]],
                         [("b", {"two": [[3]], "one": [[4]]})])

    def test_repeats_are_combined(self):
        sys.path.insert(0, str(SOURCE / "tools"))
        from figures_lib import data, values
        column = {"from": ["(time_s + 1) * 2"]}
        scopes = [{"time_s": time_s, "hash": "a"} for time_s in (3, 1, 7)]
        self.assertEqual(values.cell_of(column, scopes), 8)
        self.assertEqual(values.cell_of({**column, "spread": True}, scopes), [4, 16])
        self.assertEqual(values.cell_of({"from": ["hash"]}, scopes), "a")
        with self.assertRaisesRegex(data.Problem, "repeats differ"):
            values.cell_of({"from": ["hash"]}, [*scopes, {"hash": "b"}])

    def test_results_of_another_machine_are_stored(self):
        copy = self.copy_with()
        (copy / "README.md").write_text("<!-- data/performance/one.json -->\n<!-- end -->\n"
                                        "<!-- data/one-gpu.json -->\n<!-- end -->\n")
        result = self.figures(copy, "--measure", "--machine", "one-gpu", "--commit", "0123456789ab", "--output",
                              copy / "gpu.json")
        if "without changes of" in result.stdout:
            self.skipTest("a program with changes measures nothing")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        old = copy / "tests/architecture/old_tables.txt"
        old.parent.mkdir(parents=True)
        old.write_text("# names\none was another\nother\n")
        self.assertEqual(self.figures(copy, "--take", copy / "gpu.json").returncode, 0)
        self.assertEqual(old.read_text(), "# names\nother\n")
        self.assertIn("\n| triangles |\n| --- |\n| 8 |\n", (copy / "README.md").read_text())
        self.assertIn("cores", (copy / "README.md").read_text())
        self.assertEqual(self.figures(copy, "--check").returncode, 0)
        stored = copy / "docs/data/one-gpu.json"
        stored.write_text(stored.read_text().replace("[8]", "[9]"))
        self.assertIn("the table performance/one differs", self.figures(copy, "--check").stdout)


if __name__ == "__main__":
    GIGABAKE, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    harness.main(argv=sys.argv[:1], verbosity=2)
