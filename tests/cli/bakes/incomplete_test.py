#!/usr/bin/env python3
"""Commands that read an incomplete scene report it in one line and exit with 3. A bake without a voxel fails.

Usage: incomplete_test.py GIGABAKE SOURCE_DIR
"""
import json
import re
import shutil
import signal
import subprocess
import sys
import time
import xml.dom.minidom
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

DRAINED, INCOMPLETE = 75, 3
SQUARE = [[0, 0, 0], [16, 0, 0], [16, 0, -16], [0, 0, -16]], [0, 1, 2, 0, 2, 3]
LINE = re.compile(r"^(\d+) of (\d+) cells are missing \(gigabake info lists them\)$", re.M)


def write_tileset(path, *uris):
    box = [8, 8, 0, 8, 0, 0, 0, 8, 0, 0, 0, 1]
    children = [{"boundingVolume": {"box": box}, "geometricError": 0, "content": {"uri": uri}} for uri in uris]
    path.write_text(json.dumps({"asset": {"version": "1.1"}, "geometricError": 1, "root": {
        "boundingVolume": {"box": box}, "geometricError": 1, "refine": "ADD", "children": children}}))


class Incomplete(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.source = cls.root / "square.glb"
        harness.write_glb(cls.source, *SQUARE)
        cls.drained = cls.root / "drained"
        bake = subprocess.Popen([PROGRAM.executable, "bake", cls.source, "-o", cls.drained, "--voxel-size", "0.05",
                                 "--cell-voxels", "16"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 60
        while not any(cls.drained.glob("shards/*.h5")) and time.monotonic() < end:
            time.sleep(0.005)
        bake.send_signal(signal.SIGTERM)
        assert bake.wait(timeout=60) == DRAINED
        info = json.loads(PROGRAM.run("info", cls.drained, "--json").stdout)
        cls.missing, cls.planned = info["missing"]["cells"], info["missing"]["planned_cells"]
        assert 0 < cls.missing < cls.planned and cls.planned == info["cells"] + cls.missing, info["missing"]

    # Regression of 2026-11-25: verify printed "whole", render and export printed nothing, and all exited with 0.
    def test_every_command_that_reads_a_scene_says_what_is_missing_and_exits_with_3(self):
        scene = self.drained
        exports = [("export", scene, "--to", form, "-o", self.root / ("e" + form))
                   for form in ("ply", "las", "dsm", "ortho", "nvdb", "3dtiles", "3dtiles-gltf", "gigavoxel-xml",
                                "gigavoxel-binary")]
        for command in [("info", scene), ("info", scene, "--json"), ("verify", scene), ("verify", scene, "--json"),
                        ("verify", scene / "scene.xml", "-q"), ("render", scene, "-o", self.root / "p.png", "--size",
                                                                "32x32", "-q"),
                        ("query", scene, "--at", "0.1,0.1"), *exports]:
            with self.subTest(command=command):
                result = PROGRAM.run(*command)
                self.assertEqual(result.returncode, INCOMPLETE, result.stdout + result.stderr)
                self.assertEqual(LINE.findall(result.stderr), [(str(self.missing), str(self.planned))], result.stderr)

    def test_verify_says_that_what_is_there_is_sound(self):
        result = PROGRAM.run("verify", self.drained)
        self.assertIn(f"sound, but incomplete: {self.missing} of {self.planned} cells are missing", result.stdout)
        self.assertNotIn("whole", result.stdout)
        report = json.loads(PROGRAM.run("verify", self.drained, "--json").stdout)
        self.assertEqual((report["faults"], report["missing"]["cells"]), ([], self.missing))

    def test_diff_names_each_incomplete_scene(self):
        result = PROGRAM.run("diff", self.drained, self.drained)
        self.assertEqual(result.returncode, INCOMPLETE, result.stderr)
        self.assertEqual(result.stderr.count("cells are missing (gigabake info lists them)"), 2)
        self.assertIn(f"{self.drained}/scene.xml: {self.missing} of", result.stderr)

    def test_ranks_of_an_export_say_it_once(self):
        result = PROGRAM.run("export", self.drained, "--to", "3dtiles", "-o", self.root / "ranks", ranks=2)
        self.assertEqual(result.returncode, INCOMPLETE, result.stderr)
        self.assertEqual(len(LINE.findall(result.stderr)), 1, result.stderr)

    # Regression of 2026-11-25: scenes whose shards were deleted or truncated were "the same voxels".
    def test_diff_refuses_scenes_without_their_files(self):
        out, broken = self.root / "small", self.root / "broken"
        PROGRAM.bake(self.source, out, 0.5)
        self.assertIn("the same voxels, by their recorded hashes; verify reads the shards",
                      PROGRAM.succeed("diff", out, out))
        for damage in ("deleted", "cut short"):
            shutil.rmtree(broken, ignore_errors=True)
            shutil.copytree(out, broken)
            for shard in (broken / "shards").glob("*.h5"):
                shard.unlink() if damage == "deleted" else shard.write_bytes(shard.read_bytes()[:-1])
            for scenes in ((out, broken), (broken, out)):
                result = PROGRAM.run("diff", *scenes)
                self.assertEqual(result.returncode, 2, result.stdout)
                self.assertIn("1 of 1 shard is missing or cut short", result.stderr)

    # Regression of 2026-11-25: a bake without a voxel exited with 0, and --prune removed the previous scene's shards.
    def test_a_bake_without_a_voxel_names_the_material_and_changes_nothing(self):
        glass, ghost, tr = self.root / "glass.glb", self.root / "ghost.glb", self.root / "tr.obj"
        harness.write_glb(glass, *SQUARE, material={
            "name": "Glass", "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0]}})
        harness.write_glb(ghost, *SQUARE, numpy.zeros((4, 4), "u1"), material={"alphaMode": "BLEND"})
        (self.root / "tr.mtl").write_text("newmtl wall_1\nKd 1 1 1\nd 0\n")
        tr.write_text("mtllib tr.mtl\nv 0 0 0\nv 4 0 0\nv 4 4 0\nusemtl wall_1\nf 1 2 3\n")
        for source, words in ((glass, "material 'Glass' of glass.glb has alpha 0"), (tr, "material 'wall_1' of tr.obj"),
                              (ghost, "vertex colours have alpha 0")):
            with self.subTest(source=source.name):
                fresh, over = self.root / ("fresh_" + source.name), self.root / ("over_" + source.name)
                result = PROGRAM.run("bake", source, "-o", fresh, "--voxel-size", 0.5)
                self.assertEqual(result.returncode, 1, result.stdout)
                self.assertIn(words, result.stderr)
                self.assertNotIn("scene.xml", result.stdout)
                self.assertFalse((fresh / "scene.xml").exists())
                PROGRAM.bake(self.source, over, 0.5)
                before = {p: p.read_bytes() for p in over.rglob("*") if p.suffix in (".h5", ".xml")}
                self.assertEqual(PROGRAM.run("bake", source, "-o", over, "--voxel-size", 0.5, "--prune").returncode, 1)
                self.assertEqual({p: p.read_bytes() for p in over.rglob("*") if p.suffix in (".h5", ".xml")}, before)

    # Regression of 2026-11-25: U+FFFE in the name of a missing input made scene.xml invalid XML.
    def test_names_of_missing_inputs_leave_the_scene_well_formed(self):
        names = ["a\ufffe.glb", "b\uffff.glb", "c\x01.glb", "d%FF.glb", "e\u0007.glb", "f<&\".glb"]
        write_tileset(self.root / "names.json", "square.glb", *names)
        out = self.root / "names"
        self.assertEqual(PROGRAM.run("bake", self.root / "names.json", "-o", out, "--voxel-size", 0.5).returncode, 3)
        losses = xml.dom.minidom.parse(str(out / "scene.xml")).getElementsByTagName("Loss")
        self.assertEqual(len(losses), len(names))
        result = PROGRAM.run("info", out, "--json")
        self.assertEqual(len(json.loads(result.stdout)["losses"]), len(names))
        self.assertEqual(result.returncode, INCOMPLETE)
        self.assertEqual(result.stderr, f"{len(names)} inputs are missing (gigabake info lists them)\n")
        self.assertEqual(json.loads(PROGRAM.run("verify", out, "--json").stdout)["faults"], [])

    # Regression of 2026-11-25: identifiers that are not UTF-8 made the answers invalid JSON.
    def test_answers_about_identifiers_of_any_bytes_are_json(self):
        out, table = self.root / "asked", self.root / "places.csv"
        PROGRAM.bake(self.source, out, 0.5)
        table.write_bytes(b"id,x,y\n\xff\xfe\x01,1,1\n\xc3\xa9,2,2\n")
        answer = subprocess.run([PROGRAM.executable, "query", out, "--heights", table, "--format", "json"],
                                capture_output=True, check=True).stdout
        self.assertEqual([row["id"] for row in json.loads(answer.decode())], ["\ufffd\ufffd\x01", "\xe9"])


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
