#!/usr/bin/env python3
"""`gigabake query --profile`: stations along a line, against distances and heights that this test computes itself.

Usage: profile_test.py GIGABAKE SOURCE_DIR
"""
import csv
import io
import json
import math
import shutil
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import earth
import harness
from programs import lines_of

LONGITUDE, LATITUDE, HEIGHT_M = 8.3, 46.9, 612.0
VOXEL_M = 0.5


def surface(x, y):
    return 4 * numpy.sin(x / 15) + 3 * numpy.cos(y / 11)


class ProfileTest(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        axis = numpy.arange(-60, 61.0)
        x, y = (a.ravel() for a in numpy.meshgrid(axis, axis))
        z = surface(x, y)
        grey = (x + 60) / 120
        lines = [f"v {x[i]!r} {y[i]!r} {z[i]!r} {grey[i]!r} 0.5 0.1" for i in range(len(x))]
        lines += [f"f {a} {b} {c}" for a, b, c in (harness.squares_of_grid(121).reshape(-1, 3) + 1).tolist()]
        source = cls.root / "hills.obj"
        source.write_text("\n".join(lines).replace("np.float64(", "").replace(")", ""))
        cls.out = cls.root / "out"
        PROGRAM.succeed("bake", source, "-o", cls.out, "--up", "z", "--voxel-size", VOXEL_M, "--cell-voxels", 64, "-q",
                        "--origin", f"{LATITUDE},{LONGITUDE},{HEIGHT_M}")

    def line(self, points_m, name="line"):
        points = numpy.array([[x, y, 0] for x, y in points_m], float)
        degrees = earth.degrees_of(points, LONGITUDE, LATITUDE, HEIGHT_M)[:, :2].tolist()
        path = self.root / f"{name}.geojson"
        path.write_text(json.dumps({"type": "Feature", "properties": {},
                                    "geometry": {"type": "LineString", "coordinates": degrees}}))
        return path

    def profile(self, line, step, *options, scene=None):
        return json.loads(PROGRAM.succeed("query", scene or self.out, "--profile", line, "--step", step, "--format",
                                          "json", *options))

    def refused(self, *arguments, scene=None):
        result = PROGRAM.run("query", scene or self.out, *arguments)
        self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
        self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)
        return result.stderr

    def test_stations_lie_at_their_distances(self):
        """Chords of the ellipsoid are shorter than its geodesics by 10^-9 m here."""
        corners = [(-50, -40), (30, 35), (45, -20)]
        line, step = self.line(corners), 0.75
        answers = self.profile(line, step)
        degrees = json.loads(line.read_text())["geometry"]["coordinates"]
        vertices = numpy.array([earth.earth_centred(*p, 0) for p in degrees])
        at = numpy.array([earth.earth_centred(*answer["at"], 0) for answer in answers])
        edges = numpy.linalg.norm(numpy.diff(vertices, axis=0), axis=1)
        stations = numpy.array([answer["station_m"] for answer in answers])
        self.assertEqual(len(answers), math.ceil(edges.sum() / step) + 1)
        numpy.testing.assert_allclose(stations[:-1], step * numpy.arange(len(answers) - 1), atol=6e-4)
        self.assertAlmostEqual(stations[-1], edges.sum(), delta=6e-4)
        on_first = stations <= edges[0]
        exact = numpy.where(on_first, numpy.linalg.norm(at - vertices[0], axis=1),
                            edges[0] + numpy.linalg.norm(at - vertices[1], axis=1))
        numpy.testing.assert_allclose(stations, exact, atol=1e-3)
        beside = numpy.linalg.norm(numpy.cross(at - vertices[1], vertices[0] - vertices[1]), axis=1) / edges[0]
        self.assertLess(beside[on_first].max(), 1e-3)

    def test_heights_and_colours_are_those_of_the_same_places(self):
        answers = self.profile(self.line([(-55, -50), (52.13, 48.21)]), 0.3)
        self.assertGreater(len(answers), 450)
        self.assertEqual({answer["outcome"] for answer in answers}, {"hit"})
        table = self.root / "places.csv"
        table.write_text("lon,lat\n" + "".join("{:.12f},{:.12f}\n".format(*answer["at"]) for answer in answers))
        same = json.loads(PROGRAM.succeed("query", self.out, "--heights", table, "--coordinates", "lonlat", "--format",
                                          "json"))
        self.assertEqual(len(same), len(answers))
        equal = [all(answer[k] == other[k] for k in ("at", "outcome", "rgba", "lod", "cell", "height_error_m")) and
                 abs(answer["position"][2] - other["position"][2]) <= 0.011 for answer, other in zip(answers, same)]
        self.assertGreater(numpy.mean(equal), 0.99)  # the table's places are rounded to 0.1 mm
        rotation, origin = earth.frame(LONGITUDE, LATITUDE, HEIGHT_M)
        places = numpy.array([(earth.earth_centred(*a["position"]) - origin) @ rotation for a in answers])
        errors = places[:, 2] - surface(places[:, 0], places[:, 1])
        self.assertLess(abs(errors.mean()), 0.05 * VOXEL_M)
        self.assertLess(numpy.percentile(abs(errors), 95), 0.2 * VOXEL_M)
        red = numpy.array([answer["rgba"][0] for answer in answers])
        self.assertGreater(numpy.corrcoef(red, places[:, 0])[0, 1], 0.95)

    def test_formats_agree(self):
        line = self.line([(-20, 0), (20, 0)])
        answers = self.profile(line, 2)
        self.assertEqual([round(answer["station_m"]) for answer in answers], list(range(0, 41, 2)))
        rows = list(csv.DictReader(io.StringIO(PROGRAM.succeed("query", self.out, "--profile", line, "--step", 2))))
        self.assertEqual([(float(row["station_m"]), float(row["lon"]), float(row["height"])) for row in rows],
                         [(a["station_m"], a["position"][0], a["position"][2]) for a in answers])
        collection = json.loads(PROGRAM.succeed("query", self.out, "--profile", line, "--step", 2, "--format",
                                                "geojson"))
        self.assertEqual([(f["properties"]["station_m"], f["geometry"]["coordinates"]) for f in collection["features"]],
                         [(a["station_m"], a["position"]) for a in answers])
        PROGRAM.succeed("query", self.out, "--profile", line, "--step", 2, "--format", "npy", "-o", self.root / "p.npy")
        heights = numpy.load(self.root / "p.npy")["height_m"]
        numpy.testing.assert_allclose(heights, [a["position"][2] for a in answers], atol=0.06)
        few = self.profile(line, 1000)
        self.assertEqual([round(a["station_m"]) for a in few], [0, 40])

    def test_a_missing_cell_and_places_outside(self):
        broken = self.root / "broken"
        shutil.copytree(self.out, broken)
        line = self.line([(-80, -5), (50, -5)])
        whole = self.profile(line, 1)
        cell = next(a["cell"] for a in reversed(whole) if a["outcome"] == "hit")
        for shard in (broken / "shards").glob(cell + "-*.h5"):
            shard.unlink()
        result = PROGRAM.run("query", broken, "--profile", line, "--step", 1, "--format", "json")
        self.assertEqual(result.returncode, 3, result.stderr)
        answers = json.loads(result.stdout)
        lost = [a["station_m"] for a in answers if a["outcome"] == "cell missing"]
        self.assertEqual(lost, [a["station_m"] for a in whole if a.get("cell") == cell])
        self.assertNotIn("position", answers[-1])
        self.assertNotEqual(whole[0]["outcome"], "hit")
        self.assertIn("station_m", whole[0])

    def test_says_what_is_wrong(self):
        bad, step = self.root / "bad.geojson", ["--step", "1"]

        def message(document, *words):
            bad.write_text(document if isinstance(document, str) else json.dumps(document))
            line = self.refused("--profile", bad, *step)
            for word in ("bad.geojson", *words):
                self.assertIn(word, line)

        a, b = [LONGITUDE, LATITUDE], [LONGITUDE + 1e-4, LATITUDE]
        line = {"type": "LineString", "coordinates": [a, b]}
        message({"type": "LineString", "coordinates": []}, "coordinates", "at least 2 positions, got 0")
        message({"type": "LineString", "coordinates": [a, a]}, "coordinates", "has no length")
        message({"type": "LineString", "coordinates": [a, ["x", 1]]}, "coordinates[1]", "expected a position")
        message({"type": "LineString", "coordinates": [a, [446820, 5197740]]}, "degrees", "ogr2ogr")
        message({"type": "Polygon", "coordinates": [[a, b, a]]}, "type", "expected LineString, got 'Polygon'")
        message({"type": "MultiLineString", "coordinates": [[a, b]]}, "expected LineString")
        message({"type": "FeatureCollection", "features": []}, "holds no line")
        message({"type": "GeometryCollection", "geometries": [line, line]}, "geometries[1]", "one LineString")
        message('{"type": "LineString", "coord', "bad.geojson")
        self.assertIn("none.geojson", self.refused("--profile", self.root / "none.geojson", *step))
        good = self.line([(0, 0), (9, 0)])
        for wrong in [], ["--step", "0"], ["--step", "-1"], ["--step", "nan"], ["--step", "1e-15"]:
            self.assertIn("--step", self.refused("--profile", good, *wrong))
        self.assertIn("--coordinates", self.refused("--profile", good, *step, "--coordinates", "scene"))
        self.assertIn("expected one of", self.refused("--profile", good, *step, "--at", "0,0"))
        local = ["-o", self.root / "local", "--up", "z", "--voxel-size", 4, "-q"]
        PROGRAM.succeed("bake", self.root / "hills.obj", *local)
        self.assertIn("--origin", self.refused("--profile", good, *step, scene=self.root / "local"))


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
