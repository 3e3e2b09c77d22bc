#!/usr/bin/env python3
"""Tests `gigabake render --path`: its images equal those that render draws per frame; each frame has its numbers.

Usage: path_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from programs import lines_of

SIZE = "160x90"
STATS = {"cast_s", "upload_s", "total_s", "wanted", "uploads", "pages_loading", "passes", "page_waits", "files_opened",
         "bytes_held", "bytes_allowed", "complete"}


class Paths(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.info = GIGABAKE.bake(GIGABAKE.sample(cls.root / "sample"), cls.root / "out", 0.25)
        cls.scene = cls.root / "out" / "scene.xml"

    def path(self, *keyframes, **more):
        file = self.root / "path.json"
        file.write_text(json.dumps({"keyframes": keyframes, **more}))
        return file

    def along(self, path, *options):
        self.frames = Path(tempfile.mkdtemp(dir=self.root))
        GIGABAKE.succeed("render", self.scene, "--path", path, "-o", self.frames / "%03d.png", "--size", SIZE,
                         "--stats", self.frames / "stats.json", *options)
        return json.loads((self.frames / "stats.json").read_text())["frames"]

    def refuse(self, code, expect, *options):
        if "-o" not in options:
            options += "-o", self.root / "refused-%d.png"
        result = GIGABAKE.run("render", self.scene, *options)
        self.assertEqual(result.returncode, code, result)
        self.assertIn(expect, result.stderr)
        self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)
        self.assertEqual(list(self.root.glob("refused*")), [])

    def test_each_frame_is_the_picture_of_its_camera(self):
        path = self.path({"time_s": 0, "eye": [60, -70, 40], "target": [0, 0, 0]},
                         {"time_s": 1, "eye": [70, 10, 30], "target": [0, 0, 5], "fovy_deg": 30},
                         {"time_s": 3, "eye": [20, 60, 20], "target": [0, 0, 0]})
        frames = self.along(path, "--frames", 4)
        self.assertEqual([frame["time_s"] for frame in frames], [0, 1, 2, 3])
        self.assertEqual(frames[1]["eye"], [70, 10, 30])
        self.assertEqual(frames[1]["fovy_deg"], 30)
        for number, frame in enumerate(frames):
            self.assertEqual(set(frame["stats"]), STATS)
            self.assertTrue(frame["stats"]["complete"])
            eye, target = (",".join(map(repr, frame[name])) for name in ("eye", "target"))
            GIGABAKE.succeed("render", self.scene, "-o", self.root / "one.png", f"--eye={eye}", f"--target={target}",
                             "--fovy", repr(frame["fovy_deg"]), "--size", SIZE)
            self.assertEqual((self.frames / f"{number:03}.png").read_bytes(), (self.root / "one.png").read_bytes())

    # Regression of 2026-11-25: the first write failed after an hour of frames, or no line named the folder.
    def test_prints_where_the_frames_are_and_checks_their_folder_first(self):
        path = self.path({"time_s": 0, "eye": [60, -70, 40], "target": [0, 0, 0]},
                         {"time_s": 1, "eye": [70, -70, 40], "target": [0, 0, 0]})
        frames = self.root / "printed"
        frames.mkdir(exist_ok=True)
        printed = GIGABAKE.succeed("render", self.scene, "--path", path, "--frames", 2, "--size", "32x18", "-o",
                                   frames / "f%03d.png")
        self.assertIn(f"2 frames: {frames / 'f000.png'} to {frames / 'f001.png'}", printed)
        missing = self.root / "nodir"
        for options in (["-o", missing / "x.png"], ["-o", self.root / "refused.exr", "--depth", missing / "d.exr"],
                        ["-o", missing / "%d.png", "--path", path, "--frames", 1],
                        ["-o", self.root / "%d.png", "--path", path, "--frames", 1, "--stats", missing / "s.json"]):
            self.refuse(1, "its folder does not exist", *options)
        self.refuse(1, "a file that the command reads", "--path", path, "--frames", 1, "--stats", path)
        self.refuse(1, "a file that the command reads", "--path", path, "--frames", 1, "--stats", self.scene)

    def test_modes_show(self):
        path = self.path({"time_s": 0, "eye": [60, -70, 40], "target": [0, 0, 0]})
        pictures = []
        for mode in ("lit", "albedo"):
            self.along(path, "--frames", 1, "--mode", mode)
            pictures.append((self.frames / "000.png").read_bytes())
        self.assertNotEqual(*pictures)

    def test_frames_by_rate_and_live(self):
        path = self.path({"time_s": 5, "eye": [60, -70, 40], "target": [0, 0, 0]},
                         {"time_s": 6, "eye": [70, 10, 30], "target": [0, 0, 0]})
        self.assertEqual(len(self.along(path, "--fps", 4)), 5)
        self.assertEqual([frame["draws"] for frame in self.along(path, "--fps", 2, "--live")], [1, 1, 1])

    def test_degrees_and_metres_lead_to_the_same_place(self):
        origin = self.info["origin"]
        place = [origin["latitude_deg"], origin["longitude_deg"], origin["height_m"]]
        above = place[:2] + [place[2] + 80]
        frames = self.along(self.path({"time_s": 0, "eye": above, "target": place}, coordinates="geographic"),
                            "--frames", 1)
        for value, expected in zip(frames[0]["eye"] + frames[0]["target"], [0, 0, 80, 0, 0, 0]):
            self.assertAlmostEqual(value, expected, places=5)

    def test_what_is_wrong_is_named(self):
        good = self.path({"time_s": 0, "eye": [60, -70, 40], "target": [0, 0, 0]})
        self.refuse(2, "--frames or --fps", "--path", good)
        self.refuse(2, "--frames or --fps", "--path", good, "--frames", 2, "--fps", 2)
        self.refuse(2, "--frames", "--path", good, "--frames", -1)
        self.refuse(2, "--path", "--frames", 2)
        self.refuse(2, "--mode: expected one of lit, albedo", "--path", good, "--frames", 1, "--mode", "x-ray")
        self.refuse(2, "%04d", "--path", good, "--frames", 1, "-o", self.root / "refused.png")
        self.refuse(1, "none.json", "--path", self.root / "none.json", "--frames", 1)
        bad = self.path({"time_s": 0, "eye": [60, -70], "target": [0, 0, 0]})
        self.refuse(1, "keyframes[0].eye: expected an array of 3 numbers", "--path", bad, "--frames", 1)


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
