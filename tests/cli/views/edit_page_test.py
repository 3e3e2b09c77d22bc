#!/usr/bin/env python3
"""Tests `gigabake serve --edit`: a page previews and applies edits, other pages show them, and only they may edit.

Usage: edit_page_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
import time
import urllib.parse
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import chromium
import harness
from edit_cases import VOXEL_M, write_ground
from png_file import read_png
from served import Server, answer_of

SIZE = (960, 720)
MIDDLE = [edge // 2 for edge in SIZE]
STEADY = "shownState && shownState.resting && shownState.frame && shownState.frame.full"


class EditPage(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_ground(cls.root / "ground.glb")

    def setUp(self):
        self.scene = self.root / self._testMethodName
        GIGABAKE.succeed("bake", self.root / "ground.glb", "-o", self.scene, "--voxel-size", VOXEL_M, "--cell-voxels",
                         32, "--local", "-q")

    def serve(self, *arguments):
        server = Server(GIGABAKE, self.scene, *arguments, "--port", 0)
        self.addCleanup(server.close)
        return server

    def open_page(self, server):
        page = chromium.open_page(self, server.url, SIZE)
        page.wait_for(f"typeof shownState !== 'undefined' && {STEADY}")
        return page

    def edits(self):
        return json.loads(GIGABAKE.succeed("edit", self.scene, "--list", "--json"))["edits"]

    def hashes(self, folder):
        return harness.lod_hashes(GIGABAKE.info(folder / "scene.xml"))

    def token_of(self, server):
        return urllib.parse.parse_qs(urllib.parse.urlsplit(server.url).query)["token"][0]

    def origin_of(self, server):
        return server.url.split("/?", maxsplit=1)[0]

    def picture(self, page):
        """Returns the page's image without its texts, once the page shows the latest frame."""
        page.evaluate("for (const id of ['bar', 'place', 'note']) document.getElementById(id).style.opacity = 0")
        page.wait_for(STEADY)
        time.sleep(0.5)
        return read_png(page.screenshot())[..., :3].astype(int)

    def wait_for_picture(self, page, test):
        deadline = time.monotonic() + 60
        while not test(self.picture(page)):
            self.assertLess(time.monotonic(), deadline, "the page never showed the expected image")

    def click(self, page, x, y):
        page.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        page.mouse("mouseReleased", x, y, button="left", clickCount=1)

    def test_pages_preview_apply_and_undo_edits_and_others_show_them(self):
        server = self.serve("--edit")
        page, other = self.open_page(server), self.open_page(server)
        self.assertFalse(page.evaluate("element('edit').hidden"))
        before, before_other, hashes = self.picture(page), self.picture(other), self.hashes(self.scene)
        page.evaluate("element('edit').open = true; element('edit-size').value = 3")
        page.evaluate("element('edit-type').value = 'paint'; element('edit-colour').value = '#ff00ff'")
        self.click(page, *MIDDLE)
        page.wait_for("placed !== null && !element('edit-apply').disabled")
        at = page.evaluate("placed")
        preview = self.picture(page)
        tinted = numpy.abs(preview - before).sum(-1) > 60
        self.assertTrue(tinted[MIDDLE[1], MIDDLE[0]] and 0.001 < tinted.mean() < 0.3, tinted.mean())
        self.assertLess(numpy.abs(self.picture(other) - before_other).mean(), 0.5)
        self.assertEqual(self.edits(), [])
        self.assertEqual(self.hashes(self.scene), hashes)
        page.evaluate("element('edit-apply').click()")
        page.wait_for("element('note').textContent === 'Applied.'")
        edit = {"type": "paint", "sphere": {"position_m": at, "radius_m": 3.0}, "rgb": [255, 0, 255]}
        self.assertEqual(self.edits(), [edit])
        for shown in (page, other):
            self.wait_for_picture(shown, lambda image: (image[MIDDLE[1], MIDDLE[0]][[0, 2]]
                                                        > 2 * image[MIDDLE[1], MIDDLE[0]][1]).all())
        GIGABAKE.succeed("verify", self.scene)
        page.evaluate("element('edit-undo').click()")
        page.wait_for("element('note').textContent === 'The last edit is undone.'")
        self.assertEqual((self.edits(), self.hashes(self.scene)), ([], hashes))
        page.evaluate("element('edit').open = false")
        self.wait_for_picture(page, lambda image: numpy.abs(image - before).mean() < 0.5)

    def test_a_change_of_one_of_a_thousand_cells_uploads_little_and_keeps_the_memory_bound(self):
        GIGABAKE.succeed("sample", self.root / "sample", "--size", 256, "--tiles", 2)
        self.scene = self.root / "thousand"
        GIGABAKE.succeed("bake", self.root / "sample" / "tileset.json", "-o", self.scene, "--voxel-size", 0.5,
                         "--cell-voxels", 16, "-q")
        self.assertGreater(len(harness.cells_of(self.scene)), 1000)
        server = self.serve("--edit", "--memory", "64M", "--pixel-error", 1)
        page = self.open_page(server)
        page.evaluate("steer({pixel_error: 0.5})")
        time.sleep(1)
        before = self.picture(page)
        uploads = page.evaluate("shownState.uploads")
        key = page.evaluate("viewer")
        url, bearer = self.origin_of(server), {"Authorization": f"Bearer {self.token_of(server)}"}
        at = json.loads(answer_of(f"{url}/point?viewer={key}&x=0.5&y=0.5", None, bearer)[1])["point"]["scene"]
        edit = {"edits": [{"type": "paint", "sphere": {"position_m": at, "radius_m": 1.5}, "rgb": [255, 0, 255]}]}
        self.assertEqual(answer_of(f"{url}/edit?viewer={key}", edit, bearer)[0], 200)
        deadline = time.monotonic() + 60
        while numpy.abs(self.picture(page) - before).max() < 60:
            stats = page.evaluate("shownState.frame.stats")
            self.assertLessEqual(stats["bytes_held"], stats["bytes_allowed"])
            self.assertLess(time.monotonic(), deadline, "the change never appeared")
        page.wait_for(STEADY)
        again = page.evaluate("shownState.uploads") - uploads
        self.assertTrue(0 < again <= uploads / 50, (again, uploads))

    def test_only_this_servers_page_with_the_token_may_edit(self):
        hashes, edit = self.hashes(self.scene), {"edits": [{"type": "carve", "sphere": {"position_m": [0, 0, 1],
                                                                                        "radius_m": 3}}]}
        server = self.serve()
        key = json.loads(server.ask("viewers", {})[1])
        self.assertFalse(key["may_edit"])
        for path in ("edit", "preview"):
            self.assertEqual(server.ask(f"{path}?viewer={key['viewer']}", edit)[0], 403)
        server.close()
        server = self.serve("--edit")
        origin, token = self.origin_of(server), self.token_of(server)
        bearer = {"Authorization": f"Bearer {token}"}
        key = json.loads(answer_of(f"{origin}/viewers", {}, bearer)[1])
        self.assertTrue(key["may_edit"])
        url = f"{origin}/edit?viewer={key['viewer']}"
        self.assertEqual(answer_of(url, edit)[0], 401)
        self.assertEqual(answer_of(url, edit, {**bearer, "Origin": "http://elsewhere.example"})[0], 403)
        self.assertEqual(answer_of(url, edit, {**bearer, "Host": "elsewhere.example"})[0], 403)
        self.assertEqual(self.hashes(self.scene), hashes)
        for bad, word in (({"edits": [{"type": "melt"}]}, "melt"),
                          ({"edits": [{"type": "carve", "mesh": {"path": "/etc/passwd"}}]}, "path"),
                          ({"edits": [{"type": "carve", "sphere": {"position_m": [900, 0, 0], "radius_m": 1}}]},
                           "no voxel")):
            status, text = answer_of(url, bad, bearer)
            self.assertEqual(status, 400, text)
            self.assertIn(word, json.loads(text)["error"])
        self.assertEqual((self.edits(), self.hashes(self.scene)), ([], hashes))
        self.assertEqual(answer_of(url, edit, bearer)[0], 200)
        self.assertEqual(self.edits(), [{"type": "carve", "sphere": {"position_m": [0.0, 0.0, 1.0], "radius_m": 3.0}}])
        self.assertEqual(answer_of(url, {"undo": True}, bearer)[0], 200)
        self.assertEqual(answer_of(url, {"undo": True}, bearer)[0], 400)
        self.assertEqual((self.edits(), self.hashes(self.scene)), ([], hashes))


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
