#!/usr/bin/env python3
"""cluster/gigabake.sbatch on a real Slurm of three nodes on this machine: it bakes, outlives a node's daemon, sweeps.

Usage: slurm_test.py GIGABAKE SOURCE_DIR

Skipped without root and without Slurm (tools/install-packages cluster).
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

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness
import namespaces

SKIPPED = 77
TOOL = Path(__file__).resolve().parent / "slurm_nodes.sh"
CONFIGURATION = Path("/run/slurm/slurm.conf")  # /run is private to the test, and ends with Slurm's daemons


def why_not():
    missing = [name for name in ("slurmctld", "slurmd", "munged", "sbatch") if shutil.which(name) is None]
    return f"{', '.join(missing)} not installed" if missing else namespaces.why_not()


class Slurm(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.environment = {**os.environ, **harness.MPI_ENVIRONMENT, "SLURM_CONF": str(CONFIGURATION),
                           "GIGABAKE": str(PROGRAM.executable),
                           "OMPI_MCA_btl_tcp_if_include": "lo", "OMPI_MCA_oob_tcp_if_include": "lo"}
        del cls.environment["OMPI_MCA_plm_rsh_agent"]  # Slurm starts the ranks
        # Slurm's daemons run longer than the script, so they must not keep a pipe open.
        subprocess.run(["bash", TOOL, "3"], env=cls.environment, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, timeout=60, check=True)
        PROGRAM.succeed("sample", cls.root / "sample", "--size", 128, "--seed", 5)
        cls.source = cls.root / "sample/tileset.json"
        cls.alone = PROGRAM.bake(cls.source, cls.root / "alone", 0.16, "--cell-voxels", 128)

    def run_tool(self, *command):
        result = harness.run(command, 30, env=self.environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def submit(self, out, voxel_size, *options, cell_voxels=128, threads=0):
        """Submits a bake. Returns the number of the job."""
        return self.run_tool("sbatch", "--parsable", "--nodes", 3, "--ntasks-per-node", 1, "-o",
                             self.root / "job.%A.%a.log", *options, SOURCE / "cluster/gigabake.sbatch", "bake",
                             self.source, "-o", out, "--voxel-size", voxel_size, "--cell-voxels",
                             cell_voxels, "--threads", threads, "--stall", 300).strip()

    def field(self, job, name):
        text = self.run_tool("scontrol", "show", "job", job)
        return text.split(f" {name}=" if f" {name}=" in text else f"{name}=")[1].split()[0]

    def wait_until(self, condition, what, limit_s=180, pause_s=0.2):
        end = time.monotonic() + limit_s
        while not condition():
            self.assertLess(time.monotonic(), end, f"{what}\n{self.logs()}")
            time.sleep(pause_s)

    def logs(self):
        return "".join(path.read_text() for path in self.root.glob("job.*.log"))

    def finish(self, job, limit_s=180):
        ended = ("COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL")
        self.wait_until(lambda: self.field(job, "JobState") in ended, "the job does not end", limit_s)
        self.assertEqual(self.field(job, "JobState"), "COMPLETED", self.logs())

    def processes(self, job, name):
        """Yields the processes with that name on the nodes of a job."""
        for path in Path("/proc").glob("[0-9]*/environ"):
            try:
                if (path.parent / "comm").read_text().strip() != name:
                    continue
                words = path.read_bytes().split(b"\0")
            except OSError:
                continue
            if f"SLURM_JOB_ID={job}".encode() in words:
                yield int(path.parent.name)

    def signal(self, job, name, number):
        """Returns the number of processes that received the signal."""
        count = 0
        for pid in self.processes(job, name):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, number)
                count += 1
        return count

    def wait_for_cells(self, out):
        self.wait_until(lambda: len(list(out.glob("shards/c_*.h5"))) > 2, "no cell is baked", pause_s=0.02)

    def status(self, out):
        return json.loads((out / "status.json").read_text())

    def test_three_nodes_bake_what_one_does(self):
        out = self.root / "three"
        self.finish(self.submit(out, 0.16))
        self.assertEqual((self.status(out)["state"], self.status(out)["ranks"]), ("complete", 3))
        self.assertEqual(PROGRAM.info(out / "scene.xml")["content_hash"], self.alone["content_hash"])

    def test_a_dead_node_requeues_the_job_and_it_ends_whole(self):
        out = self.root / "dead"
        job = self.submit(out, 0.16)
        self.wait_for_cells(out)
        os.kill(next(self.processes(job, "orted")), signal.SIGKILL)
        self.finish(job)
        self.assertEqual(self.field(job, "Restarts"), "1", self.logs())
        self.assertIn("the launch died", self.logs())
        PROGRAM.succeed("verify", out / "scene.xml")
        self.assertEqual(PROGRAM.info(out / "scene.xml")["content_hash"], self.alone["content_hash"])

    def test_a_job_that_nears_its_time_limit_drains_and_goes_on_in_the_next(self):
        out = self.root / "limited"
        job = self.submit(out, 0.16, "--time", "1", "--signal", "B:USR1@55", cell_voxels=64, threads=1)
        self.wait_for_cells(out)
        restarts = self.field(job, "Restarts")  # after a slow start, the time limit may already have caused one
        # Slurm checks time limits only twice a minute. Stopped cells save minutes of work until then.
        self.assertGreater(self.signal(job, "gigabake-bake", signal.SIGSTOP), 0, self.logs())
        self.wait_until(lambda: self.status(out)["state"] == "draining", "the bake does not learn the limit")
        self.signal(job, "gigabake-bake", signal.SIGCONT)
        self.wait_until(lambda: self.field(job, "Restarts") != restarts, "the job is not requeued")
        self.assertIn(self.status(out)["state"], ("drained", "baking", "surveying"), self.logs())
        self.assertIn("drained", self.logs())
        # After this interruption, the rest is baked without a time limit.
        self.run_tool("scontrol", "update", f"job={job}", "TimeLimit=30")
        self.finish(job)
        PROGRAM.succeed("verify", out / "scene.xml")
        # Levels 0 and 1 exist, and are equal, for all cell sizes.
        self.assertEqual(harness.lod_hashes(PROGRAM.info(out / "scene.xml"), 2), harness.lod_hashes(self.alone, 2))

    def test_the_example_sweeps_the_voxel_size(self):
        job = self.run_tool("bash", SOURCE / "examples/slurm_sweep.sh", self.source, self.root / "sweep", 400, 800,
                            "--", "--nodes", 3, "--ntasks-per-node", 1, "-o", self.root / "job.%A.%a.log")
        sizes = {}
        for task in (400, 800):
            self.wait_until((self.root / f"sweep/{task}/scene.xml").exists, f"task {task} of {job} does not end")
            sizes[task] = PROGRAM.info(self.root / f"sweep/{task}/scene.xml")["voxels"]
        self.assertGreater(sizes[400], 2 * sizes[800])


if __name__ == "__main__":
    if reason := why_not():
        print(f"skipped: {reason}")
        sys.exit(SKIPPED)
    namespaces.enter()
    PROGRAM, SOURCE = harness.Gigabake(str(Path(sys.argv[1]).resolve())), Path(sys.argv[2]).resolve()
    harness.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
