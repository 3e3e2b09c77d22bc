#!/usr/bin/env python3
"""gigabake serve behind proxies: nginx with its defaults, with gzip, under a path, and proxies that hold bytes back.

Usage: proxy_test.py GIGABAKE SOURCE_DIR
"""
import json
import re
import socket
import sys
import threading
import time
import zlib
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import chromium
import harness
from png_file import read_png
from proxies import NGINX, BlockProxy, Nginx, free_port
from served import Server, answer_of

SIZE = (320, 200)
# A proxy drops a reply after this time without bytes.
READ_TIMEOUT_S = 7
PASS = "location / {{ proxy_pass http://127.0.0.1:{port}; {more} }}"


class Stream:
    """An endless reply, read on a separate thread."""

    def __init__(self, port, path, encoding="identity"):
        self.connection = socket.create_connection(("127.0.0.1", port))
        lines = [f"GET {path} HTTP/1.0", "Host: localhost", f"Accept-Encoding: {encoding}", "", ""]
        self.connection.sendall("\r\n".join(lines).encode())
        self.received, self.ended = b"", False
        self.thread = threading.Thread(target=self.read, daemon=True)
        self.thread.start()

    def read(self):
        try:
            while data := self.connection.recv(1 << 16):
                self.received += data
        except OSError:  # closed by the test
            pass
        self.ended = True

    def body(self):
        head, _, body = self.received.partition(b"\r\n\r\n")
        if re.search(rb"(?i)content-encoding: *gzip", head):
            return zlib.decompressobj(31).decompress(body)
        return body

    def images(self):
        """Returns the images that are followed by the head of another part."""
        return re.findall(rb"Content-Type: image/jpeg\r\n\r\n(.*?)\r\n--frame\r\n(?=Content-Type: image/jpeg\r\n\r\n)",
                          self.body(), re.DOTALL)

    def close(self):
        self.connection.shutdown(socket.SHUT_RDWR)
        self.thread.join()
        self.connection.close()


def without_comments(jpeg):
    """Returns a JPEG without the comment segments at its start."""
    at = 2
    while jpeg[at:at + 2] == b"\xff\xfe":
        at += 2 + int.from_bytes(jpeg[at + 2:at + 4], "big")
    return jpeg[:2] + jpeg[at:]


