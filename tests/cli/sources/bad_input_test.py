#!/usr/bin/env python3
"""Bad input ends in one clear line and the right exit code; nothing is lost, nothing is left half-written.

Usage: bad_input_test.py GIGABAKE SOURCE_DIR
"""
import copy
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

SQUARE = [[0, 0, 0], [4, 0, 0], [4, 0, -4], [0, 0, -4]]
TWO = [0, 1, 2, 0, 2, 3]
# A PNG of one red dot.
DOT = ("data:image/png;base64,"
       "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mP4z8AAAAMBAQD3A0FDAAAAAElFTkSuQmCC")


def document_of(glb):
    content = Path(glb).read_bytes()
    size = int.from_bytes(content[12:16], "little")
    return json.loads(content[20:20 + size]), content[28 + size:]


class BadInput(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        self.source = self.root / "source"
        self.source.mkdir()
        self.good = self.source / "good.glb"
        harness.write_glb(self.good, SQUARE, TWO)
        self.out = self.root / "out"

    def tearDown(self):
        self.folder.cleanup()

    def bake(self, source, *arguments, **options):
        return PROGRAM.run("bake", source, "-o", self.out, "--voxel-size", "0.5", *arguments, **options)

    def expect_refusal(self, source, *words, code=1, arguments=(), **options):
        """Expects one line on standard error, no scene and no temporary files."""
        result = self.bake(source, *arguments, **options)
        self.assertEqual(result.returncode, code, result.stderr)
        lines = [line for line in result.stderr.splitlines() if line.startswith("gigabake: ")]
        self.assertEqual(len(lines), 1, result.stderr)
        for word in words:
            self.assertIn(word, lines[0])
        self.assertFalse((self.out / "scene.xml").exists())
        self.expect_no_leftovers()

    def expect_loss(self, source, *words, cells, **options):
        """Expects exit code 3, the missing input in the last line of the log, and all other cells in the scene."""
        result = self.bake(source, **options)
        self.assertEqual(result.returncode, 3, result.stderr)
        lines = result.stderr.strip().splitlines()
        last = lines[-1] if "ranks" not in options else result.stderr  # mpirun appends its own lines
        for word in words:
            self.assertIn(word, last)
        info = PROGRAM.info(self.out / "scene.xml")
        self.assertEqual(len(info["losses"]), 1)
        self.assertEqual(info["cells"], cells)
        self.expect_no_leftovers()

    def expect_no_leftovers(self):
        self.assertEqual([p for p in self.root.rglob("*") if p.name.endswith(".part")], [])

    def changed(self, change, name="bad.glb"):
        """Returns the path of a GLB like the good one, with its JSON changed."""
        document, binary = document_of(self.good)
        document = copy.deepcopy(document)
        change(document)
        path = self.root / "bad" / name
        path.parent.mkdir(exist_ok=True)
        harness.write_glb_document(path, document, binary)
        return path

    # Whole sources

    def test_missing_source(self):
        self.expect_refusal(self.root / "nowhere.glb", "nowhere.glb", "no such file")

    def test_empty_folder(self):
        (self.root / "empty").mkdir()
        self.expect_refusal(self.root / "empty", "holds no .glb")

    def test_file_of_another_kind(self):
        (self.root / "scene.fbx").write_text("solid\n")
        self.expect_refusal(self.root / "scene.fbx", "expected a .glb")

    def test_json_that_is_no_scene(self):
        (self.root / "x.json").write_text('{"hello": 1}')
        self.expect_refusal(self.root / "x.json", "expected a tileset")

    def test_json_that_is_cut_off(self):
        (self.root / "x.json").write_text('{"root": {"children": [')
        self.expect_refusal(self.root / "x.json", "not valid JSON", "at byte")

    def test_json_nested_too_deep(self):
        (self.root / "x.json").write_text("[" * 100000)
        self.expect_refusal(self.root / "x.json", "nested deeper", "at byte")

    def test_tileset_that_includes_itself(self):
        tileset = {"asset": {"version": "1.0"}, "geometricError": 1,
                   "root": {"geometricError": 1, "refine": "ADD", "boundingVolume": {"sphere": [0, 0, 0, 9]},
                            "content": {"uri": "tileset.json"}}}
        (self.source / "tileset.json").write_text(json.dumps(tileset))
        self.expect_refusal(self.source / "tileset.json", "includes itself")

    def test_content_that_leaves_the_source_folder(self):
        for uri in ("../../../../etc/passwd", "/etc/passwd", "file:///etc/passwd", "%2e%2e/%2e%2e/etc/passwd"):
            tileset = {"asset": {"version": "1.0"}, "geometricError": 1,
                       "root": {"geometricError": 1, "refine": "ADD", "boundingVolume": {"sphere": [0, 0, 0, 9]},
                                "content": {"uri": uri}}}
            (self.source / "tileset.json").write_text(json.dumps(tileset))
            self.expect_refusal(self.source / "tileset.json", "content.uri")

    # One content file and nothing else to bake

    def test_truncated_file(self):
        whole = self.good.read_bytes()
        bad = self.root / "cut.glb"
        for size in (3, 11, 19, 60, len(whole) - 1):
            bad.write_bytes(whole[:size])
            self.expect_refusal(bad, f"{bad}: ")  # once, as a path

    def test_buffer_that_leaves_the_source_folder(self):
        def change(document):
            document["buffers"][0]["uri"] = "../../../../etc/passwd"
        self.expect_refusal(self.changed(change), "leaves the source folder")

    def test_accessor_beyond_its_view(self):
        def change(document):
            document["accessors"][0]["count"] = 4000000000
        self.expect_refusal(self.changed(change), "accessors[0]")

    def test_index_beyond_the_vertices(self):
        harness.write_glb(self.root / "bad.glb", SQUARE, [0, 1, 2, 0, 2, 99])
        self.expect_refusal(self.root / "bad.glb", "index 5 is 99")

    def test_nodes_in_a_circle(self):
        def change(document):
            document["nodes"] = [{"children": [1]}, {"children": [0], "mesh": 0}]
        self.expect_refusal(self.changed(change), "cycle")

    def test_extension_that_is_required_and_lacking(self):
        def change(document):
            document["extensionsRequired"] = document["extensionsUsed"] = ["KHR_texture_basisu"]
        self.expect_refusal(self.changed(change), "KHR_texture_basisu")

    def test_image_that_is_missing(self):
        def change(document):
            document["images"] = [{"uri": "gone.png"}]
            document["textures"] = [{"source": 0}]
            document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
            document["meshes"][0]["primitives"][0]["material"] = 0
        self.expect_loss(self.changed(change), "images[0].uri: no such file: ", "gone.png", cells=1)

    def test_words_and_numbers_that_gltf_does_not_have(self):
        """Regression of 2026-11-22: an unknown wrapping mode was treated as repetition."""
        def with_material(document, material, sampler):
            document["images"] = [{"uri": DOT}]
            document["samplers"] = [sampler]
            document["textures"] = [{"source": 0, "sampler": 0}]
            document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, **material}]
            document["meshes"][0]["primitives"][0]["material"] = 0
        fog = self.changed(lambda d: with_material(d, {"alphaMode": "FOG"}, {}))
        self.expect_refusal(fog, "OPAQUE, MASK, BLEND", "'FOG'")
        # Regression of 2026-11-25: an invalid sampler only costs the sampler, and is reported.
        for sampler, words in (({"wrapS": 33069}, "read as clamp to edge: 1, e.g. samplers[0].wrapS 33069"),
                               ({"wrapT": 1}, "read as repeat: 1, e.g. samplers[0].wrapT 1")):
            result = self.bake(self.changed(lambda d, s=sampler: with_material(d, {}, s)))
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(words, result.stderr)
        good = self.changed(lambda d: with_material(d, {"alphaMode": "BLEND"}, {"wrapS": 33648, "wrapT": 33071}))
        self.assertEqual(self.bake(good).returncode, 0)

    def test_transform_that_overflows(self):
        def change(document):
            document["nodes"][0] = {"mesh": 0, "scale": [1e308, 1e308, 1e308], "children": [1]}
            document["nodes"].append({"mesh": 0, "scale": [1e308, 1e308, 1e308]})
        self.expect_refusal(self.changed(change), "not finite")

    def test_triangles_that_are_not_finite_or_have_no_area_are_dropped_and_counted(self):
        nan, inf = float("nan"), float("inf")
        positions = SQUARE + [[nan, 0, 0], [inf, 0, 0]]
        indices = TWO + [0, 1, 4, 0, 1, 5, 0, 1, 1, 0, 0, 0]
        document_path = self.root / "odd.glb"
        harness.write_glb(document_path, SQUARE + [[0, 0, 0], [0, 0, 0]], indices)
        document, binary = document_of(document_path)
        broken = bytearray(binary)
        broken[48:72] = struct.pack("<6f", *positions[4], *positions[5])
        harness.write_glb_document(document_path, document, bytes(broken))
        self.assertEqual(self.bake(document_path).returncode, 0)
        info = PROGRAM.info(self.out / "scene.xml")
        self.assertEqual((info["skipped"]["non_finite"], info["skipped"]["zero_area"]), (2, 2))
        self.assertEqual(info["lods"][0]["voxels"], 64)

    def test_points_and_lines_are_counted(self):
        def change(document):
            primitive = document["meshes"][0]["primitives"][0]
            document["meshes"][0]["primitives"] += [dict(primitive, mode=0), dict(primitive, mode=3)]
        self.assertEqual(self.bake(self.changed(change)).returncode, 0)
        skipped = PROGRAM.info(self.out / "scene.xml")["skipped"]
        self.assertEqual((skipped["points"], skipped["lines"]), (6, 5))

    # Bad files among good files

    def test_one_bad_file_costs_itself_alone(self):
        harness.write_glb(self.source / "far.glb", SQUARE, TWO, translation=(600, 0, 0))
        (self.source / "middle.glb").write_bytes(b"glTF\2\0\0\0rubbish")
        self.expect_loss(self.source, "middle.glb", cells=2)
        self.expect_loss(self.source, "middle.glb", cells=2, ranks=3)

    def with_image(self, uri):
        def change(document):
            document["images"] = [{"uri": uri}]
            document["textures"] = [{"source": 0}]
            document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
            document["meshes"][0]["primitives"][0]["material"] = 0
        return self.changed(change).read_bytes()

    def tileset_of(self, *uris):
        children = [{"geometricError": 0, "boundingVolume": {"sphere": [0, 0, 0, 9]}, "content": {"uri": uri}}
                    for uri in uris]
        path = self.source / "tileset.json"
        path.write_text(json.dumps({
            "asset": {"version": "1.0"}, "geometricError": 1,
            "root": {"geometricError": 1, "refine": "ADD", "boundingVolume": {"sphere": [0, 0, 0, 9]},
                     "children": children}}))
        return path

    def test_plan_and_bake_end_alike_and_say_each_problem_once(self):
        """Regression of 2026-11-22: plan and bake had different exit codes, and losses were reported three times."""
        (self.source / "cut.glb").write_bytes(self.good.read_bytes()[:60])
        (self.source / "pale.glb").write_bytes(self.with_image("gone.png"))
        for uris, code, lost in ((["good.glb"], 0, []), (["cut.glb"], 1, ["cut.glb"]), (["pale.glb"], 3, ["pale.glb"]),
                                 (["none.glb"], 1, ["none.glb"]), (["good.glb", "cut.glb"], 3, ["tile cut.glb"]),
                                 (["good.glb", "pale.glb", "none.glb"], 3, ["tile pale.glb", "none.glb"])):
            scene = self.tileset_of(*uris)
            plan = PROGRAM.run("plan", scene, "--voxel-size", "0.5")
            bake = self.bake(scene)
            for result in (plan, bake):
                self.assertEqual(result.returncode, code, (uris, result.args, result.stderr))
                for name in lost:
                    self.assertEqual(sum(name in line for line in result.stderr.splitlines()), 1, result.stderr)

    # Options

    def test_wrong_options(self):
        for arguments, word in ((("--voxel-size", "0"), "--voxel-size"), (("--voxel-size", "nan"), "--voxel-size"),
                                (("--voxel-size", "-1"), "--voxel-size"), (("--voxel-size", "x"), "--voxel-size"),
                                (("--cell-voxels", "100"), "--cell-voxels"), (("--surface", "solid"), "--surface"),
                                (("--mip", "none"), "--mip"), (("--lattice-origin", "1,2"), "--lattice-origin"),
                                (("--origin", "95,0,0"), "--origin"), (("--local", "--origin", "1,2,3"), "--local"),
                                (("--memory", "1M"), "--memory"), (("--up", "w"), "--up")):
            size = () if "--voxel-size" in arguments else ("--voxel-size", "1")
            result = PROGRAM.run("bake", self.good, "-o", self.out, *size, *arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertIn(word, result.stderr)
        self.assertFalse(self.out.exists())

    def test_unknown_command_or_option(self):
        self.assertEqual(PROGRAM.run("cook").returncode, 2)
        self.assertEqual(PROGRAM.run("bake", self.good, "--fast").returncode, 2)
        self.assertEqual(PROGRAM.run().returncode, 2)

    def test_the_bake_process_started_by_hand(self):
        result = PROGRAM.run("bake-process", 77)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertNotIn("bake-process", PROGRAM.run("--help").stdout)

    # Output folder

    def test_out_is_a_file(self):
        self.out.write_text("mine")
        result = self.bake(self.good)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.out.read_text(), "mine")

    def test_out_cannot_be_made(self):
        result = PROGRAM.run("bake", self.good, "-o", "/proc/gigabake", "--voxel-size", "1")
        self.assertEqual(result.returncode, 1)
        self.assertIn("/proc/gigabake", result.stderr)

    @unittest.skipIf(os.geteuid() == 0, "root writes anywhere")
    def test_read_only_folder(self):
        self.out.mkdir(mode=0o500)
        self.expect_refusal(self.good, "out")

    def test_full_disk_fails_the_cells_and_leaves_nothing_half_written(self):
        self.out.mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=96k", "tmpfs", self.out],
                               capture_output=True, text=True, check=False)
        if mount.returncode != 0:
            self.skipTest(f"cannot mount a small disk: {mount.stderr.strip()}")
        try:
            self.bake_on_full_disk()
        finally:
            subprocess.run(["umount", self.out], check=True)

    def test_read_only_disk(self):
        self.out.mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "ro", "tmpfs", self.out], capture_output=True, text=True,
                               check=False)
        if mount.returncode != 0:
            self.skipTest(f"cannot mount a read-only disk: {mount.stderr.strip()}")
        try:
            self.expect_refusal(self.good, "Read-only file system")
        finally:
            subprocess.run(["umount", self.out], check=True)

    def bake_on_full_disk(self):
        random = numpy.random.default_rng(5)
        grid = numpy.arange(101) * 0.04
        x, z = numpy.meshgrid(grid, -grid)
        positions = numpy.stack([x, 0 * x, z], -1).reshape(-1, 3)
        corner = numpy.arange(100)[:, None] * 101 + numpy.arange(100)
        squares = numpy.stack([corner, corner + 1, corner + 102, corner, corner + 102, corner + 101], -1)
        harness.write_glb(self.root / "noise.glb", positions, squares, random.integers(0, 256, (len(positions), 4)))
        result = PROGRAM.run("bake", self.root / "noise.glb", "-o", self.out, "--voxel-size", "0.01")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("cell c_0_0_0", result.stderr.splitlines()[-1])
        self.assertIn("No space left", result.stderr.splitlines()[-1])
        self.expect_no_leftovers()
        # Only the status with the error and the cached scan remain.
        self.assertLessEqual({p.name for p in self.out.iterdir()}, {"status.json", "survey.cache"})

    def test_a_bake_that_fails_leaves_the_previous_scene(self):
        self.assertEqual(self.bake(self.good).returncode, 0)
        before = (self.out / "scene.xml").read_bytes()
        self.assertEqual(self.bake(self.root / "nowhere.glb").returncode, 1)
        self.assertEqual((self.out / "scene.xml").read_bytes(), before)
        self.assertEqual(PROGRAM.run("verify", self.out / "scene.xml").returncode, 0)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
