#!/usr/bin/env python3
"""Voxel sizes of materials and nodes.

The reference for a file with several sizes is the scene in which its parts are files with one size each: both have the
same voxels.

Usage: named_sizes_test.py GIGABAKE SOURCE_DIR
"""
import json
import shutil
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

VOXEL_M, SEED = 0.125, 20261128
LODS = 6


def sheet(random, edge_m, height, step_m=2.0):
    """Returns the triangles of rolling ground, one after the other; y is up."""
    along = numpy.arange(0, edge_m + step_m / 2, step_m)
    x, z = numpy.meshgrid(along, along)
    y = height + random.uniform(-1, 1, x.shape)
    return numpy.stack([x, y, -z], -1).reshape(-1, 3)[harness.squares_of_grid(len(along)).reshape(-1)]


def leaves(random, edge_m, height, count=120):
    """Returns small triangles around a height."""
    middles = random.uniform([2, height - 2, 2 - edge_m], [edge_m - 2, height + 2, -2], (count, 3))
    return (middles[:, None] + random.normal(0, 0.3, (count, 3, 3))).reshape(-1, 3)


def write_glb(path, meshes, nodes, materials=(), instances=None):
    """Writes a GLB. A mesh is a list of (triangles, number of the material or None). The last node has instances."""
    binary, views, accessors, entries = b"", [], [], []

    def add(points):
        nonlocal binary
        points = numpy.asarray(points, "<f4")
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": points.nbytes})
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(points), "type": "VEC3",
                          "min": points.min(0).tolist(), "max": points.max(0).tolist()})
        binary += points.tobytes()
        return len(accessors) - 1

    for mesh in meshes:
        entries.append({"primitives": [{"attributes": {"POSITION": add(points)},
                                        **({} if material is None else {"material": material})}
                                       for points, material in mesh]})
    if instances is not None:
        nodes[-1]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": add(instances)}}}
    children = {child for node in nodes for child in node.get("children", ())}
    harness.write_glb_document(path, {
        "asset": {"version": "2.0"}, "scene": 0, "meshes": entries, "nodes": nodes, "accessors": accessors,
        "scenes": [{"nodes": [n for n in range(len(nodes)) if n not in children]}], "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
        **({"materials": [{"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1]}}
                          for name, colour in materials]} if materials else {})}, binary)


MATERIALS = (("ground", (0.2, 0.6, 0.1)), ("trees", (0.6, 0.2, 0.1)))


class NamedSizes(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        random = numpy.random.default_rng(SEED)
        cls.ground, cls.trees, cls.other = sheet(random, 32, 0), leaves(random, 32, 1), leaves(random, 32, 4)
        parts = [[(cls.ground, 0)], [(cls.trees, 1)]]
        write_glb(cls.root / "both.glb", [parts[0] + parts[1]], [{"mesh": 0}], MATERIALS)
        for name, mesh in zip(("ground", "trees"), parts):
            write_glb(cls.root / f"{name}.glb", [mesh], [{"mesh": 0}], MATERIALS)
        cls.split = cls.scene_file("split", {"path": "ground.glb", "voxel_size_m": 1},
                                   {"path": "trees.glb", "voxel_size_m": VOXEL_M})
        cls.named = cls.scene_file("named", {"path": "both.glb", "voxel_size_of_material": {"ground": 1}})
        cls.of_split = cls.bake("split", cls.split)

    @classmethod
    def scene_file(cls, name, *sources, **members):
        path = cls.root / f"{name}.json"
        path.write_text(json.dumps({"gigabake": 1, "sources": sources, **members}))
        return path

    @classmethod
    def bake(cls, name, source, *options, voxel_m=VOXEL_M, ranks=None):
        PROGRAM.succeed("bake", source, "-o", cls.root / name, "--voxel-size", voxel_m,
                        *(options or ("--cell-voxels", 128)), "--backend", "cpu", "-q", ranks=ranks)
        PROGRAM.succeed("verify", cls.root / name)
        return PROGRAM.info(cls.root / name)

    def expect_same(self, name, info, reference="split", of_reference=None):
        of_reference = of_reference or self.of_split
        self.assertEqual(harness.lod_hashes(info, LODS), harness.lod_hashes(of_reference, LODS), (name, SEED))
        self.assertEqual(info.get("described_voxels"), of_reference.get("described_voxels"))
        PROGRAM.succeed("diff", self.root / reference, self.root / name)

    def test_materials_equal_split_files(self):
        self.expect_same("named", self.bake("named", self.named))
        whole = self.scene_file("whole", {"path": "both.glb", "voxel_size_m": 1,
                                          "voxel_size_of_material": {"trees": VOXEL_M}})
        self.expect_same("whole", self.bake("whole", whole))
        self.assertNotEqual(harness.lod_hashes(self.bake("plain", self.root / "both.glb"), LODS),
                            harness.lod_hashes(self.of_split, LODS))

    def test_a_finer_material_makes_level_0(self):
        scene = self.scene_file("finer", {"path": "both.glb", "voxel_size_of_material": {"trees": VOXEL_M}})
        self.expect_same("finer", self.bake("finer", scene, voxel_m=1))

    def test_sizes_equal_to_the_scene_s_change_nothing(self):
        plain = self.bake("uncut", self.root / "both.glb")
        scene = self.scene_file("equal", {"path": "both.glb", "voxel_size_of_material": {"trees": VOXEL_M}})
        self.expect_same("equal", self.bake("equal", scene), "uncut", plain)

    def test_nothing_depends_on_cells_ranks_threads_memory_and_interruptions(self):
        for name, options, ranks in (("small", ("--cell-voxels", 64), None), ("large", ("--cell-voxels", 256), None),
                                     ("ranks", ("--cell-voxels", 64), 2), ("one", ("--threads", 1), None),
                                     ("memory", ("--cell-voxels", 64, "--memory", "256M"), None)):
            self.expect_same(name, self.bake(name, self.named, *options, ranks=ranks))
        shards = sorted((self.root / "ranks/shards").glob("*"))
        for shard in shards[::3]:
            shard.unlink()
        self.expect_same("ranks", self.bake("ranks", self.named, "--cell-voxels", 64))
        for shard in shards:
            self.assertEqual(shard.read_bytes(), (self.root / "small/shards" / shard.name).read_bytes())

    def test_edits_areas_and_classes_equal_split_files(self):
        cut = [{"type": "inside", "rings_m": [[[6, 6], [20, 5], [12, 25]]]}]
        carve = {"edits": [{"type": "carve", "box": {"min_m": [8, 8, -8], "max_m": [16, 16, 8]}}]}
        classes = {"class_of_material": {"ground": 2, "trees": 5}}
        area = ("--cell-voxels", 64, "--bounds", "5.3,4.2,20.4,27.7", "--crs", "scene")
        for name, members, of_scene, options in (("cut", {"edits": cut}, {}, ()), ("carved", {}, carve, ()),
                                                 ("classes", classes, {}, ()), ("area", {}, {}, area)):
            def of_one(material, members=members):
                return {key: {material: value[material]} if key == "class_of_material" else value
                        for key, value in members.items()}

            split = self.scene_file(f"{name}_split", {"path": "ground.glb", "voxel_size_m": 1, **of_one("ground")},
                                    {"path": "trees.glb", **of_one("trees")}, **of_scene)
            named = self.scene_file(f"{name}_named", {"path": "both.glb", "voxel_size_of_material": {"ground": 1},
                                                      **members}, **of_scene)
            reference = self.bake(f"{name}_split", split, *options)
            self.assertNotEqual(harness.lod_hashes(reference, LODS), harness.lod_hashes(self.of_split, LODS))
            self.expect_same(f"{name}_named", self.bake(f"{name}_named", named, *options), f"{name}_split", reference)

    def test_the_command_edit_equals_edits_in_the_scene(self):
        self.bake("stored", self.named)
        PROGRAM.succeed("edit", self.root / "stored", "--carve", "box:8,8,-8,16,16,8", "-q")
        PROGRAM.succeed("verify", self.root / "stored")
        carve = [{"type": "carve", "box": {"min_m": [8, 8, -8], "max_m": [16, 16, 8]}}]
        scene = self.scene_file("listed", {"path": "both.glb", "voxel_size_of_material": {"ground": 1}}, edits=carve)
        self.expect_same("stored", PROGRAM.info(self.root / "stored"), "listed", self.bake("listed", scene))

    def test_nodes_equal_split_files(self):
        """A size applies to the nodes below, up to a deeper size. Materials win over nodes."""
        meshes = [[(self.ground, None)], [(self.trees, None)], [(self.other, None), (self.trees + [0, 8, 0], 1)]]
        moved = {"translation": [1.5, 0.25, -2], "scale": [0.75, 0.5, 0.75]}
        nodes = [{"name": "world", "children": [1, 2], **moved}, {"name": "terrain", "mesh": 0},
                 {"name": "forest", "children": [3, 4]}, {"name": "Tree_17", "mesh": 1},
                 {"name": "group", "children": [5]}, {"mesh": 2}]
        write_glb(self.root / "tree.glb", meshes, nodes, MATERIALS)
        sources = []
        for name, mesh, size in (("terrain", meshes[0], 2), ("leaves", meshes[1], VOXEL_M),
                                 ("other", meshes[2][:1], 0.5), ("painted", meshes[2][1:], 1)):
            write_glb(self.root / f"node_{name}.glb", [mesh], [{"mesh": 0, **moved}], MATERIALS)
            sources.append({"path": f"node_{name}.glb", "voxel_size_m": size})
        split = self.bake("nodes_split", self.scene_file("nodes_split", *sources))
        scene = self.scene_file("nodes", {
            "path": "tree.glb", "voxel_size_of_material": {"trees": 1},
            "voxel_size_of_node": {"world": 2, "forest": 0.5, "Tree_17": VOXEL_M}})
        self.expect_same("nodes", self.bake("nodes", scene), "nodes_split", split)
        self.expect_same("nodes256", self.bake("nodes256", scene, "--cell-voxels", 256), "nodes_split", split)

    def test_instances_equal_split_files(self):
        """A mesh with this many instances is scanned by their boxes."""
        random = numpy.random.default_rng(SEED + 2)
        tree = leaves(random, 4, 0, 16)
        places = random.uniform([0, 0, -60], [60, 1, 0], (70000, 3))
        for name, nodes in (("forest", [{"name": "top", "children": [1]}, {"mesh": 0}]), ("field", [{"mesh": 0}])):
            write_glb(self.root / f"{name}.glb", [[(tree, None)]], nodes, instances=places)
        split = self.bake("instances_split", self.scene_file(
            "instances_split", {"path": "field.glb", "voxel_size_m": 2}, {"path": "trees.glb", "voxel_size_m": 0.5}),
            voxel_m=0.5)
        named = self.scene_file("instances", {"path": "forest.glb", "voxel_size_of_node": {"top": 2}},
                                {"path": "trees.glb"})
        self.expect_same("instances", self.bake("instances", named, voxel_m=0.5), "instances_split", split)

    def write_obj(self, name, *parts):
        """Writes an OBJ. A part has lines before its faces, and triangles."""
        text, first = "", 1
        for lines, points in parts:
            text += "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in numpy.asarray(points, "<f4").tolist()) + lines
            text += "".join(f"f {i} {i + 1} {i + 2}\n" for i in range(first, first + len(points), 3))
            first += len(points)
        (self.root / name).write_text(text)

    def test_obj_equals_split_files(self):
        parts = {"ground": ("usemtl ground\n", self.ground, 1), "trees": ("usemtl trees\n", self.trees, VOXEL_M),
                 "other": ("usemtl other\n", self.other, 0.5), "part": ("", self.other + [0.7, 3, 0], 0.25),
                 "words": ("", self.other + [0.3, 5, 0.1], 2)}
        names = {"part": "o a part\ng x\nusemtl none\n", "words": "g first second\n"}
        self.write_obj("all.obj", *((names.get(name, lines), points) for name, (lines, points, _) in parts.items()))
        for name, (lines, points, _) in parts.items():
            self.write_obj(f"{name}.obj", (lines or "usemtl none\n", points))
        split = self.bake("obj_split", self.scene_file("obj_split", *(
            {"path": f"{name}.obj", "voxel_size_m": size} for name, (_, _, size) in parts.items())))
        scene = self.scene_file("obj", {
            "path": "all.obj", "voxel_size_m": 0.5, "voxel_size_of_material": {"ground": 1, "trees": VOXEL_M},
            "voxel_size_of_node": {"a part": 0.25, "second": 2}})
        self.expect_same("obj", self.bake("obj", scene), "obj_split", split)
        self.expect_same("obj256", self.bake("obj256", scene, "--cell-voxels", 256, ranks=2), "obj_split", split)

    def test_large_files_equal_small_ones(self):
        """A large file is split into parts on scratch disk, and scanned from there."""
        random = numpy.random.default_rng(SEED + 1)
        ground, trees = sheet(random, 64, 0, 0.125), leaves(random, 64, 1)
        write_glb(self.root / "large.glb", [[(ground, 0), (trees, 1)]], [{"mesh": 0}], MATERIALS)
        self.write_obj("large.obj", ("usemtl ground\n", ground), ("usemtl trees\n", trees))
        scenes = []
        for name in ("large.glb", "large.obj"):
            scene = self.scene_file(name[-3:], {"path": name, "voxel_size_of_material": {"ground": 2}})
            options = ("--cell-voxels", 256, "--memory", "192M", "--scratch", self.root / "scratch")
            scenes.append(self.bake(name.replace(".", "_"), scene, *options, voxel_m=0.25))
        write_glb(self.root / "large_ground.glb", [[(ground, 0)]], [{"mesh": 0}], MATERIALS)
        write_glb(self.root / "large_trees.glb", [[(trees, 1)]], [{"mesh": 0}], MATERIALS)
        split = self.bake("large_split", self.scene_file("large_split",
                                                         {"path": "large_ground.glb", "voxel_size_m": 2},
                                                         {"path": "large_trees.glb"}), "--cell-voxels", 256,
                          voxel_m=0.25)
        self.expect_same("large_glb", scenes[0], "large_split", split)
        self.assertEqual(scenes[1]["described_voxels"], split["described_voxels"])

    def test_a_changed_size_bakes_the_tiles_with_the_name(self):
        """Other cells are reused; without a change, all cells are."""
        folder = self.root / "tiles"
        folder.mkdir()
        write_glb(folder / "west.glb", [[(self.trees, 0)]], [{"mesh": 0, "translation": [-256, 0, 0]}], MATERIALS[1:])
        write_glb(folder / "east.glb", [[(self.ground, 0)]], [{"mesh": 0}], MATERIALS[:1])

        def bake(ground_m):
            scene = self.scene_file("tiles", {"path": "tiles",
                                              "voxel_size_of_material": {"ground": ground_m, "trees": 1}})
            report = json.loads(PROGRAM.succeed("bake", scene, "-o", self.root / "taken", "--voxel-size", VOXEL_M,
                                                "--cell-voxels", 64, "--no-overviews", "--json"))
            PROGRAM.succeed("verify", self.root / "taken")
            return report, harness.lod_hashes(PROGRAM.info(self.root / "taken"), LODS)

        reports, hashes = zip(*(bake(ground_m) for ground_m in (1, 1, 0.25, 1)))
        west = len(list((self.root / "taken/shards").glob("c_-*")))
        self.assertGreater(west, 0)
        self.assertEqual([report["cells_taken_over"] for report in reports[:3]], [0, reports[0]["cells"], west])
        self.assertEqual(hashes[0], hashes[1])
        self.assertNotEqual(hashes[0], hashes[2])
        self.assertEqual(hashes[0], hashes[3])

    def test_a_plan_knows_the_levels(self):
        sizes = []
        for scene in (self.split, self.named, self.root / "both.glb"):
            plan = json.loads(PROGRAM.succeed("plan", scene, "--voxel-size", VOXEL_M, "--no-measure", "--json"))
            sizes.append(plan["sizes"][1]["voxels"])
        self.assertEqual(sizes[0], sizes[1])
        self.assertLess(sizes[1], 0.7 * sizes[2])

    def test_wrong_sizes_and_names_are_refused_with_one_line(self):
        (self.root / "plain.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                             "property float y\nproperty float z\nelement face 1\n"
                                             "property list uchar int vertex_indices\nend_header\n"
                                             "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        self.write_obj("some.obj", ("o box\nusemtl ground\n", self.trees))
        metres = "expected 1e-6 to 1e6 metres"
        for path, member, sizes, key, expected in (
                ("both.glb", "material", {"ground": 0.3}, ".ground", "times a power of two"),
                ("both.glb", "material", {"ground": 64}, ".ground", "coarser than the coarsest level"),
                ("both.glb", "material", {"ground": 0}, ".ground", metres),
                ("both.glb", "material", {"ground": -1}, ".ground", metres),
                ("both.glb", "material", {"ground": "a"}, ".ground", metres),
                ("both.glb", "material", {"ground": None}, ".ground", metres),
                ("both.glb", "material", {"ground": 1e9}, ".ground", metres),
                ("both.glb", "material", [1], "", "object"),
                ("both.glb", "material", {"groun": 1}, "", "no material of the source has the name"),
                ("both.glb", "node", {"ground": 1}, "", "no node of the source has the name"),
                ("both.glb", "node", {"ground": 0.3}, ".ground", "times a power of two"),
                ("some.obj", "node", {"ground": 1}, "", "no node of the source has the name"),
                ("some.obj", "material", {"box": 1}, "", "no material of the source has the name"),
                ("plain.ply", "material", {"ground": 1}, "", "no material of the source has the name"),
                ("plain.ply", "node", {"ground": 1}, "", "has no nodes; only glTF and OBJ have them")):
            for command in ("bake", "plan"):
                options = ("-q", "-o", self.root / "wrong") if command == "bake" else ("--no-measure",)
                scene = self.scene_file("wrong", {"path": path, f"voxel_size_of_{member}": sizes})
                done = PROGRAM.run(command, scene, *options, "--voxel-size", VOXEL_M, "--cell-voxels", 128)
                self.assertEqual(done.returncode, 2, (path, member, sizes, done.stderr))
                self.assertEqual(done.stderr.count("gigabake: "), 1, done.stderr)
                self.assertIn(f"wrong.json: sources[0].voxel_size_of_{member}{key}: ", done.stderr)
                self.assertIn(expected, done.stderr)
            self.assertFalse((self.root / "wrong/scene.xml").exists())
        scene = self.scene_file("wrong", {"path": "plain.ply", "voxel_size_of_node": {"a": 1}})
        done = PROGRAM.run("bake", scene, "-o", self.root / "wrong", "--voxel-size", VOXEL_M, "-q", ranks=2)
        self.assertEqual(done.stderr.count("has no nodes"), 1, done.stderr)
        done = PROGRAM.run("bake", self.named, "-o", self.root / "wrong", "--voxel-size", VOXEL_M, "--mip", "thesis")
        self.assertEqual(done.returncode, 2)
        self.assertIn("mip", done.stderr)

    def test_unknown_names_are_accepted_where_tiles_are_left_out(self):
        scene = self.scene_file("left_out", {"path": "both.glb", "voxel_size_of_material": {"ground": 1, "other": 1},
                                             "voxel_size_of_node": {"roof": 0.5}})
        PROGRAM.succeed("bake", scene, "-o", self.root / "left_out", "--voxel-size", VOXEL_M, "--cell-voxels", 128,
                        "-q", "--bounds", "5,5,20,20", "--crs", "scene")


if __name__ == "__main__":
    PROGRAM, SOURCE = harness.Gigabake(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    harness.main(argv=sys.argv[:1], verbosity=2)
