#!/usr/bin/env python3
"""Tests `gigabake serve`: a browser flies through a scene, shows the image of `render`, and follows a running bake.

Usage: serve_test.py GIGABAKE SOURCE_DIR
"""
import contextlib
import json
import math
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import chromium
import harness
from png_file import read_png
from programs import lines_of
from served import Server

SIZE = (320, 200)
RESTS = "document.body.dataset.resting === 'true'"


class Serve(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        GIGABAKE.succeed("sample", cls.root / "sample", "--size", 96, "--tiles", 2)
        cls.bake(cls.root / "out")
        cls.scene = cls.root / "out" / "scene.xml"

    @classmethod
    def bake(cls, out):
        GIGABAKE.succeed("bake", cls.root / "sample" / "tileset.json", "-o", out, "--voxel-size", 0.25,
                         "--cell-voxels", 128)

    def serve(self, *arguments):
        server = Server(GIGABAKE, *arguments, "--port", 0)
        self.addCleanup(server.close)
        return server

    def wait_for_bake(self, server, state):
        """Waits for the state of the bake: while a page polls too, an answer may be 50 ms old."""
        deadline = time.monotonic() + 10
        while json.loads(server.ask("bake")[1])["state"] != state:
            self.assertLess(time.monotonic(), deadline, state)
            time.sleep(0.05)

    def open_page(self, server):
        return chromium.open_page(self, server.url, SIZE)

    def shown(self, page):
        """Returns the page's image at rest without its texts, the expected image, and the page's state."""
        for text in ("bar", "place"):
            page.evaluate(f"document.getElementById('{text}').style.visibility = 'hidden'")
        deadline = time.monotonic() + 60
        while True:  # the image lags the state by milliseconds, and the state lags the input
            page.wait_for(f"{RESTS} && shownState.frame && shownState.frame.full && !Object.keys(pending).length")
            state = page.evaluate("shownState")
            expected, image = self.rendered(state), read_png(page.screenshot())[..., :3]
            if numpy.abs(image - expected).mean() < 3 or time.monotonic() > deadline:
                return image, expected, state
            time.sleep(0.2)

    def rendered(self, state):
        """Returns the image that `render` draws for the page's camera."""
        path = self.root / "rendered.png"
        camera = ["--eye=" + ",".join(map(repr, state["eye"])), "--target=" + ",".join(map(repr, state["target"]))]
        GIGABAKE.succeed("render", self.scene, "-o", path, "--size", "{}x{}".format(*state["size"]), *camera,
                         "--mode", state["mode"], "--pixel-error", state["pixel_error"])
        return read_png(path)[..., :3]

    def test_a_browser_flies_and_sees_what_render_draws(self):
        page = self.open_page(self.serve(self.scene))
        page.wait_for("typeof shownState !== 'undefined' && shownState && shownState.frame")
        moves = [
            ("nothing", lambda: None),
            ("drag", lambda: page.drag((100, 100), (180, 90))),
            ("wheel", lambda: page.mouse("mouseWheel", 160, 100, deltaX=0, deltaY=-300)),
            ("right drag", lambda: page.drag((100, 100), (120, 130), "right")),
            ("mode", lambda: page.key("KeyM")),
            ("style", lambda: page.key("KeyO")),
            ("walk", lambda: page.key("KeyW", 0.4)),
            ("home", lambda: page.key("KeyH")),
        ]
        seen = {}
        for name, move in moves:
            before = page.evaluate("JSON.stringify([shownState.eye, shownState.target, shownState.mode])")
            move()
            if name not in ("nothing", "style"):
                page.wait_for("JSON.stringify([shownState.eye, shownState.target, shownState.mode]) !== "
                              + json.dumps(before))
            image, expected, state = self.shown(page)
            self.assertEqual(image.shape, (SIZE[1], SIZE[0], 3))
            self.assertLess(numpy.abs(image - expected).mean(), 3, name)
            seen[name] = image, state
        before = seen["nothing"][0]
        for name in ("drag", "wheel", "right drag", "mode", "walk"):
            self.assertGreater(numpy.abs(seen[name][0] - before).mean(), 4, name)
            before = seen[name][0]
        self.assertLess(self.distance(seen["wheel"][1]), self.distance(seen["drag"][1]))
        self.assertEqual(seen["mode"][1]["mode"], "albedo")
        self.assertEqual(seen["home"][1]["eye"], seen["nothing"][1]["eye"])

    def distance(self, state):
        return numpy.linalg.norm(numpy.subtract(state["eye"], state["target"]))

    def test_the_picture_button_gives_the_bytes_of_render(self):
        server = self.serve(self.scene)
        key = json.loads(server.ask("viewers", {"size": SIZE, "turn": [0.2, 0.05]})[1])["viewer"]
        status, picture = server.ask(f"picture.png?viewer={key}")
        state = json.loads(server.ask(f"state?viewer={key}")[1])
        self.assertEqual(status, 200)
        self.rendered(state)
        self.assertEqual(picture, (self.root / "rendered.png").read_bytes())

    def boxes(self, page, *names):
        """Returns left, top, right and bottom of elements."""
        return page.evaluate("[%s].map((name) => document.getElementById(name).getBoundingClientRect())"
                             ".map((box) => [box.left, box.top, box.right, box.bottom])" % json.dumps(names)[1:-1])

    def test_the_page_fits_a_phone_that_is_rotated(self):  # 2026-11-22
        page = self.open_page(self.serve(self.scene))
        page.wait_for("typeof shownState !== 'undefined' && shownState && shownState.frame")
        page.key("Slash")
        for width, height in ((390, 844), (844, 390), (320, 568), (568, 320)):
            page.be_phone(width, height)
            page.wait_for(f"JSON.stringify(shownState.size) === '[{2 * width},{2 * height}]'")
            page.wait_for("shownState.frame.size[0] {} shownState.frame.size[1]".format("<>"[width > height]))
            bar, keys, picture = self.boxes(page, "bar", "keys", "picture")
            self.assertEqual(picture, [0, 0, width, height])
            for left, top, right, bottom in (bar, keys):
                self.assertTrue(0 <= left < right <= width and 0 <= top < bottom <= height, (bar, keys, width, height))
            self.assertLessEqual(bar[3], keys[1], "the bar covers the keys")
            self.assertLess(bar[3], height / 3, "the bar covers the image")
        before = page.evaluate("JSON.stringify(shownState.eye)")
        page.swipe((300, 200), (380, 190))
        page.wait_for(f"JSON.stringify(shownState.eye) !== {json.dumps(before)}")

    def test_the_page_measures_and_keeps_views(self):  # 2026-11-24
        page = self.open_page(self.serve(self.scene))
        page.wait_for("typeof shownState !== 'undefined' && shownState && shownState.resting")
        middle = [size // 2 for size in SIZE]
        page.mouse("mouseMoved", *middle)
        page.wait_for("over !== null")
        start = page.evaluate("over.scene")
        page.key("KeyC")
        page.mouse("mouseMoved", middle[0] + 20, middle[1])
        page.wait_for(f"over !== null && JSON.stringify(over.scene) !== JSON.stringify({start})")
        end = page.evaluate("over.scene")
        page.key("KeyC")
        note = page.evaluate("document.getElementById('note').textContent")
        self.assertTrue(note.startswith(f"{math.dist(start, end):.2f} m: "), (note, start, end))
        kept = page.evaluate("[shownState.eye, shownState.target].flat()")
        page.key("Digit1", shift=True)
        page.drag((100, 100), (160, 90))
        page.wait_for(f"JSON.stringify([shownState.eye, shownState.target].flat()) !== JSON.stringify({kept})")
        page.key("Digit1")
        page.wait_for(f"[shownState.eye, shownState.target].flat().every((v, i) => Math.abs(v - {kept}[i]) < 1e-6)")

    def test_the_page_says_what_loads_and_what_was_saved(self):  # 2026-11-22
        page = self.open_page(self.serve(self.scene))
        page.wait_for("typeof shownState !== 'undefined' && shownState && shownState.frame")
        for drawn, text in ((0, "loading"), (0.456, "loading 45 %")):
            state = {"scene": True, "resting": False, "problem": "", "drawn": drawn,
                     "frame": {"stats": {"complete": False}}}
            self.assertEqual(page.evaluate(f"loadingText({json.dumps(state)})"), text)
        page.key("KeyP")
        page.wait_for("document.getElementById('note').textContent.startsWith('Saved gigabake.png, {}×{}')"
                      .format(*SIZE))
        page.wait_for(RESTS)
        page.wait_for("document.getElementById('loading').textContent === ''")

    def test_a_bake_is_watched_until_its_scene_appears_and_when_it_is_replaced(self):
        out = self.root / "watched"
        out.mkdir()
        server = self.serve(out / "scene.xml")
        self.assertEqual(server.ask("bake"), (200, b"null"))
        key = json.loads(server.ask("viewers", {})[1])["viewer"]
        self.assertFalse(json.loads(server.ask(f"state?viewer={key}")[1])["scene"])
        with server.heard_from(key):
            page = self.open_page(server)
            page.wait_for("document.getElementById('message')?.textContent.includes('no scene yet')")
            self.bake(out)
            page.wait_for("shownState && shownState.scene && shownState.frame")
            self.wait_for_bake(server, "complete")
            self.assertEqual(server.ask(f"picture.png?viewer={key}")[0], 200)
        page.wait_for("document.getElementById('message').hidden")

    def test_the_token_in_the_address_opens_the_page_and_nothing_else_does(self):
        server = self.serve(self.scene, "--token", "correct-horse-battery")
        self.assertTrue(server.url.endswith("/?token=correct-horse-battery"))
        page = self.open_page(server)
        page.wait_for("typeof shownState !== 'undefined' && shownState && shownState.frame")
        self.assertEqual(page.evaluate("location.search"), "")
        server.url = server.url.split("?")[0]
        self.assertEqual(server.ask("")[0], 401)
        self.assertEqual(server.ask("?token=correct-horse-batterx")[0], 401)
        self.assertEqual(server.ask("viewers", {})[0], 401)

    def test_beyond_this_machine_a_token_is_made_up(self):
        server = self.serve(self.scene, "--bind", "0.0.0.0")
        self.assertRegex(server.url, r"^http://[^/]+:\d+/\?token=[0-9a-f]{32}$")

    def test_an_address_that_other_hosts_can_open_is_printed(self):  # 2026-11-25: 0.0.0.0 was printed
        for bind in ("0.0.0.0", "0"):
            host = self.serve(self.scene, "--bind", bind).url.split("/")[2].rsplit(":", 1)[0]
            try:
                own = {address[4][0] for address in socket.getaddrinfo(socket.gethostname(), None)}
            except socket.gaierror:  # a host whose name nothing resolves
                own = set()
            self.assertNotIn(host, ("0.0.0.0", "0", "::"))
            self.assertTrue(host == socket.gethostname() or host in own or not host.startswith("127."), host)

    # Regression of 2026-11-25: the scene of a folder that was created later was never shown.
    def test_a_folder_that_is_not_there_yet_is_waited_for(self):
        out = self.root / "later"
        server = self.serve(out)
        self.assertIn(f"waiting for a bake into {out}", server.process.said())
        key = json.loads(server.ask("viewers", {})[1])["viewer"]
        with server.heard_from(key):
            self.bake(out)
            self.assertEqual(server.ask(f"picture.png?viewer={key}")[0], 200)

    def test_a_name_that_looks_like_a_typo_is_refused(self):  # 2026-11-25
        (self.root / "note.txt").write_text("no scene")
        is_meant = f"is {self.root / 'out'} meant?"
        for given, expected in (("oit", is_meant), ("Out", is_meant), ("otu", is_meant), ("outt/scene.xml", is_meant),
                                ("ot", is_meant), ("o-ut", is_meant),
                                ("nowhere/out", "its folder does not exist"), ("out/scen.xml", "no such file"),
                                ("note.txt", "is not a scene"), ("note.txt/scene.xml", "is not a folder")):
            result = GIGABAKE.run("serve", self.root / given, timeout=20)
            self.assertEqual(result.returncode, 1, result)
            self.assertIn(expected, result.stderr)
            self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)

    def test_names_of_a_series_are_no_typos(self):  # 2026-11-25: run_b was refused next to run_a
        for name in ("run_a", "run1", "sceneA"):
            (self.root / name / "shards").mkdir(parents=True)
        for name in ("run_b", "run-c", "runb", "run_2", "run12", "sceneB", "out2", "out_b", "outs", "cut_1"):
            server = self.serve(self.root / name)
            self.assertIn(f"waiting for a bake into {self.root / name}", server.process.said())
            server.close()

    def signals_of(self, process, field):
        """Returns signals of a process as bits. SigCgt: those with a handler; ShdPnd: those not handled yet."""
        status = Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
        return int(status.partition(f"{field}:")[2].split()[0], 16)

    def wait_until(self, condition):
        deadline = time.monotonic() + 60
        while not condition():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)

    def test_a_second_interrupt_says_that_no_file_changes(self):
        reader, writer = os.pipe()
        self.addCleanup(os.close, reader)
        os.set_blocking(writer, False)
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(writer, bytes(4096))
        os.set_blocking(writer, True)
        # The server waits for a reader of its address, so it cannot end between the two signals.
        process = subprocess.Popen([GIGABAKE.executable, "serve", self.scene, "--port", "0"], stdout=writer,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        os.close(writer)
        interrupt = 1 << (signal.SIGINT - 1)
        self.wait_until(lambda: self.signals_of(process, "SigCgt") & interrupt)
        process.send_signal(signal.SIGINT)
        self.wait_until(lambda: not self.signals_of(process, "ShdPnd") & interrupt)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        errors = harness.errors_of(process, 60)
        self.assertEqual(process.returncode, -signal.SIGINT, errors)
        self.assertEqual(errors, "gigabake: stopped immediately; serving changes no file\n")

    def test_options_that_make_no_server_are_named(self):
        for arguments, code, expected in (
                ((self.scene, "--token", "short"), 2, "--token"),
                ((self.scene, "--port", 70000), 2, "--port"),
                ((self.scene, "--bind", "no.such.host.invalid"), 1, "no.such.host.invalid"),
                ((self.scene, "--frame-ms", 0), 2, "--frame-ms"),
                ((self.scene, "--viewers", 0), 2, "--viewers"),
                ((self.scene, "--eye", "1,2"), 2, "--eye"),
                ((self.root / "nowhere" / "out" / "scene.xml",), 1, "nowhere"),
                ((self.scene, "--external-url", "maps.example.com"), 2, "--external-url"),
                ((self.scene, "--external-url", "ftp://maps.example.com/"), 2, "--external-url"),
                ((self.scene, "--external-url", "https://u@maps.example.com/"), 2, "--external-url")):
            result = GIGABAKE.run("serve", *arguments, timeout=60)
            self.assertEqual(result.returncode, code, result)
            self.assertIn(expected, result.stderr)
            self.assertEqual(len(lines_of(result.stderr)), 1, result.stderr)


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
