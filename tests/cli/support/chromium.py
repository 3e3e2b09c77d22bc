"""A headless Chromium that a test steers through its debugging pipe; needs the browser and nothing else."""
import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

NAMES = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
           "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
           "--disable-dev-shm-usage", "--remote-debugging-pipe")
# WebGL 2 by software rendering.
WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
ANSWER_S = 120


def find():
    """Returns the path of the browser's program; None if no installed browser starts."""
    for name in NAMES:
        program = shutil.which(name)
        if not program:
            continue
        try:
            version = subprocess.run([program, "--version"], capture_output=True, timeout=60, check=False)
        except (OSError, subprocess.TimeoutExpired):
            continue
        if version.returncode == 0:  # Ubuntu's program only prints a message about a snap
            return program
    return None


class Page:
    """A page in a separate browser process."""

    def __init__(self, program, url, width, height, options=()):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # helpers write for a moment
        read_end, to_browser = os.pipe()
        from_browser, write_end = os.pipe()
        # The browser reads commands from descriptor 3 and writes answers to 4.
        wrapper = f'exec "$@" 3<&{read_end} 4>&{write_end}'
        command = ["bash", "-c", wrapper, "bash", program, *OPTIONS, *options, f"--user-data-dir={self.profile.name}"]
        self.process = subprocess.Popen(command, pass_fds=(read_end, write_end), stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        os.close(read_end)
        os.close(write_end)
        self.to_browser, self.from_browser = to_browser, from_browser
        self.buffer, self.number, self.session = b"", 0, None
        target = self.command("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.command("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.command("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                     mobile=False)
        self.command("Page.enable")
        self.command("Page.navigate", url=url)

    def close(self):
        self.process.terminate()
        self.process.wait()
        os.close(self.to_browser)
        os.close(self.from_browser)
        self.profile.cleanup()

    def command(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to_browser, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + ANSWER_S
        while True:
            answer = self._receive(deadline)
            if answer.get("id") == self.number:
                assert "error" not in answer, (method, answer)
                return answer["result"]

    def _receive(self, deadline):
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.from_browser], [], [], max(0, deadline - time.monotonic()))
            data = os.read(self.from_browser, 1 << 20) if ready else b""
            assert data, "the browser does not answer"
            self.buffer += data
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def evaluate(self, expression):
        result = self.command("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in result, (expression, result)
        return result["result"].get("value")

    def wait_for(self, expression, seconds=ANSWER_S):
        deadline = time.monotonic() + seconds
        while not self.evaluate(expression):
            assert time.monotonic() < deadline, f"never came true: {expression}"
            time.sleep(0.05)

    def mouse(self, kind, x, y, **more):
        self.command("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, start, end, button="left"):
        buttons = {"left": 1, "right": 2}[button]
        self.mouse("mousePressed", *start, button=button, buttons=buttons, clickCount=1)
        for step in range(1, 6):
            x, y = (start[k] + (end[k] - start[k]) * step / 5 for k in (0, 1))
            self.mouse("mouseMoved", x, y, button=button, buttons=buttons)
        self.mouse("mouseReleased", *end, button=button, clickCount=1)

    def key(self, code, seconds=0.0, shift=False):
        """Presses the key of a code such as "KeyW", and holds it."""
        letter = code.removeprefix("Key")
        key = {"code": code, "key": letter.lower(), "windowsVirtualKeyCode": ord(letter[0]),
               "modifiers": 8 if shift else 0}
        self.command("Input.dispatchKeyEvent", type="keyDown", **key)
        time.sleep(seconds)
        self.command("Input.dispatchKeyEvent", type="keyUp", **key)

    def be_phone(self, width, height):
        """Emulates a phone with two screen pixels per CSS pixel, in portrait or landscape orientation."""
        upright = height > width
        self.command("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=2, mobile=True,
                     screenOrientation={"type": "portraitPrimary" if upright else "landscapePrimary",
                                        "angle": 0 if upright else 90})
        self.command("Emulation.setTouchEmulationEnabled", enabled=True)

    def swipe(self, start, end):
        """Swipes with one finger."""
        for kind, points in (("touchStart", [start]), ("touchMove", [end]), ("touchEnd", [])):
            self.command("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in points])

    def screenshot(self):
        return base64.b64decode(self.command("Page.captureScreenshot", format="png")["data"])


def open_page(test, url, size):
    """Returns a page that closes at the end of the test. Skips the test if no browser starts."""
    program = find()
    if program is None:
        test.skipTest("there is no Chromium that starts (Debian: apt install chromium)")
    page = Page(program, url, *size)
    test.addCleanup(page.close)
    return page
