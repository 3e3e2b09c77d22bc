#!/usr/bin/env python3
"""Tests `gigabake status` for a bake that ended, runs, was interrupted or has an invalid status; progress and metrics.

Usage: status_test.py GIGABAKE SOURCE_DIR
"""
import json
import os
import random
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

SQUARE = [[0, 0, 0], [40, 0, 0], [40, 0, -40], [0, 0, -40]]
TWO = [0, 1, 2, 0, 2, 3]
COMPLETE, FAILED, CELLS_FAILED, DRAINED = 0, 1, 3, 75


class Status(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.source = cls.root / "source"
        cls.source.mkdir()
        harness.write_glb(cls.source / "good.glb", SQUARE, TWO)
        cls.out, cls.metrics = cls.root / "out", cls.root / "bake.prom"
        cls.bake = PROGRAM.run("bake", cls.source, "-o", cls.out, "--voxel-size", 0.5, "--cell-voxels", 16, "--json",
                               "--metrics", cls.metrics, ranks=2)
        assert cls.bake.returncode == 0, cls.bake.stderr
        cls.status = json.loads((cls.out / "status.json").read_text())

    def folder_with(self, **changes):
        """Returns a SCENE whose status is the finished bake's status with changes."""
        out = Path(tempfile.mkdtemp(dir=self.root))
        status = {**self.status, "updated_s": time.time(), **changes}
        (out / "status.json").write_text(json.dumps(status))
        return out

    def ended_process(self):
        process = subprocess.Popen(["true"])
        process.wait()
        return process.pid

    def show(self, out, *arguments):
        return PROGRAM.run("status", out, *arguments)

    def expect_one_line(self, result, *told):
        self.assertEqual(result.returncode, FAILED, result)
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        for text in told:
            self.assertIn(text, lines[0])

    # a completed bake

    def test_a_finished_bake_adds_up(self):
        result = self.show(self.out, "--json")
        self.assertEqual(result.returncode, COMPLETE)
        status, report = json.loads(result.stdout), json.loads(self.bake.stdout)
        self.assertEqual((status["state"], status["interrupted"]), ("complete", False))
        cells = status["cells"]
        self.assertEqual(cells["planned"], report["cells_planned"])
        self.assertEqual(cells["done"] + cells["empty"] + cells["taken_over"], report["cells_planned"])
        self.assertEqual((cells["pending"], cells["running"], status["left_s"]), (0, 0, 0))
        self.assertEqual((status["voxels"], status["bytes"]), (report["voxels"], report["bytes"]))
        self.assertEqual(status["ranks"], 2)
        self.assertAlmostEqual(status["stage_seconds"]["write"], report["seconds"]["write"], places=6)
        self.assertEqual([c["name"] for c in status["slowest_cells"]], [c["name"] for c in report["slowest_cells"]])

    def test_a_person_reads_the_same(self):
        text = self.show(self.out).stdout
        self.assertIn(f"{self.status['cells']['planned']} of {self.status['cells']['planned']}", text)
        self.assertIn(self.status["slowest_cells"][0]["name"], text)

    def test_a_log_gets_few_lines_and_the_last_one_says_that_all_is_done(self):
        lines = [line for line in self.bake.stderr.splitlines() if "cells, " in line]
        self.assertEqual(len(lines), 1, self.bake.stderr)
        planned = self.status["cells"]["planned"]
        self.assertRegex(lines[0], rf"^20\d\d-[0-9:T-]+Z rank 0: {planned}/{planned} cells, ")
        self.assertNotIn("\r", self.bake.stderr)

    def test_metrics_are_the_status(self):
        lines = self.metrics.read_text().splitlines()
        samples = dict(line.rsplit(" ", 1) for line in lines if not line.startswith("#"))
        bake = f'bake="{self.out.resolve()}"'
        self.assertEqual(int(samples[f'gigabake_cells{{{bake},state="done"}}']), self.status["cells"]["done"])
        self.assertEqual(int(samples[f"gigabake_voxels_written_total{{{bake}}}"]), self.status["voxels"])
        self.assertEqual(samples[f'gigabake_state{{{bake},state="complete"}}'], "1")

    def test_a_loss_is_named_and_changes_the_exit_code(self):
        source, out = self.root / "lossy", self.root / "lossy-out"
        source.mkdir()
        harness.write_glb(source / "good.glb", SQUARE, TWO)
        (source / "bad.glb").write_bytes(b"glTF")
        self.assertEqual(PROGRAM.run("bake", source, "-o", out, "--voxel-size", 0.5).returncode, CELLS_FAILED)
        for arguments in ((), ("--follow",)):
            result = self.show(out, *arguments)
            self.assertEqual(result.returncode, CELLS_FAILED)
            self.assertIn("missing  1\n", result.stdout)
            self.assertIn("bad.glb", result.stdout)

    def test_a_bake_that_fails_says_why_and_one_that_never_began_says_nothing(self):
        source, out = self.root / "hopeless", self.root / "hopeless-out"
        source.mkdir()
        (source / "bad.glb").write_bytes(b"glTF")
        self.assertEqual(PROGRAM.run("bake", source, "-o", out, "--voxel-size", 0.5).returncode, FAILED)
        result = self.show(out)
        self.assertEqual(result.returncode, FAILED)
        self.assertIn("failed", result.stdout)
        self.assertIn("bad.glb", result.stdout)
        never = self.root / "never"
        self.assertEqual(PROGRAM.run("bake", self.root / "absent", "-o", never, "--voxel-size", 0.5).returncode, FAILED)
        self.assertFalse(never.exists())

    def test_exit_codes_are_those_of_the_bake(self):
        for state, code in (("complete", COMPLETE), ("incomplete", CELLS_FAILED), ("drained", DRAINED),
                            ("failed", FAILED), ("baking", 0)):
            result = self.show(self.folder_with(state=state, pid=os.getpid()))
            self.assertEqual(result.returncode, code, result)
            if state != "baking":
                self.assertEqual(self.show(self.folder_with(state=state), "--follow").returncode, code)

    # a bake that still runs, or not

    def test_a_silent_bake_whose_process_is_gone_was_interrupted(self):
        gone = self.folder_with(state="baking", updated_s=time.time() - 60, pid=self.ended_process())
        for arguments in ((), ("--follow",)):
            result = self.show(gone, *arguments)
            self.assertEqual(result.returncode, FAILED, result)
            self.assertIn("interrupted", result.stdout)
            self.assertIn("same command again", result.stdout)
        self.assertTrue(json.loads(self.show(gone, "--json").stdout)["interrupted"])

    def test_a_process_that_is_gone_is_seen_at_once(self):
        """Fixed 2026-11-22: after a second Ctrl-C, status reported the bake as running for another 15 s."""
        gone = self.folder_with(state="baking", pid=self.ended_process(), host=socket.gethostname())
        result = self.show(gone)
        self.assertEqual(result.returncode, FAILED, result)
        self.assertIn("interrupted while baking", result.stdout)
        self.assertNotIn("baking: for", result.stdout)
        self.assertNotIn("left", result.stdout)

    def test_a_silent_bake_whose_process_is_there_goes_on(self):
        busy = self.folder_with(state="baking", updated_s=time.time() - 60, pid=os.getpid(), host=socket.gethostname())
        result = self.show(busy)
        self.assertEqual(result.returncode, 0, result)
        self.assertNotIn("interrupted", result.stdout)

    def test_a_silent_bake_of_another_host_was_interrupted(self):
        there = self.folder_with(state="baking", updated_s=time.time() - 60, pid=os.getpid(), host="elsewhere")
        self.assertEqual(self.show(there).returncode, FAILED)

    def test_follow_says_a_line_a_second_until_the_bake_ends(self):
        out = self.folder_with(state="baking", pid=os.getpid(), cells={**self.status["cells"], "pending": 5, "done": 0})

        def end():
            time.sleep(2.5)
            final = {**self.status, "state": "drained", "updated_s": time.time()}
            (out / "next").write_text(json.dumps(final))
            os.replace(out / "next", out / "status.json")

        thread = threading.Thread(target=end)
        thread.start()
        result = self.show(out, "--follow", "--json")
        thread.join()
        self.assertEqual(result.returncode, DRAINED)
        states = [json.loads(line)["state"] for line in result.stdout.splitlines()]
        self.assertEqual(states[-1], "drained")
        self.assertTrue(3 <= len(states) <= 5 and set(states[:-1]) == {"baking"}, states)

    # invalid status files

    def test_no_status_is_one_line(self):
        self.expect_one_line(self.show(self.root / "nowhere"), "nowhere", "no such file")
        self.expect_one_line(self.show(self.source, "--follow"), "status.json")

    def test_hostile_bytes_are_one_line(self):
        out = self.folder_with()
        good = json.dumps(self.status).encode()
        for content in (b"", b"\0" * 1000, b"[" * 200000, b'{"a":' * 200000, good[:-1], b"\xff\xfe" + good, b"{}",
                        good.replace(b'"pid": ', b'"pid": -'), good.replace(b'"state": "complete"', b'"state": 7')):
            (out / "status.json").write_bytes(content)
            self.expect_one_line(self.show(out), "status.json")
            self.expect_one_line(self.show(out, "--follow", "--json"), "status.json")

    def test_any_flipped_byte_is_one_line_or_a_status(self):
        out, good = self.folder_with(), json.dumps(self.status).encode()
        dice = random.Random(17)
        for _ in range(60):
            bad = bytearray(good)
            bad[dice.randrange(len(bad))] ^= 1 << dice.randrange(8)
            (out / "status.json").write_bytes(bad)
            result = self.show(out)
            self.assertIn(result.returncode, (COMPLETE, FAILED), bad)
            self.assertLessEqual(len(result.stderr.splitlines()), 1)

    def test_a_terminal_is_not_told_what_to_do(self):
        failure = {"name": "\x1b[2J", "line": "a\nb"}
        out = self.folder_with(state="failed", reason="\x1b]0;title\x07", first_failures=[failure], failures=1)
        text = self.show(out).stdout
        self.assertNotIn("\x1b", text)
        self.assertIn("a?b", text)

    def test_a_status_that_cannot_be_written_costs_one_line_and_not_the_bake(self):
        out = self.root / "no-metrics"
        nowhere = self.root / "no" / "folder.prom"
        result = PROGRAM.run("bake", self.source, "-o", out, "--voxel-size", 0.5, "--metrics", nowhere)
        self.assertEqual(result.returncode, COMPLETE, result.stderr)
        self.assertEqual(result.stderr.count("without its status"), 1)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
