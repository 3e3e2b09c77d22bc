#!/usr/bin/env python3
"""The scripts of examples/ do what examples/README.md states. cluster.slurm_test runs slurm_sweep.sh.

Usage: examples_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import socket
import sys
import time
import urllib.request
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class Examples(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.source = PROGRAM.sample(cls.root / "village")
        cls.scene = cls.root / "scene"
        cls.environment = {**os.environ, **harness.MPI_ENVIRONMENT, "GIGABAKE": str(PROGRAM.executable)}
        for name in ("DISPLAY", "WAYLAND_DISPLAY"):
            cls.environment.pop(name, None)
        cls.info = PROGRAM.bake(cls.source, cls.scene, 0.5)

    def start(self, name, *arguments):
        started = harness.Started(["bash", EXAMPLES / name, *map(str, arguments)], env=self.environment)
        self.addCleanup(started.end)
        return started

    def content(self, started, url):
        """Returns what a server answers; waits until it listens."""
        while started.poll() is None:
            try:
                with urllib.request.urlopen(url, timeout=60) as answer:
                    return answer.read()
            except OSError:
                time.sleep(0.05)
        self.fail(started.said())

    def test_fly_through_bakes_and_serves_where_there_is_no_display(self):
        port, scene = free_port(), self.root / "flown"
        started = self.start("fly_through.sh", self.source, scene, 1, "--port", port)
        self.assertIn(b"<html", self.content(started, f"http://127.0.0.1:{port}/").lower())
        self.assertEqual(Path(f"{scene}.png").read_bytes()[:4], b"\x89PNG")
        self.assertEqual(PROGRAM.info(scene)["voxel_size_m"], 1)

    def test_export_map_writes_heights_and_colours_with_the_same_pixels(self):
        command = ["bash", EXAMPLES / "export_map.sh", self.scene, self.root / "map", "0.5", "--crs", "scene"]
        result = harness.run(command, 120, env=self.environment)
        if "built without GDAL" in result.stderr:
            self.skipTest("this gigabake was built without GDAL")
        self.assertEqual(result.returncode, 0, result.stderr)
        for name in ("heights", "colours"):
            self.assertEqual((self.root / f"map-{name}.tif").read_bytes()[:4], b"II*\0")
        heights, colours = (line.split(" in ")[0] for line in result.stdout.splitlines())
        self.assertEqual(heights, colours)

    def test_export_volume_writes_the_finest_level_within_the_limit(self):
        counts = [level["voxels"] for level in self.info["lods"]]
        for limit, lod in ((counts[0], 0), (counts[0] - 1, 1), (counts[2], 2)):
            file = self.root / f"{lod}.ply"
            result = harness.run(["bash", EXAMPLES / "export_volume.sh", self.scene, file, str(limit)], 120,
                                 env=self.environment)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"element vertex {counts[lod]}\n".encode(), file.read_bytes()[:2000])

    def test_cesium_layer_serves_the_exported_page_twice(self):
        tiles = self.root / "tiles"
        for _ in range(2):
            port = free_port()
            started = self.start("cesium_layer.sh", self.scene, tiles, port)
            tileset = json.loads(self.content(started, f"http://127.0.0.1:{port}/tileset.json"))
            self.assertIn("root", tileset)
            self.assertIn(b"Cesium", self.content(started, f"http://127.0.0.1:{port}/index.html"))
            started.end()


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(str(Path(sys.argv[1]).resolve()))
    EXAMPLES = Path(sys.argv[2]).resolve() / "examples"
    harness.main(argv=sys.argv[:1], verbosity=2)