class BehindProxies(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.root / "out" / "scene.xml"
        GIGABAKE.bake(GIGABAKE.sample(cls.root / "sample", tiles=1), cls.root / "out", 0.5)

    def setUp(self):
        if NGINX is None:
            self.skipTest("there is no nginx (Debian: apt install nginx)")

    def serve(self, *arguments):
        server = Server(GIGABAKE, self.scene, *arguments)
        self.addCleanup(server.close)
        return server

    def closed_at_end(self, thing):
        self.addCleanup(thing.close)
        return thing

    def wait_for_rest(self, base, key):
        deadline = time.monotonic() + 60
        while not json.loads(answer_of(f"{base}state?viewer={key}")[1])["resting"]:
            self.assertLess(time.monotonic(), deadline, "the viewer does not come to rest")
            time.sleep(0.05)

    def test_an_external_url_needs_no_other_address_to_listen_on(self):  # 2026-11-25
        token = "correct-horse-battery"
        port = free_port()
        server = self.serve("--port", port, "--external-url", "https://maps.example.com/village/", "--token", token)
        self.assertEqual(server.url, f"https://maps.example.com/village/?token={token}")
        asks = {"Authorization": f"Bearer {token}", "Origin": "https://maps.example.com"}
        strips = "location /village/ {{ proxy_pass http://127.0.0.1:{port}/; {more} }}"
        keeps = "location /village/ {{ proxy_pass http://127.0.0.1:{port}; {more} }}"
        for location in (strips, keeps):
            for more in ("", "proxy_set_header Host maps.example.com;"):
                nginx = self.closed_at_end(Nginx(location.format(port=port, more=more)))
                base = f"http://127.0.0.1:{nginx.port}/village/"
                self.assertEqual(answer_of(base + "viewers", {}, asks)[0], 201, (location, more))
                self.assertEqual(answer_of(base + f"?token={token}")[0], 200)
                self.assertEqual(answer_of(base)[0], 401)
                self.assertEqual(answer_of(base + "viewers", {}, {**asks, "Origin": "https://evil.example"})[0], 403)
        evil = {**asks, "Host": "evil.example"}
        self.assertEqual(answer_of(f"http://127.0.0.1:{port}/", None, evil)[0], 403)

    def test_a_refusal_states_host_and_origin_as_received(self):  # 2026-11-25
        server = self.serve("--port", 0)
        status, text = answer_of(server.url + "viewers", {}, {"Host": "a.example:81", "Origin": "https://b.example"})
        self.assertEqual(status, 403)
        self.assertIn("received Host 'a.example:81' and Origin 'https://b.example'", json.loads(text)["error"])

    # Regression of 2026-11-25: nginx delayed the end of the last image until the next image.
    def test_the_last_image_arrives_without_another_one(self):
        server = self.serve("--port", 0)
        port = int(server.url.split(":")[2].strip("/"))
        proxies = {
            "nginx": Nginx(PASS.format(port=port, more=f"proxy_read_timeout {READ_TIMEOUT_S}s;")),
            "nginx, gzip": Nginx(PASS.format(port=port, more=""), "gzip on; gzip_types *; gzip_proxied any;"),
            "nginx that buffers all replies": Nginx(PASS.format(
                port=port, more="proxy_ignore_headers X-Accel-Buffering; proxy_buffers 4 128k; "
                                "proxy_buffer_size 128k; proxy_busy_buffers_size 128k; "
                                f"proxy_read_timeout {READ_TIMEOUT_S}s;")),
            "the same, gzip": Nginx(PASS.format(port=port, more="proxy_ignore_headers X-Accel-Buffering;"),
                                    "gzip on; gzip_types *; gzip_proxied any;"),
            "blocks of 64 KiB": BlockProxy(port, 1 << 16),
        }
        streams = {}
        for name, proxy in proxies.items():
            self.closed_at_end(proxy)
            base = f"http://127.0.0.1:{port if isinstance(proxy, BlockProxy) else proxy.port}/"
            key = json.loads(answer_of(base + "viewers", {"size": SIZE})[1])["viewer"]
            streams[name] = self.closed_at_end(Stream(proxy.port, f"/stream?viewer={key}",
                                                      "gzip" if "gzip" in name else "identity")), key
            answer_of(base + f"steer?viewer={key}", {"turn": [0.2, 0.05]})
            self.wait_for_rest(base, key)
        time.sleep(READ_TIMEOUT_S + 2)  # also longer than a proxy waits for bytes
        for name, (stream, key) in streams.items():
            with self.subTest(name):
                images, ended = stream.images(), stream.ended
                direct = self.closed_at_end(Stream(port, f"/stream?viewer={key}"))
                deadline = time.monotonic() + 30
                while not direct.images() and time.monotonic() < deadline:
                    time.sleep(0.02)
                self.assertTrue(images, stream.received[:200])
                self.assertEqual(without_comments(images[-1]), direct.images()[0])
                self.assertFalse(ended, "the stream ended while nothing moved")

    def test_a_browser_sees_the_last_image_through_nginx(self):  # 2026-11-25
        server = self.serve("--port", 0)
        port = int(server.url.split(":")[2].strip("/"))
        # The host as the browser sends it, so that it equals the page's Origin.
        nginx = self.closed_at_end(Nginx(PASS.format(port=port, more="proxy_set_header Host $http_host;")))
        page = chromium.open_page(self, f"http://127.0.0.1:{nginx.port}/", SIZE)
        page.wait_for("typeof shownState !== 'undefined' && shownState && shownState.resting")
        page.drag((100, 100), (180, 90))
        page.evaluate("document.getElementById('bar').style.visibility = 'hidden'")
        deadline, difference = time.monotonic() + 60, 255
        while difference >= 4 and time.monotonic() < deadline:
            page.wait_for("shownState.resting && shownState.frame.full && !Object.keys(pending).length")
            time.sleep(0.3)
            expected = self.rendered(page.evaluate("shownState"))
            difference = numpy.abs(read_png(page.screenshot())[..., :3] - expected).mean()
        self.assertLess(difference, 4)

    def rendered(self, state):
        path = self.root / "rendered.png"
        camera = ["--eye=" + ",".join(map(repr, state["eye"])), "--target=" + ",".join(map(repr, state["target"]))]
        GIGABAKE.succeed("render", self.scene, "-o", path, "--size", "{}x{}".format(*state["size"]), *camera)
        return read_png(path)[..., :3]


if __name__ == "__main__":
    GIGABAKE = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
