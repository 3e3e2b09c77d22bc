#!/usr/bin/env python3
"""Tests that `gigabake serve` shows the cells of a running bake: new, failed, and over the previous scene.

Usage: watch_test.py GIGABAKE SOURCE_DIR
"""
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import chromium
import harness
from png_file import read_png
from served import Server

SIZE = (480, 320)
CELL_M = 16
GRID = [(x / 16, y / 12) for y in range(13) for x in range(17)]  # positions in the image


class Watch(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        GIGABAKE.succeed("sample", cls.root / "sample", "--size", 128, "--tiles", 4)

    def setUp(self):
        self.out = self.root / self.id().rsplit(".", maxsplit=1)[-1]

    def arguments(self, *more):
        return ["bake", self.root / "sample" / "tileset.json", "-o", self.out, "--voxel-size", 0.25,
                "--cell-voxels", 64, "--threads", 1, *more]

    def start(self, *more):
        """Starts a bake whose processes pause() and resume() stop and continue."""
        command = [str(part) for part in (GIGABAKE.executable, *self.arguments(*more))]
        self.bake = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                     start_new_session=True)
        self.addCleanup(self.end)

    def end(self):
        if self.bake.poll() is None:
            os.killpg(self.bake.pid, signal.SIGKILL)
            self.bake.wait()

    def pause_when(self, condition):
        """Stops the bake as soon as the condition holds."""
        while not condition():
            self.assertIsNone(self.bake.poll(), "the bake ended before")
            time.sleep(0.002)
        os.killpg(self.bake.pid, signal.SIGSTOP)

    def finish(self, code=0):
        os.killpg(self.bake.pid, signal.SIGCONT)
        self.assertEqual(self.bake.wait(timeout=300), code)

    def shards(self):
        """Returns the names of the cells that have a shard."""
        return {path.name.rsplit("-", 1)[0] for path in (self.out / "shards").glob("c_*.h5")}

    def serve(self):
        server = Server(GIGABAKE, self.out, "--port", 0)
        self.addCleanup(server.close)
        key = json.loads(server.ask("viewers", {"size": SIZE})[1])["viewer"]
        hearing = contextlib.ExitStack()
        hearing.enter_context(server.heard_from(key))
        self.addCleanup(hearing.close)
        return server, key

    def state(self, server, key):
        return json.loads(server.ask(f"state?viewer={key}")[1])

    def wait_for(self, server, key, condition, seconds=120):
        """Returns the viewer's first state for which the condition holds."""
        deadline = time.monotonic() + seconds
        while True:
            state = self.state(server, key)
            if condition(state):
                return state
            self.assertLess(time.monotonic(), deadline, state)
            time.sleep(0.05)

    def seen(self, server, key):
        """Returns the cells that a grid of clicks reports, by name."""
        found = {}
        for x, y in GRID:
            cell = json.loads(server.ask(f"cell?viewer={key}&x={x}&y={y}")[1])["cell"]
            if cell:
                found[cell["name"]] = cell
        return found

    def wait_for_cells(self, server, key, condition, seconds=120):
        deadline = time.monotonic() + seconds
        while True:
            found = self.seen(server, key)
            if condition(found):
                return found
            self.assertLess(time.monotonic(), deadline, found)

    def surfaces(self, server, key):
        """Returns how many positions of the grid show a surface."""
        return sum(json.loads(server.ask(f"point?viewer={key}&x={x}&y={y}")[1])["point"] is not None for x, y in GRID)

    def expect_the_image_of_render(self, server, key):
        status, image = server.ask(f"picture.png?viewer={key}")
        self.assertEqual(status, 200)
        state = self.state(server, key)
        path = self.out / "rendered.png"
        GIGABAKE.succeed("render", self.out, "-o", path, "--size", "{}x{}".format(*SIZE),
                         "--eye=" + ",".join(map(repr, state["eye"])),
                         "--target=" + ",".join(map(repr, state["target"])))
        self.assertEqual(image, path.read_bytes())

    def test_cells_appear_while_the_bake_runs(self):
        server, key = self.serve()
        self.assertFalse(self.state(server, key)["scene"])
        self.start()
        self.pause_when(lambda: len(self.shards()) >= 24)  # the first cells lie in one corner, where no click hits
        state = self.wait_for(server, key, lambda s: s["watching"] and s["resting"])
        self.assertTrue(state["scene"])
        self.assertFalse((self.out / "scene.xml").exists())
        baked = self.shards()
        cells = self.wait_for_cells(server, key, lambda all: any(c["state"] == "done" for c in all.values()))
        states = {name: cell["state"] for name, cell in cells.items()}
        self.assertIn("waiting", states.values())
        self.assertLessEqual({name for name, state in states.items() if state == "done"}, baked)
        for cell in cells.values():
            self.assertTrue(all(tile.startswith("tiles/tile_") for tile in cell["tiles"]), cell)
            self.assertTrue(0 < cell["cost"] < 1 and cell["triangles"] > 0 and cell["error"] == "", cell)
            self.assertEqual(cell["seconds"] > 0, cell["state"] == "done", cell)
        bake = json.loads(server.ask("bake")[1])
        self.assertEqual(bake["state"], "baking")
        self.assertGreater(bake["cells"]["waiting"], 0)
        self.finish()
        self.wait_for(server, key, lambda s: not s["watching"] and s["resting"])
        self.expect_the_image_of_render(server, key)
        self.assertEqual(self.seen(server, key), {})
        self.assertFalse((self.out / "plan").exists())

    def test_a_bake_on_four_ranks_ends_with_the_image_of_render(self):
        server, key = self.serve()
        result = GIGABAKE.run(*self.arguments(), ranks=4)
        self.assertEqual(result.returncode, 0, result)
        self.wait_for(server, key, lambda s: s["scene"] and not s["watching"] and s["resting"])
        self.expect_the_image_of_render(server, key)

    def test_a_failed_cell_reports_its_error(self):
        GIGABAKE.succeed(*self.arguments())
        name = self.top_cell()
        shard = next((self.out / "shards").glob(f"{name}-*.h5"))
        for path in self.out.iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        shard.mkdir(parents=True)  # no file can get this name
        server, key = self.serve()
        self.start()
        plan = self.out / "plan"
        self.pause_when(lambda: plan.exists() and shard.name.encode() in plan.read_bytes())
        self.wait_for(server, key, lambda s: s["frame"])
        x, y = (CELL_M * (int(index) + 0.5) for index in name.split("_")[1:3])
        server.ask(f"steer?viewer={key}", {"pose": [x, y - 1, 500, x, y, 0]})
        cells = self.wait_for_cells(server, key, lambda all: any(c["state"] == "failed" for c in all.values()))
        self.assertEqual([c["name"] for c in cells.values() if c["state"] == "failed"], [name])
        self.assertIn(shard.name, cells[name]["error"])
        self.finish(code=3)
        self.wait_for(server, key, lambda s: not s["watching"] and s["resting"])

    def top_cell(self):
        """Returns the name of a cell without a cell above it."""
        names = self.shards()
        below = {f"c_{x}_{y}_{int(z) - 1}" for _, x, y, z in (name.split("_") for name in names)}
        return min(names - below)

    def test_the_previous_scene_stays_until_its_cells_are_baked(self):
        GIGABAKE.succeed(*self.arguments())
        server, key = self.serve()
        home = self.wait_for(server, key, lambda s: s["resting"])
        server.ask(f"steer?viewer={key}", {"pose": home["eye"] + home["target"]})
        self.wait_for(server, key, lambda s: s["resting"])
        before = self.surfaces(server, key)
        earlier = self.shard_files()
        self.start("--surface", "thin")
        # status.json is written ten times per second, in which the bake of this scene may end.
        self.pause_when(lambda: (self.out / "plan").exists() and self.shard_files() >= earlier + 12)
        self.wait_for(server, key, lambda s: s["watching"] and s["resting"])
        cells = self.wait_for_cells(server, key, lambda all: len({c["state"] for c in all.values()}) > 1)
        self.assertIn("waiting", {cell["state"] for cell in cells.values()})
        self.wait_for(server, key, lambda s: s["resting"])
        self.assertGreaterEqual(self.surfaces(server, key), before - 2, "waiting cells show the previous scene")
        self.finish()
        self.wait_for(server, key, lambda s: not s["watching"] and s["resting"])
        self.expect_the_image_of_render(server, key)

    def shard_files(self):
        return len(list((self.out / "shards").glob("c_*.h5")))

    def test_a_changed_tile_replaces_only_its_cells(self):
        shutil.copytree(self.root / "sample", self.root / "changing")
        source = self.root / "changing" / "tileset.json"
        bake = ["bake", source, "-o", self.out, "--voxel-size", 0.25, "--cell-voxels", 64]
        GIGABAKE.succeed(*bake)
        server, key = self.serve()
        uploads = self.wait_for(server, key, lambda s: s["resting"])["uploads"]
        tiles = self.root / "changing" / "tiles"
        shutil.copy(tiles / "tile_1_1.glb", tiles / "tile_1_2.glb")
        GIGABAKE.succeed(*bake)
        self.wait_for(server, key, lambda s: s["uploads"] != uploads and not s["watching"] and s["resting"])
        self.expect_the_image_of_render(server, key)

    def test_a_killed_bake_is_shown_as_far_as_it_came(self):
        self.start()
        self.pause_when(lambda: len(self.shards()) >= 24)  # the first cells lie in one corner, where no click hits
        os.killpg(self.bake.pid, signal.SIGKILL)
        self.bake.wait()
        server, key = self.serve()
        self.wait_for(server, key, lambda s: s["watching"] and s["resting"])
        self.wait_for_cells(server, key, lambda all: {"waiting", "done"} <= {c["state"] for c in all.values()})
        self.assertTrue(json.loads(server.ask("bake")[1])["interrupted"])

    def test_a_page_reports_the_cell_at_a_click(self):
        server, _ = self.serve()
        page = chromium.open_page(self, server.url, SIZE)
        self.start()
        self.pause_when(lambda: len(self.shards()) >= 8)
        page.wait_for("typeof shownState !== 'undefined' && shownState && shownState.watching && shownState.frame")
        page.wait_for("document.getElementById('bake').textContent.includes('cells')")
        middle = [edge // 2 for edge in SIZE]
        page.mouse("mousePressed", *middle, button="left", buttons=1, clickCount=1)
        page.mouse("mouseReleased", *middle, button="left", clickCount=1)
        page.wait_for("/^c_[-0-9_]+: (waiting|baking|done)/.test(document.getElementById('note').textContent)")
        boxes = read_png(page.screenshot())[..., :3]
        self.finish()
        page.wait_for("!shownState.watching && document.body.dataset.resting === 'true'")
        page.wait_for("document.getElementById('bake').textContent === ''")
        self.assertGreater(numpy.abs(read_png(page.screenshot())[..., :3] - boxes).mean(), 1)


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
