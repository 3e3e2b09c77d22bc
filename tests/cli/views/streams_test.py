#!/usr/bin/env python3
"""Runs every command with standard output and standard error on a full disk, closed, or read by an exiting process.

Usage: streams_test.py GIGABAKE SOURCE_DIR

If a message cannot be written, the command drops it and does its work. If an answer cannot be written, the command
prints one line and exits with code 1.
"""
import re
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

FULL = "/dev/full"
SHELL = "/bin/bash"


class Streams(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.Gigabake(Path(sys.argv[1]).resolve())
        cls.source = cls.root / "terrain.glb"
        edge = 9
        corners = [[x, (x * y) % 3, y] for y in range(edge) for x in range(edge)]
        harness.write_glb(cls.source, corners, harness.squares_of_grid(edge))
        cls.out = cls.root / "baked"
        cls.program.bake(cls.source, cls.out, 0.5, "--cell-voxels", 8, "--backend", "cpu")
        cls.fresh = 0

    def setUp(self):
        self.environment = {**harness.MPI_ENVIRONMENT, "PATH": "/usr/bin:/bin"}

    def new(self, suffix=""):
        type(self).fresh += 1
        return self.root / f"new{self.fresh}{suffix}"

    def commands(self):
        """Returns a table: name to (arguments, True if the answer goes to standard output)."""
        bake = [self.source, "--voxel-size", "0.5", "--backend", "cpu", "--threads", "1"]
        return {
            "sample": (["--size", "64", "--tiles", "1", self.new()], True),
            "plan": ([*bake, "--no-measure"], True),
            "bake": ([*bake, "-o", self.new(), "--json"], True),
            "edit": ([self.out, "--list", "--json"], True),
            "status": ([self.out], True),
            "info": ([self.out], True),
            "verify": ([self.out], True),
            "diff": ([self.out, self.out], True),
            "export": ([self.out, "-o", self.new(".ply")], True),
            "render": ([self.out, "-o", self.new(".png"), "--size", "16x16", "--backend", "cpu"], True),
            "query": ([self.out, "--ray", "4,-4,50,0,0,-1"], True),
            "view": ([self.new()], False),  # needs a display; a missing scene causes only a message
            "serve": ([self.out, "--port", "0"], True),
            "completion": (["bash"], True),
            "man": (["bake"], True),
            "bench kernels": ([*bake[:3], "--repeats", "1"], True),
            "bench bake": ([*bake, "-o", self.new()], True),
            "bench schedule": (["--cells", "20"], True),
            "bench pack": ([self.out / "shards", "--repeats", "1"], True),
            "bench query": ([self.out, "--rays", "10"], True),
            "bench render": ([self.out, "--size", "16x16", "--what", "first-hits", "--repeats", "1",
                              "--backend", "cpu"], True),
            "bench edit": ([self.out, "--size", "32x32", "--distance", "20", "--brush", "4", "--repeats", "1",
                            "--backend", "cpu"], True),
            "bench accuracy": ([self.new()], False),
        }

    def run_with(self, words, redirections, ranks=None):
        """Runs a command under a shell, which can close streams that subprocess would open."""
        words = [str(self.program.executable), *map(str, words)]
        launcher = [] if ranks is None else ["mpirun", "-n", str(ranks)]
        line = " ".join(f"'{word}'" for word in words)
        inner = f"exec {line} {redirections}"
        return harness.run([*launcher, SHELL, "-c", inner], 100, env=self.environment)

    def listed(self, *words):
        help_text = self.program.succeed(*words, "--help")
        block = help_text.split("Subcommands:\n")[1].split("\n\n")[0]
        return [line.split()[0] for line in block.splitlines() if re.match(r"  [a-z]", line)]

    def test_every_command_is_here(self):
        listed = {name for name in self.listed() if name != "bench"}
        listed |= {f"bench {name}" for name in self.listed("bench")}
        self.assertEqual(listed, set(self.commands()))

    def words(self, name):
        arguments, answers = self.commands()[name]
        return [*name.split(), *arguments], answers

    # Regression of 2026-11-25: exit code 0 and no message.
    def test_an_answer_that_cannot_be_written_is_a_failure(self):
        for name in self.commands():
            for redirection, reason in ((f">{FULL}", "No space left on device"), (">&-", "Bad file descriptor")):
                with self.subTest(command=name, redirection=redirection):
                    words, answers = self.words(name)
                    result = self.run_with(words, redirection)
                    if not answers:
                        self.assertIn(result.returncode, (1, 2))
                        continue
                    self.assertEqual(result.returncode, 1, result.stderr)
                    line = f"gigabake: cannot write standard output: {reason}"
                    self.assertEqual(result.stderr.splitlines().count(line), 1, result.stderr)
                    self.assertNotIn("terminate", result.stderr)

    def test_help_and_version_are_answers_too(self):
        for words in (["--help"], ["--version"], ["bake", "--help"], ["bench", "query", "--help"]):
            self.assertEqual(self.run_with(words, f">{FULL}").returncode, 1, words)

    # Regression of 2026-11-25: SIGABRT, exit code 134.
    def test_a_message_that_cannot_be_written_is_dropped(self):
        for name in self.commands():
            # An invalid option ends the server with an error.
            words = lambda: self.words(name)[0] + (["--viewers", "0"] if name == "serve" else [])
            expected = self.run_with(words(), "").returncode
            for redirection in (f"2>{FULL}", "<&- 2>&-"):
                with self.subTest(command=name, redirection=redirection):
                    self.assertEqual(self.run_with(words(), redirection).returncode, expected)

    def test_both_at_once_end_in_order(self):
        for name in self.commands():
            for redirection in (f">{FULL} 2>{FULL}", "<&- >&- 2>&-"):
                with self.subTest(command=name, redirection=redirection):
                    self.assertIn(self.run_with(self.words(name)[0], redirection).returncode, (1, 2))

    def test_errors_keep_their_exit_code(self):
        for words, code in ((["bake", self.source], 2),
                            (["bake", self.source, "--voxel-size", "x", "-o", self.new()], 2),
                            (["bake", self.new(), "--voxel-size", "1", "-o", self.new()], 1), (["info", self.new()], 1),
                            (["nonsense"], 2), (["render", self.out, "-o", self.source / "x.png"], 1)):
            for redirection in (f"2>{FULL}", "2>&-"):
                self.assertEqual(self.run_with(words, redirection).returncode, code, words)

    def bake(self):
        return ["bake", self.source, "--voxel-size", "0.25", "--backend", "cpu", "--cell-voxels", "8", "-o", self.new()]

    def expect_same_voxels(self, words):
        whole = self.program.info(self.out_of(words) / "scene.xml")
        self.assertEqual(harness.lod_hashes(whole), self.right())

    def out_of(self, words):
        return Path(words[-1])

    def right(self):
        words = self.bake()
        self.program.succeed(*words)
        return harness.lod_hashes(self.program.info(self.out_of(words) / "scene.xml"))

    # Regression of 2026-11-25: a hang of 122 s, then exit code 142.
    def test_ranks_without_standard_error_bake(self):
        for redirection in (f"2>{FULL}", "2>&-", "<&- 2>&-"):
            words = self.bake()
            start = time.monotonic()
            result = self.run_with(words, redirection, ranks=2)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertLess(time.monotonic() - start, 60)
            self.expect_same_voxels(words)

    # Regression of 2026-11-25: SIGPIPE ended the bake.
    def test_a_reader_that_leaves_does_not_end_a_bake(self):
        words = self.bake()
        line = " ".join(f"'{word}'" for word in (self.program.executable, *words))
        script = f"{{ {line} 2>&1; echo $? >'{self.root}/code'; }} | true"
        subprocess.run([SHELL, "-c", script], env=self.environment, timeout=100, check=False)
        self.assertEqual((self.root / "code").read_text(), "0\n")
        self.expect_same_voxels(words)

    def test_files_do_not_get_the_numbers_of_closed_streams(self):
        """Otherwise a message would be written into a shard."""
        words = self.bake()
        self.run_with(words, "<&- >&- 2>&-")
        self.expect_same_voxels(words)
        self.program.succeed("verify", self.out_of(words))
        picture = self.new(".png")
        self.run_with(["render", self.out, "-o", picture, "--size", "16x16", "--backend", "cpu"], "<&- >&- 2>&-")
        self.assertEqual(picture.read_bytes()[:4], b"\x89PNG")


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1])
