"""gigabake serve under test: started on a free port, queried over HTTP."""
import contextlib
import json
import threading
import time
import urllib.error
import urllib.request

import harness


def answer_of(url, body=None, headers=None):
    """Returns status and content. body: sent as JSON."""
    request = urllib.request.Request(url, headers=headers or {})
    if body is not None:
        request.data = json.dumps(body).encode()
        request.add_header("Content-Type", "application/json")
    try:
        with urllib.request.urlopen(request, timeout=120) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as failure:
        with failure:
            return failure.code, failure.read()


class Server:
    """A running gigabake serve, until close()."""

    def __init__(self, program, *arguments):
        self.process = harness.Started([program.executable, "serve", *arguments])
        self.url = ""
        while not self.url.startswith(("http://", "https://")) and self.process.poll() is None:
            time.sleep(0.02)
            lines = self.process.said().split("\n")[:-1]
            self.url = next((line for line in lines if line.startswith("http")), "")
        assert self.url, self.process.said()

    def close(self):
        self.process.end()

    @contextlib.contextmanager
    def heard_from(self, key):
        """Polls the server as a page does: a viewer that sends nothing for ten seconds counts as closed."""
        over = threading.Event()

        def ask():
            while not over.wait(1):
                self.ask(f"state?viewer={key}")

        asking = threading.Thread(target=ask)
        asking.start()
        try:
            yield
        finally:
            over.set()
            asking.join()

    def ask(self, path, body=None):
        return answer_of(self.url + path, body)
