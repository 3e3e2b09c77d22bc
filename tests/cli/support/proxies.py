"""Reverse proxies for tests: a real nginx with its own folder and port, and a proxy that buffers replies in blocks."""
import os
import shutil
import socket
import subprocess
import tempfile
import threading
import time
from pathlib import Path

NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin:/usr/local/sbin")

CONFIGURATION = """
daemon off;
master_process off;
{user}
pid {folder}/nginx.pid;
error_log {folder}/error.log;
events {{}}
http {{
  access_log off;
  client_body_temp_path {folder}/body;
  proxy_temp_path {folder}/proxy;
  fastcgi_temp_path {folder}/fastcgi;
  uwsgi_temp_path {folder}/uwsgi;
  scgi_temp_path {folder}/scgi;
  {http}
  server {{
    listen 127.0.0.1:{port};
    {server}
  }}
}}
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Nginx:
    """An nginx on a loopback port, until close(). http, server: lines of its configuration."""

    def __init__(self, server, http=""):
        self.folder = tempfile.TemporaryDirectory()
        self.port = free_port()
        configuration = Path(self.folder.name) / "nginx.conf"
        user = "user root;" if os.geteuid() == 0 else ""
        configuration.write_text(CONFIGURATION.format(folder=self.folder.name, port=self.port, server=server, http=http,
                                                      user=user))
        self.process = subprocess.Popen([NGINX, "-p", self.folder.name, "-c", configuration],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.wait_until_it_listens()

    def wait_until_it_listens(self):
        deadline = time.monotonic() + 30
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                socket.create_connection(("127.0.0.1", self.port), 1).close()
                return
            except OSError:
                time.sleep(0.02)
        self.process.kill()
        raise AssertionError(f"nginx does not start: {self.process.communicate()[1].decode()}")

    def close(self):
        self.process.terminate()
        self.process.communicate()
        self.folder.cleanup()


class BlockProxy:
    """A proxy that forwards requests unchanged, and replies only in whole blocks until the server closes."""

    def __init__(self, server_port, block_bytes):
        self.server_port, self.block_bytes = server_port, block_bytes
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.port = self.listening.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                client, _ = self.listening.accept()
            except OSError:  # closed
                return
            threading.Thread(target=self.relay, args=(client,), daemon=True).start()

    def relay(self, client):
        try:
            with client, socket.create_connection(("127.0.0.1", self.server_port)) as server:
                server.sendall(client.recv(1 << 16))
                held = b""
                while data := server.recv(1 << 16):
                    held += data
                    whole = len(held) - len(held) % self.block_bytes
                    client.sendall(held[:whole])
                    held = held[whole:]
                client.sendall(held)
        except OSError:  # one side has closed the connection
            pass

    def close(self):
        self.listening.close()
