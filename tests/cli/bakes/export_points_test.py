#!/usr/bin/env python3
"""Point clouds with places on the earth: LAS, and PLY with its origin.

LAS files are read with nothing but the LAS specification 1.4 - R15.

Usage: export_points_test.py GIGABAKE SOURCE_DIR
"""
import resource
import struct
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from gdal_there import coordinate_system, osr
from programs import lines_of

VOXEL_M = 0.5
HEADER = struct.Struct("<4sHH16sBB32s32sHHHIIBHI5I3d3d6dQQIQ15Q")
EXTRA_TYPES = {1: "u1", 9: "<f4"}
POINT_7 = [("xyz", "<i4", 3), ("intensity", "<u2"), ("returns", "u1"), ("flags", "u1"), ("class", "u1"), ("user", "u1"),
           ("angle", "<i2"), ("source", "<u2"), ("time", "<f8"), ("rgb", "<u2", 3)]


class Las:
    def __init__(self, path):
        data = path.read_bytes()
        (magic, _, encoding, _, major, minor, _, self.software, _, _, header_bytes, self.first, records, form, length,
         old_count, *rest) = HEADER.unpack_from(data)
        assert (magic, major, minor, header_bytes, form) == (b"LASF", 1, 4, 375, 7) and HEADER.size == 375
        assert encoding == 16  # WKT
        assert (old_count, rest[:5]) == (0, [0] * 5)
        self.scale, self.offset = rest[5:8], rest[8:11]
        highest, lowest = rest[11:17:2], rest[12:17:2]
        assert rest[17:20] == [0, 0, 0]
        count, by_return = rest[20], rest[21:]
        assert by_return == [count] + [0] * 14
        self.read_records(data, header_bytes, records)
        layout = numpy.dtype(POINT_7 + self.extra)
        assert layout.itemsize == length and len(data) == self.first + count * length
        self.points = numpy.frombuffer(data, layout, count, self.first)
        assert (self.points["returns"] == 0x11).all()
        self.p = self.points["xyz"] * self.scale + self.offset
        assert (self.p.min(0) == lowest).all() and (self.p.max(0) == highest).all()

    def read_records(self, data, at, records):
        self.extra = []
        for _ in range(records):
            _, user, number, length, _ = struct.unpack_from("<H16sHH32s", data, at)
            at += 54
            content = data[at:at + length]
            at += length
            if (user.rstrip(b"\0"), number) == (b"LASF_Projection", 2112):
                assert content.endswith(b"\0")
                self.wkt = content[:-1].decode()
            elif (user.rstrip(b"\0"), number) == (b"LASF_Spec", 4):
                for i in range(0, length, 192):
                    _, kind, options, name = struct.unpack_from("<HBB32s", content, i)
                    assert options == 0
                    self.extra.append((name.rstrip(b"\0").decode(), EXTRA_TYPES[kind]))
        assert at == self.first

    def crs(self):
        return coordinate_system(self.wkt)


