#!/usr/bin/env python3
"""Tests cluster/gigabake-mpirun and cluster/gigabake.sbatch for every way in which a launch can end.

A simulated mpirun ends as the test specifies. The last tests launch the real mpirun.

Usage: launchers_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness  # noqa: E402  (lies in another folder)

# Each launch takes the next line of `ends`: an exit code, or one of these words.
# - "wait" waits for a signal and records its name. "talk" is a bake that updates its status often, "mute" only once.
# - "lonely" is an mpirun whose ranks have ended. A state is that of a bake that ends while mpirun still runs.
MPIRUN = """#!/usr/bin/env bash
cd "$(dirname "$0")"
printf '%s\\n' "$*" >>launches
while [ $# -gt 0 ]; do [ "$1" != --hostfile ] || { cat "$2" >>hosts_seen; echo -- >>hosts_seen; }; shift; done
end=$(sed -n "$(wc -l <launches)p" ends)
say() { printf '{"state":"%s","reason":""}\\n' "$1" >out/part; mv out/part out/status.json; }
hang() { sleep 20 >/dev/null 2>&1 & wait; }
case $end in
  wait) ;;
  early) echo >waits; while :; do sleep 0.05; done ;;
  lonely) trap '' TERM; exec -a mpirun bash -c 'trap "" TERM; read -r _ <>"$0"' lonely ;;
  complete | incomplete | drained | failed) say baking; sleep 0.2; say "$end"; hang ;;
  talk) for _ in 1 2 3 4 5 6; do say baking; sleep 0.9; done; exit 0 ;;
  mute) say baking; hang ;;
  *) exit "$end" ;;
