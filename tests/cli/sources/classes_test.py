#!/usr/bin/env python3
"""Classes of voxels: from sources, materials and ids, through levels, edits, queries, images and exports.

The reference for level 0 is computed here: surfaces are flat and aligned to voxels, so that each area is a whole number
of sixteenths of a face.

Usage: classes_test.py GIGABAKE SOURCE_DIR
"""
import csv
import json
import shutil
import sys
from pathlib import Path

import h5py
import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from class_scene import EDGE, ClassTest, majority, mosaic, tile, write_gltf
from png_file import read_png


class Classes(ClassTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        random = numpy.random.default_rng(7)
        points, ids, cls.low = mosaic(random, 4.5, 5)
        write_gltf(cls.root / "low.glb", [{"points": points, "ids": {"_BATCHID": ids}}])
        points, ids, cls.high = mosaic(random, 20.5, 3)
        halves = [[p for i, p in enumerate(points) if (ids[i] == 2) == is_roof] for is_roof in (False, True)]
        write_gltf(cls.root / "high.glb", [{"points": half, "material": m} for m, half in enumerate(halves)],
                   ("wall", "roof"))
        cls.sources = [{"path": "low.glb", "class_from_ids": {"attribute": "_BATCHID", "add": 1}},
                       {"path": "high.glb", "class": 9, "class_of_material": {"roof": 6}}]
        cls.scene = cls.scene_file("scene", cls.sources)
        cls.info = cls.bake("whole", cls.scene)

    def expected(self):
        expected = {at: 1 + majority(areas) for at, areas in self.low.items()}
        for at, areas in self.high.items():
            by_class = {9: areas.get(0, 0) + areas.get(1, 0), 6: areas.get(2, 0)}
            expected[at] = majority({number: area for number, area in by_class.items() if area})
        return expected

    def test_level_0_has_the_class_of_the_max_exact_area(self):
        expected = self.expected()
        self.expect_equal(self.classes("whole"), expected)
        self.assertGreater(len(set(expected.values())), 6)
        self.assertTrue(self.info["classes"])

    def test_coarser_levels_have_the_majority_of_children(self):
        for lod in (1, 2):
            children, parents = self.classes("whole", lod - 1), self.classes("whole", lod)
            counts = {}
            for at, number in children.items():
                of_parent = counts.setdefault(tuple(c >> 1 for c in at), {})
                of_parent[number] = of_parent.get(number, 0) + 1
            # The children of a flat surface have equal weights.
            self.expect_equal(parents, {at: majority(of_classes) for at, of_classes in counts.items()})

    def test_nothing_depends_on_cells_ranks_memory_and_interruptions(self):
        lods = 2
        for name, options, ranks in (("small", ("--cell-voxels", 16), None), ("ranks", ("--cell-voxels", 16), 2),
                                     ("memory", ("--cell-voxels", 32, "--memory", "256M"), None)):
            info = self.bake(name, self.scene, *options, ranks=ranks)
            self.assertEqual(harness.lod_hashes(info, lods), harness.lod_hashes(self.info, lods), name)
            PROGRAM.succeed("diff", self.root / "whole", self.root / name)
        self.expect_equal(self.classes("small", 3), self.classes("whole", 3), "overviews")
        shutil.copytree(self.root / "ranks", self.root / "again")
        shards = sorted((self.root / "again/shards").glob("*"))
        for shard in shards[::3]:
            shard.unlink()
        self.bake("again", self.scene, "--cell-voxels", 16)
        for one in ("small", "again"):
            for shard in shards:
                self.assertEqual((self.root / one / "shards" / shard.name).read_bytes(),
                                 (self.root / "ranks/shards" / shard.name).read_bytes())

    def test_scenes_without_classes_keep_their_form(self):
        plain = self.bake("plain", self.scene_file("plain", [{"path": s["path"]} for s in self.sources]))
        self.assertNotIn("classes", plain)
        self.assertIn('Version="5"', (self.root / "plain/scene.xml").read_text())
        with h5py.File(next((self.root / "plain/shards").glob("c_*"))) as shard:
            self.assertEqual((shard.attrs["version"], shard.attrs["channels"]), (7, b"rgba normal facing"))
            self.assertNotIn("class", shard["lod_0"])
        with h5py.File(next((self.root / "whole/shards").glob("c_*"))) as shard:
            self.assertEqual((shard.attrs["version"], shard.attrs["channels"]), (9, b"rgba normal facing class"))
            self.assertEqual(shard["lod_0/class"].dtype, numpy.uint16)
            self.assertEqual(len(shard["lod_0/class"]), len(shard["lod_0/alpha"]))
        self.assertIn('Version="7"', (self.root / "whole/scene.xml").read_text())
        answer = PROGRAM.run("diff", self.root / "plain", self.root / "whole", "--json")
        self.assertEqual(answer.returncode, 1)
        lods = json.loads(answer.stdout)["cells"][0]["lods"]
        self.assertEqual(lods[0]["reclassified"], len(self.expected()))
        others = ("only_in_a", "only_in_b", "recoloured", "turned", "refaced")
        self.assertEqual([lods[0][key] for key in others], [0] * 5)

    def test_other_channels_and_filters_have_classes_too(self):
        for name, options in (("rgba", ("--channels", "rgba")), ("box", ("--mip", "box")),
                              ("bounded", ("--max-error", 8)), ("lz4", ("--codec", "lz4"))):
            self.bake(name, self.scene, "--cell-voxels", 32, *options)
            self.expect_equal(self.classes(name), self.expected(), name)

    def test_ids_are_read_in_each_form(self):
        points = tile(0, 0, 2, 2, 0.5) + tile(4, 0, 2, 2, 0.5)
        features = {"extensions": {"EXT_mesh_features": {"featureIds": [
            {"featureCount": 2, "attribute": 0, "nullFeatureId": 7}, {"featureCount": 12}]}}}
        write_gltf(self.root / "ids.glb", [{"points": points, "ids": {"_FEATURE_ID_0": [3] * 6 + [7] * 6}, **features}])
        for name, ids, expected in (("attribute", {"attribute": "_FEATURE_ID_0"}, {0: 3, 4: 7}),
                                    ("set", {"feature_ids": 0, "add": 10}, {0: 13, 4: 0}),
                                    ("implicit", {"feature_ids": 1, "add": 1}, {0: 1, 4: 7})):
            self.bake(name, self.scene_file(name, [{"path": "ids.glb", "class_from_ids": ids}]))
            classes = self.classes(name)
            for x, number in expected.items():
                # Implicit ids are the numbers of the vertices, so the vertices of a triangle differ: the lowest wins.
                found = {classes[(x + dx, y, 0)] for dx in (0, 1) for y in (0, 1)}
                self.assertIn(number, found, name)
                if name != "implicit":
                    self.assertEqual(found, {number}, name)
        mixed = PROGRAM.run("bake", self.root / "implicit.json", "-o", self.root / "mixed", "--voxel-size", 1)
        self.assertIn("triangles whose vertices have different ids; two equal ids win, else the lowest: 4",
                      mixed.stderr)

    def test_ids_that_are_not_used_are_reported_once(self):
        done = PROGRAM.run("bake", self.root / "low.glb", "-o", self.root / "unused", "--voxel-size", 1)
        self.assertEqual(done.returncode, 0)
        self.assertEqual(done.stderr.count("primitives with ids that are not used"), 1, done.stderr)

    def test_edits_paint_and_fill_classes(self):
        box = {"min_m": [4, 4, 0], "max_m": [12, 12, 8]}
        edits = [{"type": "paint", "box": box, "class": 40},
                 {"type": "fill", "box": {"min_m": [20, 20, 8], "max_m": [22, 22, 10]}, "rgb": [9, 9, 9], "class": 41},
                 {"type": "fill", "box": {"min_m": [30, 30, 8], "max_m": [31, 31, 9]}, "rgb": [9, 9, 9]},
                 {"type": "carve", "box": {"min_m": [0, 0, 0], "max_m": [2, 48, 8]}}]
        for edge in (16, 64):
            scene = self.scene_file(f"edited{edge}", self.sources, edits=edits)
            self.bake(f"edited{edge}", scene, "--cell-voxels", edge)
        PROGRAM.succeed("diff", self.root / "edited16", self.root / "edited64")
        expected = {}
        for at, number in self.expected().items():
            if at[2] == 4 and at[0] < 2:
                continue
            expected[at] = 40 if at[2] == 4 and all(4 <= c < 12 for c in at[:2]) else number
        expected.update({(x, y, z): 41 for x in (20, 21) for y in (20, 21) for z in (8, 9)})
        expected[(30, 30, 8)] = 0
        self.expect_equal(self.classes("edited16"), expected)
        shutil.copytree(self.root / "whole", self.root / "painted")
        PROGRAM.succeed("edit", self.root / "painted", "--paint", "box:4,4,0,12,12,8", "--class", 40, "-q")
        PROGRAM.succeed("verify", self.root / "painted")
        changed = {at for at, number in self.classes("painted").items() if number == 40}
        self.assertEqual(changed, {(x, y, 4) for x in range(4, 12) for y in range(4, 12)})
        PROGRAM.succeed("edit", self.root / "painted", "--undo", "-q")
        PROGRAM.succeed("diff", self.root / "painted", self.root / "whole")

    def test_an_area_keeps_classes(self):
        self.bake("area", self.scene, "--cell-voxels", 64, "--bounds", "5,5,20,20", "--crs", "scene")
        inside = {at: number for at, number in self.expected().items() if all(5 <= c < 20 for c in at[:2])}
        self.expect_equal(self.classes("area"), inside)
        PROGRAM.succeed("export", self.root / "whole", "-o", self.root / "cut.ply", "--bounds", "5,5,20,20", "--crs",
                        "scene")
        body = (self.root / "cut.ply").read_bytes().split(b"end_header\n", 1)[1]
        cut = {tuple(v["ijk"].tolist()): int(v["class"]) for v in numpy.frombuffer(body, harness.PLY_VERTEX_WITH_CLASS)}
        self.expect_equal(cut, inside)

    def test_coarse_sources_have_classes(self):
        sources = [{**self.sources[0], "voxel_size_m": 4}, self.sources[1]]
        for edge in (32, 64):
            self.bake(f"coarse{edge}", self.scene_file(f"coarse{edge}", sources), "--cell-voxels", edge)
        PROGRAM.succeed("diff", self.root / "coarse32", self.root / "coarse64")
        areas = {}
        for (x, y, _), of_ids in self.low.items():
            of_voxel = areas.setdefault((x // 4, y // 4, 1), {})
            for number, area in of_ids.items():
                of_voxel[number] = of_voxel.get(number, 0) + area
        classes = self.classes("coarse32", 2)
        for at, of_ids in areas.items():
            self.assertEqual(classes[at], 1 + majority(of_ids))
        expanded = self.classes("coarse32")
        self.assertEqual({expanded[(x, 3, 5)] for x in range(8, 12)}, {classes[(2, 0, 1)]})

    def test_branches_end_where_classes_are_equal(self):
        write_gltf(self.root / "floor.glb", [{"points": tile(0, 0, 30, EDGE, 10.5), "material": 0},
                                             {"points": tile(30, 0, 1, EDGE, 10.5), "material": 1},
                                             {"points": tile(31, 0, EDGE - 31, EDGE, 10.5), "material": 0}],
                   ("field", "road"))
        source = self.scene_file("floor", [{"path": "floor.glb", "class_of_material": {"field": 2, "road": 11}}])
        stored = []
        for name, *options in (("full", "--cell-voxels", 64), ("ended", "--cell-voxels", 64, "--depth-error", 4),
                               ("ended_small", "--cell-voxels", 32, "--depth-error", 4)):
            info = self.bake(name, source, *options)
            stored.append(info["voxels"])
            self.expect_equal(self.classes(name), {(x, y, 10): 11 if x == 30 else 2
                                                   for x in range(EDGE) for y in range(EDGE)}, name)
        PROGRAM.succeed("diff", self.root / "ended", self.root / "ended_small")
        self.assertLess(stored[1], stored[0] / 2)

    def test_query_returns_classes_of_every_level(self):
        expected = self.expected()
        places = [(x + 0.5, y + 0.5) for x in range(0, EDGE, 5) for y in range(0, EDGE, 7)]
        table = self.root / "places.csv"
        table.write_text("x,y\n" + "".join(f"{x},{y}\n" for x, y in places))
        for name in ("whole", "small") if (self.root / "small").exists() else ("whole",):
            PROGRAM.succeed("query", self.root / name, "--heights", table, "-o", self.root / "h.csv")
            rows = list(csv.DictReader((self.root / "h.csv").open()))
            self.assertEqual([int(row["class"]) for row in rows],
                             [expected[(int(x), int(y), 20)] for x, y in places])
        answers = json.loads(PROGRAM.succeed("query", self.root / "whole", "--heights", table, "--format", "json"))
        self.assertEqual([a["class"] for a in answers], [int(row["class"]) for row in rows])
        numpy.save(self.root / "places.npy", numpy.array(places))
        PROGRAM.succeed("query", self.root / "whole", "--heights", self.root / "places.npy", "--format", "npy", "-o",
                        self.root / "h.npy", "--lod", 1)
        coarse = self.classes("whole", 1)
        self.assertEqual(numpy.load(self.root / "h.npy")["class"].tolist(),
                         [coarse[(int(x) >> 1, int(y) >> 1, 10)] for x, y in places])
        self.bake("plain_query", self.root / "high.glb")
        PROGRAM.succeed("query", self.root / "plain_query", "--heights", table, "-o", self.root / "p.csv")
        self.assertNotIn("class", (self.root / "p.csv").read_text().splitlines()[0])

    def test_python_reads_classes(self):
        sys.path.insert(0, str(SOURCE / "python"))
        import gigabake  # pylint: disable=import-outside-toplevel

        for lod in range(3):
            voxels = gigabake.open(self.root / "whole").level(lod).region()
            self.assertEqual(voxels.classes.dtype, numpy.uint16)
            self.expect_equal(dict(zip(map(tuple, voxels.index.tolist()), voxels.classes.tolist())),
                              self.classes("whole", lod))

    def test_images_show_classes(self):
        image = self.root / "i.png"
        done = PROGRAM.succeed("render", self.root / "whole", "-o", image, "--mode", "class", "--size", "96x96",
                               "--eye", "24,24,200", "--target", "24,24,20", "--up", "0,1,0", "--fovy", 10,
                               "--background", "0,0,0")
        self.assertIn("class: 0 dark grey", done)
        pixels = read_png(image)[..., :3].reshape(-1, 3).tolist()
        colours = {6: [210, 60, 50], 9: [51, 119, 200]}
        for number, colour in colours.items():
            count = sum(all(abs(a - b) <= 2 for a, b in zip(pixel, colour)) for pixel in pixels)
            self.assertGreater(count, 100, number)
        self.bake("without", self.root / "high.glb")
        refused = PROGRAM.run("render", self.root / "without", "-o", image, "--mode", "class")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("this scene has none", refused.stderr)

    def test_exports_carry_classes_or_report_them(self):
        PROGRAM.succeed("export", self.root / "whole", "-o", self.root / "v.las", "--crs", "scene")
        data = (self.root / "v.las").read_bytes()
        first, length = (int.from_bytes(data[at:at + size], "little") for at, size in ((96, 4), (105, 2)))
        self.assertIn(b"VoxelClass", data[:first])
        points = numpy.frombuffer(data, numpy.uint8, offset=first).reshape(-1, length)
        classes = numpy.ascontiguousarray(points[:, -2:]).view("<u2").reshape(-1)
        expected = list(self.classes("whole").values())
        self.assertTrue(classes.tolist() == points[:, 16].tolist() == expected)
        for name, options in (("xml", ("--to", "gigavoxel-xml")), ("v.tif", ("--to", "ortho"))):
            done = PROGRAM.run("export", self.root / "whole", *options, "-o", self.root / name)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr.count("has no place for the classes of voxels"), 1, done.stderr)


if __name__ == "__main__":
    PROGRAM, SOURCE = harness.Gigabake(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    ClassTest.PROGRAM = PROGRAM
    harness.main(argv=sys.argv[:1], verbosity=2)
