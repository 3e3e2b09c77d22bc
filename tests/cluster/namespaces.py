"""Linux namespaces of a test: two runs on one machine share no ports, interfaces and names of network namespaces."""
import os
import subprocess
import sys

ENTERED = "GIGABAKE_TEST_NAMESPACES"
UNSHARE = ("unshare", "--mount", "--net", "--pid", "--fork", "--kill-child", "--mount-proc")
# The interface pair has an address because no host name is resolved where only the loopback interface has one. /run is
# private because ip keeps the names of network namespaces there, and munged its socket.
PREPARE = """set -e
ip link set lo up
ip link add local type veth peer name local_peer
ip address add 10.78.0.1/24 dev local
ip link set local up
ip link set local_peer up
mount -t tmpfs tmpfs /run
exec "$@"
"""


def why_not():
    """Returns why this machine has no such namespaces, or None."""
    if os.geteuid() != 0:
        return "only root may make namespaces"
    if ENTERED in os.environ:
        return None
    try:
        probe = subprocess.run([*UNSHARE, "sh", "-c", PREPARE, "sh", "true"],
                               capture_output=True, text=True, check=False)
    except OSError as error:
        return str(error)
    return f"no namespaces: {probe.stderr.strip()}" if probe.returncode != 0 else None


def enter():
    """Starts this program again in new namespaces, whose processes all end with it."""
    if ENTERED not in os.environ:
        os.environ[ENTERED] = "1"
        os.execvp(UNSHARE[0], [*UNSHARE, "sh", "-c", PREPARE, "sh", sys.executable, *sys.argv])
