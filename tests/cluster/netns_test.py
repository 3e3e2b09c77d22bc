#!/usr/bin/env python3
"""Runs cluster/gigabake-mpirun on three "hosts", each a network namespace.

One host is disconnected during the bake, and the bake continues without it.

Usage: netns_test.py GIGABAKE SOURCE_DIR

Skipped without root, without iproute2 (tools/install-packages cluster) and without network namespaces.
"""
import json
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness
import namespaces

SKIPPED = 77
TOOL = Path(__file__).resolve().parent / "network_hosts.sh"
OPTIONS = ("--mca plm rsh --mca pml ob1 --mca btl self,vader,tcp --mca btl_tcp_if_include eth0 "
           "--mca oob_tcp_if_include eth0 --mca orte_keep_fqdn_hostnames 1")
# ip netns exec reaches a disconnected host; a real remote shell would not.
RSH = '#!/bin/bash\n! grep -qx "$1" "$(dirname "$0")/dead" || exit 255\nexec "$(dirname "$0")/network/rsh" "$@"\n'


class Hosts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "network").mkdir()
        subprocess.run(["bash", TOOL, "3", self.root / "network"], check=True, stdout=subprocess.DEVNULL)
        (self.root / "rsh").write_text(RSH)
        (self.root / "rsh").chmod(0o755)
        (self.root / "hosts").write_text("".join(f"10.77.0.{i} slots=1\n" for i in (1, 2, 3)))
        PROGRAM.succeed("sample", self.root / "sample", "--size", 128, "--seed", 5)
        self.source, self.out = self.root / "sample/tileset.json", self.root / "out"

    def launch(self, voxel_size):
        environment = {**os.environ, "GIGABAKE": str(PROGRAM.executable), "GIGABAKE_MPIRUN": OPTIONS,
                       "GIGABAKE_RSH": str(self.root / "rsh"), "GIGABAKE_PAUSE_S": "1"}
        command = ["ip", "netns", "exec", "nd1", "unshare", "--uts", "sh", "-c", 'hostname nd1; exec "$@"', "sh",
                   SOURCE / "cluster/gigabake-mpirun", self.root / "hosts", "bake", self.source, "-o", self.out,
                   "--voxel-size", voxel_size, "--cell-voxels", 128]
        with open(self.root / "log", "w", encoding="utf-8") as log:
            return subprocess.Popen(list(map(str, command)), env=environment, stdout=log, stderr=log)

    def cut_off(self, host):
        (self.root / "dead").write_text(f"10.77.0.{host}\n")
        subprocess.run(["ip", "link", "set", f"vh{host}", "down"], check=True)

    def test_a_host_that_is_cut_off_is_left_out_and_the_bake_ends_whole(self):
        process = self.launch(0.04)
        end = time.monotonic() + 60
        while len(list(self.out.glob("shards/c_*.h5"))) < 3:
            self.assertLess(time.monotonic(), end, (self.root / "log").read_text())
            time.sleep(0.05)
        self.cut_off(3)
        code = process.wait(timeout=180)
        log = (self.root / "log").read_text()
        self.assertEqual(code, 0, log)
        self.assertIn("10.77.0.3 does not respond", log)
        status = json.loads((self.out / "status.json").read_text())
        self.assertEqual((status["state"], status["ranks"]), ("complete", 2), log)
        PROGRAM.succeed("verify", self.out / "scene.xml")
        alone = PROGRAM.bake(self.source, self.root / "alone", 0.04, "--cell-voxels", 128)
        self.assertEqual(PROGRAM.info(self.out / "scene.xml")["content_hash"], alone["content_hash"])


if __name__ == "__main__":
    if reason := namespaces.why_not():
        print(f"skipped: {reason}")
        sys.exit(SKIPPED)
    namespaces.enter()
    PROGRAM, SOURCE = harness.Gigabake(str(Path(sys.argv[1]).resolve())), Path(sys.argv[2]).resolve()
    harness.main(argv=sys.argv[:1], verbosity=2)
