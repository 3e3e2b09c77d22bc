#!/usr/bin/env python3
"""Tests file arguments: SCENE means SCENE/scene.xml, wrong formats are named, a suffix selects the export format.

Also tests --quiet, exit codes, and that only terminals get control characters. Regressions of 2026-11-22.

Usage: scene_argument_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import shutil
import sys
import unittest
import unittest.mock
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

TRIANGLE = ([[0, 0, 0], [4, 0, 0], [0, 1, -4]], [0, 1, 2])


class SceneArgument(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.source = cls.root / "hill.glb"
        harness.write_glb(cls.source, *TRIANGLE)
        cls.out = cls.root / "out"
        PROGRAM.bake(cls.source, cls.out, 0.25, "--cell-voxels", 8)
        cls.shards = sorted((cls.out / "shards").glob("*.h5"))

    def refused(self, code, told, *arguments):
        result = PROGRAM.run(*arguments)
        self.assertEqual(result.returncode, code, result)
        lines = result.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertLessEqual(len(lines[0]), 300)
        self.assertIn(told, lines[0])

    def commands_of_a_scene(self, scene):
        picture = ("-o", self.root / "picture.png", "--size", "16x16", "--backend", "cpu")
        return [("info", scene), ("verify", scene), ("diff", scene, self.out / "scene.xml"),
                ("export", scene, "-o", self.root / "v.ply"), ("render", scene, *picture)]

    # Regression of 2026-11-22: commands refused a folder but accepted its scene.xml.
    def test_a_folder_is_taken_for_its_scene(self):
        for given in (self.out, f"{self.out}/", self.out / "scene.xml"):
            for command in self.commands_of_a_scene(given):
                PROGRAM.succeed(*command)
            PROGRAM.succeed("status", given)
        self.assertEqual(PROGRAM.run("info", "out", cwd=self.root).returncode, 0)
        self.assertEqual(PROGRAM.run("status", "scene.xml", cwd=self.out).returncode, 0)
        PROGRAM.succeed("bench", "render", self.out, "--size", "16x16", "--repeats", 1, "--what", "first-hits",
                        "--backend", "cpu", "--reference-rays", 10)

    def test_what_is_no_scene_is_named_as_what_it_is(self):
        for given, told in ((self.source, "is not a scene but a source"), (self.shards[0], str(self.out / "scene.xml")),
                            (self.root, "is not a scene but a source"), (self.out / "shards", "has no scene.xml")):
            for command in self.commands_of_a_scene(given) + [("view", given), ("serve", given)]:
                if (command[0], given) != ("serve", self.out / "shards"):  # serve may wait for a bake there
                    self.refused(2 if command[0] == "diff" else 1, told, *command)
            self.refused(1, "", "bench", "render", given)
        for given in (self.source, self.shards[0]):
            self.refused(1, "is ", "status", given)

    def test_a_bake_that_has_not_ended_says_so(self):
        begun = self.root / "begun"
        (begun / "shards").mkdir(parents=True)
        self.refused(1, "has no scene.xml yet", "info", begun)

    def test_what_a_bake_wrote_is_no_source(self):
        for given in (self.out, self.out / "scene.xml", self.shards[0]):
            for command in (("plan",), ("bake", "-o", self.root / "never")):
                self.refused(1, "is not a source", *command, given, "--voxel-size", 1)
        self.assertFalse((self.root / "never").exists())

    def test_an_export_takes_its_format_from_the_suffix(self):
        PROGRAM.succeed("export", self.out, "-o", self.root / "a.ply")
        PROGRAM.succeed("export", self.out, "--to", "ply", "-o", self.root / "b.data")
        self.assertEqual((self.root / "a.ply").read_bytes(), (self.root / "b.data").read_bytes())
        PROGRAM.succeed("export", self.out, "-o", self.root / "a.nvdb")
        self.assertEqual((self.root / "a.nvdb").read_bytes()[:7], b"NanoVDB")
        for name in ("a.obj", "folder", "a.", ".ply", "a.xml"):
            self.refused(2, "gigavoxel-binary", "export", self.out, "-o", self.root / name)
            self.assertFalse((self.root / name).exists())

    # Regression of 2026-11-22: with two swapped shards, an export wrote other voxels and exited with 0.
    def test_an_export_of_a_scene_that_does_not_fit_its_shards_writes_nothing(self):
        bad = self.root / "bad"
        shutil.copytree(self.out, bad)
        text = (bad / "scene.xml").read_text()
        line = next(line for line in text.splitlines(True) if "<PagedOctTree" in line)
        names = [shard.name for shard in self.shards]
        swapped = text.replace(names[0], "\0").replace(names[1], names[0]).replace("\0", names[1])
        formats = [f for f in ("ply", "nvdb", "vdb", "3dtiles", "gigavoxel-xml", "gigavoxel-binary")]
        for changed in (text.replace(line, line + line), text.replace(line, ""), swapped):
            (bad / "scene.xml").write_text(changed)
            for kind in formats:
                self.refused(1, str(bad), "export", bad, "--to", kind, "-o", self.root / "none")
                self.assertFalse((self.root / "none").exists(), kind)
            if changed == swapped:  # info opens no shard: only verify finds swapped shards
                self.assertEqual(PROGRAM.run("info", bad).returncode, 0)
            else:
                self.refused(1, str(bad), "info", bad)
            self.assertEqual(PROGRAM.run("verify", bad).returncode, 1)
            self.assertEqual(PROGRAM.run("diff", self.out, bad).returncode, 2 if changed != swapped else 0)

    def test_diff_ends_as_diff_does(self):
        other = self.root / "other"
        harness.write_glb(self.root / "other.glb", *TRIANGLE, colours=[[255, 0, 0, 255]] * 3)
        PROGRAM.bake(self.root / "other.glb", other, 0.25, "--cell-voxels", 8)
        self.assertEqual(PROGRAM.run("diff", self.out, self.out).returncode, 0)
        self.assertEqual(PROGRAM.run("diff", self.out, other).returncode, 1)
        self.assertEqual(PROGRAM.run("diff", self.out, self.root / "absent").returncode, 2)
        for b, code in ((self.out, 0), (other, 1)):
            result = PROGRAM.run("diff", "-q", self.out, b)
            self.assertEqual((result.returncode, result.stdout, result.stderr), (code, "", ""))

    def test_quiet_says_errors_alone(self):
        for command in (("verify", self.out), ("export", self.out, "-o", self.root / "q.ply"),
                        self.commands_of_a_scene(self.out)[-1],
                        ("bake", self.source, "-o", self.root / "quiet", "--voxel-size", 0.5)):
            result = PROGRAM.run(*command, "--quiet")
            self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""), command)
        self.assertIn("absent", PROGRAM.run("verify", "-q", self.root / "absent").stderr)

    def test_what_no_terminal_reads_has_no_control_characters(self):
        with unittest.mock.patch.dict(os.environ, NO_COLOR="1", TERM="xterm-256color"):
            commands = self.commands_of_a_scene(self.out) + [
                ("status", self.out), ("plan", self.source, "--voxel-size", 0.5), ("--help",), ("bake", "--help"),
                ("bake", self.source, "-o", self.root / "plain", "--voxel-size", 0.5), ("man", "bake")]
            for command in commands:
                result = PROGRAM.run(*command)
                for text in (result.stdout, result.stderr):
                    self.assertNotIn("\x1b", text, command)
                    self.assertNotIn("\r", text, command)

    def test_verify_of_an_old_scene_says_that_it_has_no_totals(self):
        scene = Path(SOURCE) / "tests/format/golden/version_1/scene.xml"
        self.assertIn("has no summary", PROGRAM.succeed("verify", scene))
        self.assertFalse(json.loads(PROGRAM.succeed("verify", scene, "--json"))["has_totals"])
        self.assertNotIn("totals", PROGRAM.succeed("verify", self.out))


if __name__ == "__main__":
    PROGRAM, SOURCE = harness.Gigabake(str(Path(sys.argv.pop(1)).resolve())), sys.argv.pop(1)
    unittest.main(verbosity=2)