class ExportPoints(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.Gigabake(sys.argv[1])
        cls.program.succeed("sample", cls.root / "village", "--size", "96", "--seed", "3")
        cls.scene = cls.root / "bake"
        cls.program.bake(cls.root / "village/tileset.json", cls.scene, VOXEL_M, "--cell-voxels", "64")

    def las(self, *options, scene=None):
        self.program.succeed("export", scene or self.scene, "-o", self.root / "points.las", *options)
        return Las(self.root / "points.las")

    def ply(self, lod):
        """Returns the vertices in the order of the file."""
        self.program.succeed("export", self.scene, "-o", self.root / "points.ply", "--lod", lod)
        content = (self.root / "points.ply").read_bytes()
        return numpy.frombuffer(content.split(b"end_header\n", 1)[1], harness.PLY_VERTEX)

    def test_las_has_the_points_of_ply_on_every_level(self):
        for lod in range(len(self.program.info(self.scene)["lods"])):
            with self.subTest(lod=lod):
                las, ply = self.las("--crs", "scene", "--lod", lod), self.ply(lod)
                self.assertEqual(las.p.tolist(), ply["p"].tolist())
                self.assertTrue((las.points["rgb"] == ply["rgba"][:, :3].astype("u2") * 257).all())
                self.assertTrue((las.points["coverage"] == ply["rgba"][:, 3]).all())
                normals = numpy.stack([las.points["Normal" + axis] for axis in "XYZ"], -1)
                self.assertTrue((normals == ply["n"]).all())
                self.assertTrue((las.points["class"] == 0).all())
        self.assertTrue(las.crs().IsLocal())

    def test_las_is_located_on_the_earth(self):
        origin = [float(x) for x in xml.parse(self.scene / "scene.xml").getroot().get("Origin").split()]
        frame = osr.SpatialReference()
        frame.ImportFromProj4("+proj=geocent +datum=WGS84")
        earth_centred = self.earth_centred(origin, self.ply(0)["p"])
        for options, epsg in (((), 32632), (("--crs", "EPSG:3857"), 3857), (("--crs", "EPSG:4326"), 4326)):
            las = self.las(*options)
            self.assertEqual(las.crs().GetAuthorityCode(None), str(epsg))
            # PROJ takes heights along only between systems with three axes.
            three = osr.SpatialReference()
            three.CopyGeogCSFrom(las.crs()) if epsg == 4326 else three.ImportFromEPSG(epsg)
            three.PromoteTo3D()
            three.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
            places = numpy.array(osr.CoordinateTransformation(frame, three).TransformPoints(earth_centred.tolist()))
            for axis in range(3):
                self.assertLess(numpy.abs(las.p[:, axis] - places[:, axis]).max(), 0.5001 * las.scale[axis] + 1e-8)
                metres = 111319.49 if epsg == 4326 and axis < 2 else 1
                self.assertLessEqual(las.scale[axis] * metres, VOXEL_M / 1000)

    def earth_centred(self, origin, points):
        """Returns points of the east-north-up frame at the origin (latitude, longitude, height) in WGS84's frame."""
        latitude, longitude = numpy.radians(origin[:2])
        a, e2 = 6378137.0, (2 - 1 / 298.257223563) / 298.257223563
        n = a / numpy.sqrt(1 - e2 * numpy.sin(latitude)**2)
        base = [(n + origin[2]) * numpy.cos(latitude) * numpy.cos(longitude),
                (n + origin[2]) * numpy.cos(latitude) * numpy.sin(longitude),
                (n * (1 - e2) + origin[2]) * numpy.sin(latitude)]
        east = [-numpy.sin(longitude), numpy.cos(longitude), 0]
        up = [numpy.cos(latitude) * numpy.cos(longitude), numpy.cos(latitude) * numpy.sin(longitude),
              numpy.sin(latitude)]
        return points @ numpy.array([east, numpy.cross(up, east), up]) + base

    def test_a_scene_without_a_place_has_its_own_frame(self):
        harness.write_glb(self.root / "square.glb", [[0, 0, 0], [4, 0, 0], [4, 0, -4]], [0, 1, 2])
        self.program.bake(self.root / "square.glb", self.root / "local", 0.25)
        self.assertTrue(self.las(scene=self.root / "local").crs().IsLocal())
        for kind in ("las", "dsm"):
            result = self.program.run("export", self.root / "local", "--to", kind, "--crs", "EPSG:32632", "-o",
                                      self.root / "none")
            self.assertEqual((result.returncode, len(lines_of(result.stderr))), (2, 1), result.stderr)
            self.assertFalse((self.root / "none").exists())

    def test_bad_input_is_one_line_and_leaves_no_file(self):
        before = sorted(self.root.iterdir())
        for code, *options in ((2, "--crs", "EPSG:99999"), (2, "--crs", "/etc/passwd"), (1, "--lod", "40")):
            result = self.program.run("export", self.scene, "-o", self.root / "none.las", *options)
            self.assertEqual((result.returncode, len(lines_of(result.stderr))), (code, 1), result.stderr)
        result = self.program.run("export", self.scene, "-o", self.root / "none.las", "-q", restore_signals=False,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)))
        self.assertEqual((result.returncode, len(lines_of(result.stderr))), (1, 1), result.stderr)
        self.assertEqual(sorted(self.root.iterdir()), before)

    def test_ply_states_the_origin_of_its_frame(self):
        self.program.succeed("export", self.scene, "-o", self.root / "points.ply", "--lod", 3)
        header = (self.root / "points.ply").read_bytes().split(b"end_header\n")[0].decode().splitlines()
        said = dict(line.split()[1:] for line in header if line.startswith("comment origin_"))
        origin = xml.parse(self.scene / "scene.xml").getroot().get("Origin").split()
        self.assertEqual([float(said[f"origin_{k}"]) for k in ("latitude_deg", "longitude_deg", "height_m")],
                         [float(v) for v in origin])


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1], verbosity=2)
