#!/usr/bin/env python3
"""Tests `gigabake view` on a virtual screen: keys and mouse control it, and it shows the image of `render`.

Usage: view_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from png_file import read_png
from programs import lines_of

SIZE = (320, 240)
SKIPPED = 77
WAIT_S = 60


class Screen:
    """An X server with a virtual screen, and simulated keyboard and mouse input."""

    def __init__(self, folder, size):
        read_end, write_end = os.pipe()
        self.process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write_end), "-screen", "0", "{}x{}x24".format(*size), "-fbdir", str(folder),
             "-noreset"],  # otherwise it resets after its last client, and drops new clients
            pass_fds=(write_end,), stderr=subprocess.DEVNULL)
        os.close(write_end)
        with os.fdopen(read_end) as number:
            self.environment = dict(os.environ, DISPLAY=":" + number.readline().strip(), LIBGL_ALWAYS_SOFTWARE="1")
        self.memory = Path(folder) / "Xvfb_screen0"

    def close(self):
        self.process.terminate()
        self.process.wait()

    def hands(self, *actions):
        result = subprocess.run(["xdotool", *map(str, actions)], env=self.environment, capture_output=True, text=True,
                                timeout=WAIT_S, check=False)
        return result.stdout.split()

    def image(self):
        """Returns the displayed image, read from the server's memory: XWD format, 32 bits per pixel."""
        data = self.memory.read_bytes()
        fields = struct.unpack(">25I", data[:100])
        header, width, height, bits, row_bytes, colours = (fields[k] for k in (0, 4, 5, 11, 12, 19))
        assert bits == 32, bits
        rows = numpy.frombuffer(data, "u1", row_bytes * height, header + 12 * colours).reshape(height, row_bytes)
        return rows[:, :4 * width].reshape(height, width, 4)[..., 2::-1].astype(int)


