#!/usr/bin/env python3
"""Mesh files of every format, single or combined, give the expected voxels anywhere on Earth.

All tests are of 2026-11-22. Usage: mesh_files_test.py GIGABAKE SOURCE_DIR
"""
import json
import math
import struct
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

# A roof on four walls, without a floor: x, y, z (y up) and polygons, some of which are not convex.
VERTICES = [(0, 0, 0), (4, 0, 0), (4, 0, -3), (0, 0, -3), (0, 2, 0), (4, 2, 0), (4, 2, -3), (0, 2, -3), (2, 3.5, 0),
            (2, 1, -3)]
FACES = [(0, 1, 5, 8, 4), (1, 2, 6, 5), (2, 3, 7, 9, 6), (3, 0, 4, 7)]


def fan(faces):
    """Yields triangles. The fan of the only concave face starts at its concave corner."""
    for face in faces:
        face = face[face.index(9):] + face[:face.index(9)] if 9 in face else face
        for i in range(1, len(face) - 1):
            yield face[0], face[i], face[i + 1]


def obj(path):
    path.write_text("".join("v {} {} {}\n".format(*v) for v in VERTICES) +
                    "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in FACES))


def ply(path, kind):
    order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(kind)
    header = (f"ply\nformat {kind} 1.0\nelement vertex {len(VERTICES)}\nproperty float x\nproperty float y\n"
              f"property float z\nelement face {len(FACES)}\nproperty list uchar short vertex_indices\nend_header\n")
    if order is None:
        body = "".join("{} {} {}\n".format(*v) for v in VERTICES)
        body += "".join(f"{len(f)} " + " ".join(map(str, f)) + "\n" for f in FACES)
        return path.write_text(header + body)
    body = b"".join(struct.pack(order + "3f", *v) for v in VERTICES)
    body += b"".join(struct.pack(f"{order}B{len(f)}h", len(f), *f) for f in FACES)
    return path.write_bytes(header.encode() + body)


def stl(path, is_text):
    facets = [[VERTICES[i] for i in t] for t in fan(FACES)]
    if is_text:
        lines = ["solid house"]
        for facet in facets:
            lines += ["facet normal 0 0 0", "outer loop", *("vertex {} {} {}".format(*v) for v in facet), "endloop",
                      "endfacet"]
        return path.write_text("\n".join(lines + ["endsolid house", ""]))
    body = b"".join(struct.pack("<3f9fH", 0, 0, 0, *sum(facet, ()), 0) for facet in facets)
    return path.write_bytes(b"solid, but a binary file".ljust(80) + struct.pack("<I", len(facets)) + body)


def ecef(latitude, longitude, height):
    """Returns the ECEF position (WGS84), and the rows east, north, up at that place."""
    a, e2 = 6378137.0, 6.69437999014e-3
    lat, lon = math.radians(latitude), math.radians(longitude)
    n = a / math.sqrt(1 - e2 * math.sin(lat) ** 2)
    point = ((n + height) * math.cos(lat) * math.cos(lon), (n + height) * math.cos(lat) * math.sin(lon),
             (n * (1 - e2) + height) * math.sin(lat))
    east = (-math.sin(lon), math.cos(lon), 0)
    up = (math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat))
    north = (-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat))
    return point, (east, north, up)


def earth_tile(path, place):
    """Writes a b3dm with a house at the place: RTC_CENTER, and vertices as offsets in earth-centred axes, y up."""
    centre, (east, north, up) = ecef(*place)
    positions = []
    for x, y, z in VERTICES:
        dx, dy, dz = (x * e - z * n + y * u for e, n, u in zip(east, north, up))
        positions.append((dx, dz, -dy))
    glb = path.with_suffix(".glb")
    harness.write_glb(glb, positions, list(fan(FACES)))
    model = glb.read_bytes()
    glb.unlink()
    table = json.dumps({"BATCH_LENGTH": 0, "RTC_CENTER": centre}).encode()
    table += b" " * (-(28 + len(table)) % 8)
    path.write_bytes(b"b3dm" + struct.pack("<6I", 1, 28 + len(table) + len(model), len(table), 0, 0, 0) + table + model)
    return centre


class MeshFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.count = 0

    def bake(self, source, *arguments):
        self.count += 1
        out = self.root / f"out{self.count}"
        return PROGRAM.bake(source, out, 0.125, "--cell-voxels", 64, *arguments)

    def hashes(self, source, *arguments):
        return harness.lod_hashes(self.bake(source, *arguments))

    def refusal(self, source, *arguments):
        result = PROGRAM.run("plan", source, "--voxel-size", 1, *arguments)
        self.assertEqual(result.returncode, 1, result.stderr)
        line = result.stderr.strip().splitlines()[-1]
        self.assertLessEqual(len(line), 300 + len(str(source)))
        return line

    def test_the_same_numbers_in_any_format_are_the_same_voxels(self):
        obj(self.root / "house.obj")
        for kind in ("ascii", "binary_little_endian", "binary_big_endian"):
            ply(self.root / f"{kind}.ply", kind)
        stl(self.root / "text.stl", True)
        stl(self.root / "binary.stl", False)
        files = ["house.obj", "ascii.ply", "binary_little_endian.ply", "binary_big_endian.ply", "text.stl",
                 "binary.stl"]
        expected = self.hashes(self.root / files[0])
        for name in files[1:]:
            self.assertEqual(self.hashes(self.root / name), expected, name)
        z_up = self.hashes(self.root / files[0], "--up", "z")
        self.assertNotEqual(z_up, expected)
        self.assertEqual(self.hashes(self.root / "ascii.ply", "--up", "z"), z_up)
        places = [{"place": {"position_m": [8 * i, 0, 0]}, "heading_deg": 90 * i} for i in range(2)]
        scenes = []
        for name in ("house.obj", "binary_big_endian.ply", "binary.stl"):
            scenes.append(self.root / f"{name}.json")
            scenes[-1].write_text(json.dumps({"gigabake": 1, "sources": [{"path": name, **p} for p in places]}))
        expected = self.hashes(scenes[0])
        self.assertEqual([self.hashes(scene) for scene in scenes[1:]], [expected] * 2)

    # Regression of 2026-11-22: a single tile was baked tilted.
    def test_an_earth_centred_tile_alone_is_as_in_its_tileset(self):
        tiles = self.root / "tiles"
        tiles.mkdir()
        centre = earth_tile(tiles / "a.b3dm", (47.37, 8.54, 430))
        earth_tile(tiles / "b.b3dm", (47.3701, 8.5401, 431))
        children = [{"geometricError": 0, "boundingVolume": {"sphere": [*centre, 9]},
                     "content": {"uri": f"tiles/{n}.b3dm"}} for n in "ab"]

        def tileset(name, of):
            path = self.root / name
            root = {"geometricError": 1, "refine": "ADD", "boundingVolume": {"sphere": [*centre, 90]},
                    "children": of}
            path.write_text(json.dumps({"asset": {"version": "1.0"}, "geometricError": 1, "root": root}))
            return path

        origin = ("--origin", "47.3695,8.5395,425")
        alone = self.hashes(tiles / "a.b3dm", *origin)
        self.assertEqual(alone, self.hashes(tileset("a.json", children[:1]), *origin))
        self.assertEqual(self.hashes(tiles, *origin), self.hashes(tileset("both.json", children), *origin))
        info = self.bake(tiles / "a.b3dm")
        self.assertAlmostEqual(info["origin"]["latitude_deg"], 47.37, 4)
        said = PROGRAM.run("plan", tiles / "a.b3dm", "--voxel-size", 1).stderr
        self.assertIn("latitude 47.37", said)
        self.assertIn("longitude 8.54", said)
        harness.write_glb(tiles / "local.glb", VERTICES, list(fan(FACES)))
        self.assertIn("a.b3dm and 1 more holds earth-centred coordinates and local.glb does not", self.refusal(tiles))

    def warnings(self, source, *arguments):
        result = PROGRAM.run("plan", source, "--voxel-size", 1, "--no-measure", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return [line for line in result.stderr.splitlines() if " km from " in line]

    def scene(self, name, *places):
        path = self.root / name
        path.write_text(json.dumps({"gigabake": 1, "sources": [
            {"path": "house.obj", "place": {"lon_lat_height": place}} for place in places]}))
        return path

    def test_an_origin_far_from_a_source_of_any_kind_is_reported(self):
        obj(self.root / "house.obj")
        centre = earth_tile(self.root / "a.b3dm", (47.37, 8.54, 430))
        ball = {"sphere": [*centre, 9]}
        tileset = self.root / "tileset.json"
        tileset.write_text(json.dumps({"asset": {"version": "1.0"}, "geometricError": 1, "root": {
            "geometricError": 0, "boundingVolume": ball, "content": {"uri": "a.b3dm"}}}))
        for source in (self.scene("scene.json", [8.54, 47.37, 430]), tileset, self.root / "a.b3dm"):
            with self.subTest(source.name):
                for near in ((), ("--origin", "47.9,8.54,430"), ("--origin-lat-lon", "47.37,7.6,430")):
                    self.assertEqual(self.warnings(source, *near), [])
                [far] = self.warnings(source, "--origin", "49.37,8.54,430")
                self.assertRegex(far, r"^warning: --origin \(latitude 49.37°, longitude 8.54°, height 430 m\) is 222 "
                                      r"km from the source \(latitude 47\.37.*LAT,LON.*: are its latitude and "
                                      r"longitude swapped\?$")
                [swapped] = self.warnings(source, "--origin", "8.54,47.37,430")
                self.assertRegex(swapped, r"longitude swapped\? Swapped, it would be [\d.e-]+ km away$")

    def test_a_place_far_from_the_first_is_reported(self):
        obj(self.root / "house.obj")
        here, near, swapped = [8.54, 47.37, 430], [8.54, 48.2, 430], [47.37, 8.54, 430]
        self.assertEqual(self.warnings(self.scene("near.json", here, near)), [])
        [far] = self.warnings(self.scene("far.json", here, near, swapped, swapped))
        self.assertRegex(far, r"^warning: sources\[2\] and 1 more \(latitude 8.54°, longitude 47.37°, height 430 m\) "
                              r"is \d+ km from sources\[0\] \(.*\); lon_lat_height begins with the longitude: "
                              r".*Swapped, it would be 0 km away$")

    def test_a_house_at_the_earths_surface_stands_upright(self):
        earth_tile(self.root / "a.b3dm", (-33.86, 151.21, 20))
        harness.write_glb(self.root / "local.glb", VERTICES, list(fan(FACES)))
        boxes = []
        for name, arguments in (("a.b3dm", ("--origin", "-33.86,151.21,20")), ("local.glb", ())):
            self.bake(self.root / name, *arguments)
            points = self.root / f"{name}.ply"
            PROGRAM.succeed("export", self.root / f"out{self.count}" / "scene.xml", "--to", "ply", "-o", points)
            p = harness.read_ply(points)["p"]
            boxes.append((p.min(0), p.max(0)))
        for ours, local in zip(*boxes):
            self.assertLess(abs(ours - local).max(), 0.126, boxes)

    def test_a_missing_material_file_costs_colour_and_one_line(self):
        path = self.root / "house.obj"
        obj(path)
        path.write_text("mtllib missing.mtl\nusemtl wall\n" + path.read_text())
        for command in (("plan", path), ("bake", path, "-o", self.root / "out")):
            result = PROGRAM.run(*command, "--voxel-size", 1)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stderr.count("missing.mtl"), 1, result.stderr)
            self.assertIn("warning: house.obj", result.stderr)

    # Regression of 2026-11-22: the number of skipped points was not reported.
    def test_points_alone_are_counted_in_the_refusal(self):
        cloud = self.root / "cloud.ply"
        cloud.write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                         "property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n")
        self.assertIn("skipped 3 points", self.refusal(cloud))
        table = b'{"POINTS_LENGTH":5,"POSITION":{"byteOffset":0}}'
        points = self.root / "cloud.pnts"
        lengths = struct.pack("<6I", 1, 28 + len(table) + 60, len(table), 60, 0, 0)
        points.write_bytes(b"pnts" + lengths + table + b"\0" * 60)
        self.assertIn("skipped 5 points", self.refusal(points))
        harness.write_glb(self.root / "cloud.glb", VERTICES, [0, 1, 2])
        content = (self.root / "cloud.glb").read_bytes()
        size = int.from_bytes(content[12:16], "little")
        document = json.loads(content[20:20 + size])
        document["meshes"][0]["primitives"][0]["mode"] = 0
        harness.write_glb_document(self.root / "cloud.glb", document, content[28 + size:])
        self.assertIn("skipped 3 points", self.refusal(self.root / "cloud.glb"))

    def test_gltf_1_says_what_converts_it(self):
        path = self.root / "old.gltf"
        for document in ({"asset": {"version": "1.0"}, "meshes": {"m": {}}},
                         {"buffers": {"b": {}}, "meshes": {"m": {}}}):
            path.write_text(json.dumps(document))
            self.assertIn("is glTF 1.0, expected 2.0; convert it: npx gltf-pipeline", self.refusal(path))
        old = self.root / "old.glb"
        old.write_bytes(b"glTF" + struct.pack("<4I", 1, 22, 2, 0) + b"{}")
        self.assertIn("gltf-pipeline", self.refusal(old))
        tile = self.root / "old.b3dm"
        tile.write_bytes(b"b3dm" + struct.pack("<6I", 1, 50, 0, 0, 0, 0) + old.read_bytes())
        self.assertIn("3d-tiles-tools upgrade", self.refusal(tile))


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    unittest.main(argv=sys.argv[:1])