esac
trap 'echo USR1 >>signals; [ -e stubborn ] || exit 75' USR1
trap 'echo TERM >>signals; exit 143' TERM
echo >waits
while :; do sleep 0.05; done
"""
SCONTROL = '#!/usr/bin/env bash\necho "$*" >>"$(dirname "$0")/requeues"\n'
RSH = '#!/usr/bin/env bash\n! grep -qx "$1" "$(dirname "$0")/dead" 2>/dev/null\n'


class Script(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        for name, text in (("mpirun", MPIRUN), ("scontrol", SCONTROL), ("rsh", RSH)):
            (self.root / name).write_text(text)
            (self.root / name).chmod(0o755)
        (self.root / "out").mkdir()
        os.mkfifo(self.root / "lonely")
        (self.root / "hostfile").write_text("# the rack\nnode1 slots=4\nnode2 slots=2\n\nnode3 slots=2\n")

    def tearDown(self):
        self.folder.cleanup()

    def ends(self, *ends):
        (self.root / "ends").write_text("".join(f"{end}\n" for end in ends))

    def environment(self, **more):
        return {**os.environ, "PATH": f"{self.root}:{os.environ['PATH']}", "GIGABAKE_PAUSE_S": "0",
                "GIGABAKE_RSH": str(self.root / "rsh"), **more}

    def start(self, script, *arguments, **more):
        return subprocess.Popen([SOURCE / "cluster" / script, *map(str, arguments)], env=self.environment(**more),
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def signalled(self, process, *signals):
        """Sends the signals, each once the launch waits. Returns the exit code."""
        for index, number in enumerate(signals):
            self.wait_for("signals" if index else "waits")
            process.send_signal(number)
        self.errors = harness.errors_of(process, 20)
        return process.returncode

    def wait_for(self, name):
        end = time.monotonic() + 20
        while not (self.root / name).exists():
            self.assertLess(time.monotonic(), end, f"no {name}")
            time.sleep(0.02)

    def expect_no_hang(self, run, ends, relaunched):
        """Runs launches that hang. `run` starts one that bakes into self.root / "out", and returns its exit code.

        Regression of 2026-11-22.
        """
        reasons = {"mute": "no status update of the bake for 5 s", "lonely": "every rank has ended, but mpirun has not"}
        (self.root / "out/status.json").write_text('{"state":"complete"}')  # status of an earlier bake
        for end, code in ends:
            self.assertEqual(run(end, 0, arguments=("bake", "S", "-o", str(self.root / "out")), GIGABAKE_END_S="2",
                                 GIGABAKE_QUIET_S="5"), code, end)
            self.assertIn(reasons.get(end, "the bake has ended, but mpirun has not"), self.errors)
            self.assertEqual(len(self.lines("launches")), 2 if relaunched and end in reasons else 1, end)
            (self.root / "launches").unlink()

    def lines(self, name):
        path = self.root / name
        return path.read_text().splitlines() if path.exists() else []


class Mpirun(Script):
    def run_to_end(self, *ends, **more):
        self.ends(*ends)
        arguments = more.pop("arguments", ("bake", "S", "-o", "a b"))
        process = self.start("gigabake-mpirun", self.root / "hostfile", *arguments, **more)
        self.errors = harness.errors_of(process, 20)
        return process.returncode

    def test_gigabakes_own_codes_end_it(self):
        for code in (0, 1, 2, 3, 75):
            (self.root / "launches").unlink(missing_ok=True)
            self.assertEqual(self.run_to_end(code, 0), code)
            self.assertEqual(len(self.lines("launches")), 1, code)

    def test_a_launch_that_died_is_repeated(self):
        self.assertEqual(self.run_to_end(69, 205, 137, 1, 3), 3)
        self.assertEqual(len(self.lines("launches")), 5)
        self.assertIn("relaunch 4 of 5", self.errors)

    def test_but_not_for_ever(self):
        self.assertEqual(self.run_to_end(205, 205, 205, 0, GIGABAKE_RELAUNCHES="2"), 205)
        self.assertEqual(len(self.lines("launches")), 3)

    def test_hosts_that_do_not_answer_are_left_out_until_they_do(self):
        (self.root / "dead").write_text("node1\n")
        self.assertEqual(self.run_to_end(0), 0)
        self.assertEqual(self.lines("hosts_seen"), ["node2 slots=2", "node3 slots=2", "--"])
        self.assertIn("node1 does not respond", self.errors)
        (self.root / "dead").unlink()
        (self.root / "launches").unlink()
        self.assertEqual(self.run_to_end(0), 0)
        self.assertEqual(self.lines("hosts_seen")[3:], ["node1 slots=4", "node2 slots=2", "node3 slots=2", "--"])

    def test_no_host_at_all_is_no_launch(self):
        (self.root / "dead").write_text("node1\nnode2\nnode3\n")
        self.assertEqual(self.run_to_end(0), 1)
        self.assertEqual(self.lines("launches"), [])

    def test_arguments_and_options_arrive(self):
        self.assertEqual(self.run_to_end(0, GIGABAKE="/opt/gigabake", GIGABAKE_MPIRUN="-n 2"), 0)
        self.assertTrue(self.lines("launches")[0].endswith("-n 2 /opt/gigabake bake S -o a b"))
        self.assertIn("--bind-to none", self.lines("launches")[0])

    def test_a_signal_drains(self):
        for number in (signal.SIGUSR1, signal.SIGTERM, signal.SIGINT):
            for name in ("launches", "waits", "signals"):
                (self.root / name).unlink(missing_ok=True)
            self.ends("wait", 0)
            process = self.start("gigabake-mpirun", self.root / "hostfile", "bake", "S")
            self.assertEqual(self.signalled(process, number), 75, number)
            self.assertEqual(self.lines("signals"), ["USR1"])
            self.assertEqual(len(self.lines("launches")), 1)

    def test_a_second_term_ends_it_at_once(self):
        (self.root / "stubborn").touch()
        self.ends("wait", 0)
        process = self.start("gigabake-mpirun", self.root / "hostfile", "bake", "S")
        self.assertEqual(self.signalled(process, signal.SIGTERM, signal.SIGTERM), 75)
        self.assertEqual(self.lines("signals"), ["USR1", "TERM"])
        self.assertEqual(len(self.lines("launches")), 1)

    # Regression of 2026-11-22: mpirun hung after 2 of 50 ranks that died in their first second.
    def test_a_launch_that_hangs_is_killed_and_repeated_unless_its_bake_has_ended(self):
        self.expect_no_hang(self.run_to_end, [("incomplete", 3), ("mute", 0), ("lonely", 0)], relaunched=True)

    def test_a_launch_that_says_that_it_lives_is_left_alone(self):
        arguments = ("bake", "S", "--out=" + str(self.root / "out"))
        self.assertEqual(self.run_to_end("talk", arguments=arguments, GIGABAKE_QUIET_S="4"), 0)
        self.assertNotIn("killed", self.errors)

    def test_both_starters_end_a_hanging_launch_by_the_same_text(self):
        starters = [SOURCE / "cluster" / name for name in ("gigabake-mpirun", "gigabake.sbatch")]
        texts = [starter.read_text().split("\n# ---") for starter in starters]
        self.assertEqual(*[[part for part in text if part.startswith(" what ends a launch")] for text in texts])

    def test_wrong_usage_is_explained(self):
        for arguments in ((), (self.root / "absent", "bake")):
            process = self.start("gigabake-mpirun", *arguments)
            errors = harness.errors_of(process, 20)
            self.assertEqual(process.returncode, 2)
            self.assertTrue(errors)


class Sbatch(Script):
    def begin(self, *ends, arguments=("bake", "S"), **more):
        self.ends(*ends)
        return self.start("gigabake.sbatch", *arguments, SLURM_JOB_ID="17", **more)

    def run_to_end(self, *ends, **more):
        process = self.begin(*ends, **more)
        self.errors = harness.errors_of(process, 20)
        return process.returncode

    def test_what_is_final_is_not_requeued(self):
        for code in (0, 1, 2, 3):
            self.assertEqual(self.run_to_end(code), code)
            (self.root / "launches").unlink()
        self.assertEqual(self.lines("requeues"), [])

    def test_what_died_is_requeued(self):
        self.assertEqual(self.run_to_end(205), 205)
        self.assertEqual(self.run_to_end(205, 1, SLURM_RESTART_COUNT="1"), 1)
        self.assertEqual(self.lines("requeues"), ["requeue 17"] * 2)

    def test_but_not_for_ever(self):
        self.assertEqual(self.run_to_end(205, SLURM_RESTART_COUNT="3", GIGABAKE_REQUEUES="3"), 205)
        self.assertEqual(self.lines("requeues"), [])
        self.assertIn("given up", self.errors)

    def test_the_time_limit_drains_and_requeues_however_often(self):
        process = self.begin("wait", SLURM_RESTART_COUNT="100")
        self.assertEqual(self.signalled(process, signal.SIGUSR1), 75)
        self.assertEqual((self.lines("signals"), self.lines("requeues")), (["USR1"], ["requeue 17"]))

    def test_a_launch_that_dies_of_the_request_is_drained(self):
        """mpirun that has not finished its start dies of USR1. Until 2026-11-26 this counted as a dead launch."""
        process = self.begin("early", SLURM_RESTART_COUNT="100")
        self.assertEqual(self.signalled(process, signal.SIGUSR1), 128 + signal.SIGUSR1)
        self.assertEqual(self.lines("requeues"), ["requeue 17"])
        (self.root / "waits").unlink()
        self.assertEqual(self.signalled(self.begin("early", "early"), signal.SIGTERM), 75)
        self.assertEqual(self.lines("requeues"), ["requeue 17"])

    def test_term_drains_and_does_not_requeue(self):
        self.assertEqual(self.signalled(self.begin("wait"), signal.SIGTERM), 75)
        self.assertEqual((self.lines("signals"), self.lines("requeues")), (["USR1"], []))

    def test_a_task_of_an_array_finds_its_number_in_the_arguments(self):
        self.assertEqual(self.run_to_end(0, arguments=("bake", "-o", "out/%a"), SLURM_ARRAY_TASK_ID="3"), 0)
        self.assertTrue(self.lines("launches")[0].endswith("gigabake bake -o out/3"))

    def test_a_launch_that_hangs_is_killed_and_requeued_unless_its_bake_has_ended(self):
        self.expect_no_hang(self.run_to_end, [("complete", 0), ("mute", 124)], relaunched=False)
        self.assertEqual(len(self.lines("requeues")), 1)

    def test_outside_of_slurm_it_says_how_to_start_it(self):
        process = self.start("gigabake.sbatch", "bake")
        errors = harness.errors_of(process, 20)
        self.assertEqual(process.returncode, 2)
        self.assertIn("sbatch", errors)


class Real(unittest.TestCase):
    """Launches with the real mpirun of Open MPI."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        harness.write_glb(self.root / "s.glb", [[0, 0, 0], [40, 0, 0], [40, 0, -40], [0, 0, -40]], [0, 1, 2, 0, 2, 3])
        self.arguments = ["bake", self.root / "s.glb", "-o", self.root / "out", "--voxel-size", "0.5", "--json"]

    def tearDown(self):
        self.folder.cleanup()

    def run_script(self, *command, **more):
        environment = {**os.environ, **harness.MPI_ENVIRONMENT, "GIGABAKE": str(PROGRAM), **more}
        return harness.run([SOURCE / "cluster" / command[0], *command[1:]], 300, env=environment)

    def test_a_hostfile_of_this_host_bakes(self):
        (self.root / "hosts").write_text("localhost slots=3\n")
        result = self.run_script("gigabake-mpirun", self.root / "hosts", *self.arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["ranks"], 3)

    def test_gigabakes_exit_code_comes_through_mpirun(self):
        (self.root / "hosts").write_text("localhost slots=2\n")
        (self.root / "bad").mkdir()
        (self.root / "bad/s.glb").write_bytes((self.root / "s.glb").read_bytes())
        (self.root / "bad/t.glb").write_bytes(b"glTF")
        self.arguments[1] = self.root / "bad"
        self.assertEqual(self.run_script("gigabake-mpirun", self.root / "hosts", *self.arguments).returncode, 3)
        self.arguments[1] = self.root / "absent"
        self.assertEqual(self.run_script("gigabake-mpirun", self.root / "hosts", *self.arguments).returncode, 1)

    def test_without_a_launcher_no_daemon_is_started_beside_it(self):
        """Open MPI would search PATH for its orted, and fail without it."""
        environment = {**os.environ, **harness.MPI_ENVIRONMENT, "PATH": str(self.root / "nothing")}
        result = harness.run([PROGRAM, *self.arguments], 300, env=environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["ranks"], 1)

    def test_without_a_launcher_open_mpi_makes_no_folder(self):
        """Regression of 2026-11-23: all such processes shared a folder below /tmp, which the first to end removed."""
        file = self.root / "file"
        file.write_text("no folder can be made here")
        environment = {**os.environ, **harness.MPI_ENVIRONMENT, "TMPDIR": str(file),
                       "OMPI_MCA_orte_tmpdir_base": str(file)}
        result = harness.run([PROGRAM, "plan", self.root / "s.glb", "--voxel-size", 1, "--no-measure"], 300,
                             env=environment)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_batch_script_bakes(self):
        result = self.run_script("gigabake.sbatch", *self.arguments, SLURM_JOB_ID="1", GIGABAKE_MPIRUN="-n 2",
                                 OMPI_MCA_ras="^slurm", OMPI_MCA_plm="^slurm", OMPI_MCA_ess="^slurm")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["ranks"], 2)


if __name__ == "__main__":
    PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    harness.main(argv=sys.argv[:1], verbosity=2)