class View(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        GIGABAKE.bake(GIGABAKE.sample(cls.root / "sample"), cls.root / "out", 0.25, "--cell-voxels", 128)
        cls.scene = cls.root / "out" / "scene.xml"
        if "without windows" in cls.without_display().stderr:
            print("skipped: this gigabake was built without windows")
            raise unittest.SkipTest("this gigabake was built without windows")

    @classmethod
    def without_display(cls):
        environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        return harness.run([GIGABAKE.executable, "view", cls.scene], WAIT_S, env=environment)

    def open_window(self, *arguments, size=SIZE):
        folder = Path(tempfile.mkdtemp(dir=self.root))
        self.screen = Screen(folder, size)
        self.addCleanup(self.screen.close)
        self.saved = folder
        self.process = harness.Started(
            [GIGABAKE.executable, "view", self.scene, "--size", "{}x{}".format(*size), "-o", folder, *arguments],
            env=self.screen.environment)
        self.addCleanup(self.process.end)
        self.window = window = self.wait_for(
            lambda: self.screen.hands("search", "--onlyvisible", "--name", "gigabake"))[0]
        self.screen.hands("windowmove", window, 0, 0)

        def focus():  # no window manager sets the focus
            self.screen.hands("windowfocus", window)
            return self.screen.hands("getwindowfocus", "-f") == [window]

        self.wait_for(focus)

    def title(self):
        return " ".join(self.screen.hands("getwindowname", self.window))

    def wait_for(self, condition):
        deadline = time.monotonic() + WAIT_S
        while True:
            result = condition()
            if result:
                return result
            self.assertIsNone(self.process.poll(), "the window has closed: " + self.process.said())
            self.assertLess(time.monotonic(), deadline, "waited in vain: " + self.process.said())
            time.sleep(0.05)

    def keep(self, key, kind):
        """Returns the path of the file that a key saves."""
        before = set(self.saved.glob(f"gigabake-*.{kind}"))
        self.screen.hands("key", key)
        new = self.wait_for(lambda: set(self.saved.glob(f"gigabake-*.{kind}")) - before)
        return new.pop()

    def hold(self, key, seconds):
        self.screen.hands("keydown", key)
        time.sleep(seconds)
        self.screen.hands("keyup", key)

    def picture(self):
        return read_png(self.keep("p", "png"))[..., :3]

    def picture_after(self, move, before):
        """Repeats a move until the image changes, and returns the image. A busy window may ignore a short key press."""
        def differs():
            move()
            after = self.picture()
            return [after] if numpy.abs(after - before).mean() > 1 else None

        return self.wait_for(differs)[0]

    def rendered(self, *options):
        path = self.root / "rendered.png"
        GIGABAKE.succeed("render", self.scene, "-o", path, "--size", "{}x{}".format(*SIZE), *options)
        return path

    def test_a_window_follows_a_bake_and_reports_the_cell_at_a_click(self):
        out = self.root / "watched"
        command = [GIGABAKE.executable, "bake", self.root / "sample" / "tileset.json", "-o", out,
                   "--voxel-size", "0.25", "--cell-voxels", "32", "--threads", "1"]
        bake = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        self.addCleanup(lambda: bake.poll() is None and os.killpg(bake.pid, signal.SIGKILL))
        while len(list((out / "shards").glob("c_*.h5"))) < 8:
            self.assertIsNone(bake.poll(), "the bake ended before")
            time.sleep(0.002)
        os.killpg(bake.pid, signal.SIGSTOP)
        self.scene = out
        self.open_window()
        positions = iter([(x, y) for y in range(20, SIZE[1], 20) for x in range(20, SIZE[0], 20)] * 100)

        def clicked():  # the panel covers some positions
            self.screen.hands("mousemove", "--window", self.window, *next(positions), "sleep", 0.05, "click", 1)
            return re.search(r"^c_[-\d_]+: (waiting|baking|done), \d+ triangles", self.process.said(), re.MULTILINE)

        self.wait_for(clicked)
        os.killpg(bake.pid, signal.SIGCONT)
        self.assertEqual(bake.wait(timeout=300), 0)
        self.wait_for(lambda: "loading" not in self.title())

    def test_the_brush_previews_and_applies_an_edit(self):
        self.scene = self.root / "brushed"
        shutil.copytree(self.root / "out", self.scene)
        self.open_window("--edit", size=(640, 480))
        self.screen.hands("key", "F1")  # hides the panel
        before = self.picture()
        self.screen.hands("key", "F2")
        self.wait_for(lambda: "loading" not in self.title())
        shown = self.screen.image()

        def placed():
            self.screen.hands("mousemove", "--window", self.window, 400, 240, "sleep", 0.1, "click", 1, "sleep", 0.3)
            return numpy.abs(self.screen.image()[200:280, 340:460] - shown[200:280, 340:460]).mean() > 0.5

        self.wait_for(placed)
        self.assertEqual(numpy.abs(self.picture() - before).mean(), 0)  # saved images have no preview
        self.screen.hands("key", "Return")
        self.wait_for(lambda: "applied" in self.process.said())
        edits = json.loads(GIGABAKE.succeed("edit", self.scene, "--list", "--json"))["edits"]
        self.assertEqual([sorted(edit) for edit in edits], [["sphere", "type"]])
        self.wait_for(lambda: numpy.abs(self.picture() - before).mean() > 0)
        GIGABAKE.succeed("verify", self.scene)

    def test_the_saved_picture_has_the_bytes_of_render_and_is_on_the_screen(self):
        camera = ("--eye=60,-70,50", "--target=0,0,0")
        self.open_window(*camera)
        saved, expected = self.keep("p", "png"), self.rendered(*camera)
        self.assertEqual(saved.read_bytes(), expected.read_bytes())
        image = read_png(expected)[..., :3]
        self.screen.hands("key", "F1")  # hides the panel
        self.wait_for(lambda: numpy.abs(self.screen.image() - image).mean() < 1)
        self.screen.hands("key", "F1")
        self.wait_for(lambda: numpy.abs(self.screen.image() - image).mean() > 1)

    def test_keys_and_mouse_steer(self):
        self.open_window()
        moves = [
            ("walk", lambda: self.hold("w", 0.5)),
            ("turn", lambda: self.hold("Right", 0.5)),
            ("drag", lambda: self.screen.hands("mousemove", 260, 200, "mousedown", 1, "mousemove", 280, 205,
                                               "mousemove", 300, 210, "mouseup", 1)),
            ("wheel", lambda: self.screen.hands("click", 4, "click", 4, "click", 4)),
            ("mode", lambda: self.screen.hands("key", "m")),
            ("level", lambda: self.screen.hands("key", "plus", "key", "plus", "key", "plus", "key", "plus")),
            ("home", lambda: self.screen.hands("key", "h")),
        ]
        self.screen.hands("key", "F1")  # the panel would receive the mouse
        start = before = self.picture()
        for name, move in moves:
            with self.subTest(name):
                before = self.picture_after(move, before)
        self.assertGreater(numpy.abs(before - start).mean(), 1)  # mode and level are not part of the camera

    def test_a_recorded_path_can_be_rendered(self):
        self.open_window()
        seen = self.picture()
        self.screen.hands("key", "r")
        for _ in range(3):
            seen = self.picture_after(lambda: self.hold("d", 0.4), seen)
        end = self.keep("p", "png")
        path = self.keep("r", "json")
        keyframes = json.loads(path.read_text())["keyframes"]
        self.assertGreaterEqual(len(keyframes), 3)
        GIGABAKE.succeed("render", self.scene, "-o", self.root / "path-%d.png", "--path", path, "--frames", 2,
                         "--size", "{}x{}".format(*SIZE))
        self.assertNotEqual((self.root / "path-0.png").read_bytes(), (self.root / "path-1.png").read_bytes())
        self.assertEqual((self.root / "path-1.png").read_bytes(), end.read_bytes())

    def test_it_measures_and_keeps_views(self):
        self.open_window("--eye=60,-70,50", "--target=0,0,0")
        before = self.picture()
        # A busy window may ignore a short key press.
        for x, said in ((120, "press C at the other end"), (200, "m horizontal")):
            self.wait_for(lambda: (said in self.title(), self.screen.hands("mousemove", x, 170, "key", "c"))[0]
                          or said in self.title())
        view = self.saved / "gigabake-view-1.json"
        self.wait_for(lambda: view.exists() or self.screen.hands("key", "shift+1") or view.exists())
        moved = self.picture_after(lambda: self.hold("w", 0.5), before)
        back = self.picture_after(lambda: self.screen.hands("key", "1"), moved)
        self.assertTrue((back == before).all(), "the pixels of the view that was kept")

    def test_a_question_mark_shows_the_keys(self):  # 2026-11-25: only the page showed them
        self.open_window("--eye=60,-70,50", "--target=0,0,0")
        image = read_png(self.keep("p", "png"))[..., :3]
        self.screen.hands("key", "F1")
        self.wait_for(lambda: numpy.abs(self.screen.image() - image).mean() < 1)
        self.screen.hands("key", "question")
        self.wait_for(lambda: numpy.abs(self.screen.image() - image).mean() > 5)
        self.screen.hands("key", "question")
        self.wait_for(lambda: numpy.abs(self.screen.image() - image).mean() < 1)

    def test_escape_closes(self):
        self.open_window()
        self.picture()
        self.screen.hands("key", "Escape")
        self.assertEqual(self.process.wait(timeout=WAIT_S), 0, self.process.said())
        self.assertEqual(self.process.said().splitlines()[-1], "closed: Esc")

    def test_a_full_picture_that_takes_seconds_ends_at_once_with_escape(self):  # 2026-11-22
        self.open_window("--threads", "1", "--eye=30,-40,30", "--target=0,0,0", size=(1280, 960))
        self.wait_for(lambda: "% rendered" in self.title())
        start = time.monotonic()
        self.screen.hands("key", "Escape")
        self.assertEqual(self.process.wait(timeout=WAIT_S), 0, self.process.said())
        closed_s = time.monotonic() - start
        start = time.monotonic()
        GIGABAKE.succeed("render", self.scene, "-o", self.root / "large.png", "--threads", "1", "--size", "1280x960",
                         "--eye=30,-40,30", "--target=0,0,0")
        self.assertLess(closed_s, 0.75 * (time.monotonic() - start), "it took as long as the image")

    def test_the_title_says_what_was_saved(self):  # 2026-11-22
        self.open_window()
        saved = self.keep("p", "png")
        self.screen.hands("key", "F1")
        self.wait_for(lambda: "saved {}, {}x{}".format(saved, *SIZE) in self.title())
        self.wait_for(lambda: "loading" not in self.title())

    def test_without_a_display_it_says_what_to_do_instead(self):
        result = self.without_display()
        self.assertEqual(result.returncode, 1)
        self.assertIn("gigabake serve", result.stderr)
        self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)

    def test_a_scene_that_is_none_is_named(self):
        result = GIGABAKE.run("view", self.root / "missing.xml")
        self.assertEqual(result.returncode, 1)
        self.assertIn("missing.xml", result.stderr)


def reason_to_skip():
    for program in ("Xvfb", "xdotool"):
        if not shutil.which(program):
            return f"{program} is not installed (Debian: xvfb, xdotool)"
    return None


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    REASON = reason_to_skip()
    if REASON:
        print("skipped:", REASON)
        sys.exit(SKIPPED)
    harness.main(argv=sys.argv[:1])
