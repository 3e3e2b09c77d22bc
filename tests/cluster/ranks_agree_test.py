#!/usr/bin/env python3
"""All ranks of a launch must run the same request with the same program.

A rank with other options, with another command or from another build ends the launch, and nothing is written.

Usage: ranks_agree_test.py GIGABAKE SOURCE_DIR
"""
import os
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
import harness

VOXEL = "0.5"


def launch(*ranks, timeout=100):
    """Starts ranks. Each rank is a pair of (program and arguments, options of mpirun)."""
    command = ["mpirun"]
    for index, (arguments, of_mpirun) in enumerate(ranks):
        command += ([":"] if index else []) + ["-n", "1", *map(str, of_mpirun), *map(str, arguments)]
    return harness.run(command, timeout, env=dict(os.environ, **harness.MPI_ENVIRONMENT))


def of_another_build(program, path):
    """Writes a copy of the program with another build id."""
    content = bytearray(Path(program).read_bytes())
    notes = subprocess.run(["readelf", "-n", program], capture_output=True, text=True, check=True).stdout
    build_id = bytes.fromhex(next(line.split()[-1] for line in notes.splitlines() if "Build ID" in line))
    at = content.index(build_id)
    assert content.count(build_id) == 1
    content[at] ^= 0xFF
    path.write_bytes(content)
    path.chmod(0o755)
    return path


class RanksAgree(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.Gigabake(Path(sys.argv[1]).resolve())
        cls.source = cls.program.sample(cls.root / "terrain", size=64, tiles=2)
        cls.right = harness.lod_hashes(cls.program.bake(cls.source, cls.root / "right", VOXEL, "--cell-voxels", 64))

    def rank(self, *more, command="bake", program=None, of_mpirun=(), source=None, out="out"):
        words = [program or self.program.executable, command, source or self.source, "--voxel-size", VOXEL,
                 "--cell-voxels", 64, "-o", out if command == "bake" else self.root / "right", *more]
        return words, of_mpirun

    def out(self):
        return self.root / f"out_{self.id().rpartition('.')[2]}"

    def expect_refusal(self, result, *texts):
        self.assertNotEqual(result.returncode, 0, result.stderr)
        lines = [line for line in result.stderr.splitlines() if "gigabake: " in line]
        self.assertEqual(len(lines), 1, result.stderr)
        for text in texts:
            self.assertIn(text, lines[0])
        self.assertFalse(self.out().exists())

    # Regression of 2026-11-25: each rank baked with its own options under rank 0's fingerprints, with exit code 0.
    def test_other_options_end_the_launch(self):
        cases = [(["--surface", "thin"], "--surface is thin on this rank and area on rank 0"),
                 (["--channels", "rgba"], "--channels is"), (["--local"], "--local is given on this rank"),
                 (["--prune"], "--prune is given")]
        out = self.out()
        for more, text in cases:
            with self.subTest(options=more):
                result = launch(self.rank(out=out), self.rank(*more, out=out))
                self.expect_refusal(result, text, "rank 1 on ")
        result = launch(self.rank(out=out), self.rank(out=self.root / "elsewhere"))
        self.expect_refusal(result, "-o is ")
        self.assertFalse((self.root / "elsewhere").exists())

    def test_wrong_options_of_one_rank_end_the_launch(self):
        result = launch(self.rank(out=self.out()), self.rank("--max-error", 999, out=self.out()))
        self.expect_refusal(result, "--max-error: expected")

    def test_another_command_ends_the_launch(self):
        result = launch(self.rank(out=self.out()), self.rank(command="plan"))
        self.expect_refusal(result, "plan of gigabake", "bake of gigabake")

    def test_another_build_ends_the_launch(self):
        other = of_another_build(self.program.executable, self.root / "other_build")
        result = launch(self.rank(out=self.out()), self.rank(out=self.out(), program=other))
        self.expect_refusal(result, "kernel version", "need the same program", "rank 1 on ")

    def test_resources_may_differ(self):
        out = self.out()
        result = launch(self.rank("--threads", 1, out=out), self.rank("--threads", 2, "--memory", "1G", out=out))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(harness.lod_hashes(self.program.info(out / "scene.xml")), self.right)

    # Regression of 2026-11-25: the message was "leaves the source folder", with exit code 3.
    def test_ranks_may_have_different_working_directories(self):
        (self.root / "a").mkdir()
        (self.root / "b").mkdir()
        (self.root / "a/tiles").symlink_to(self.source.parent, target_is_directory=True)
        relative = {"source": "tiles/tileset.json", "out": "out"}
        result = launch(self.rank(of_mpirun=["-wdir", self.root / "a"], **relative),
                        self.rank(of_mpirun=["-wdir", self.root / "b"], **relative))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(harness.lod_hashes(self.program.info(self.root / "a/out/scene.xml")), self.right)
        self.assertFalse((self.root / "b/out").exists())

    def test_export_with_other_options_ends_the_launch(self):
        words = [self.program.executable, "export", self.root / "right", "--to", "3dtiles", "-o", self.out()]
        result = launch((words, ()), ([*words, "--lod", 1], ()))
        self.expect_refusal(result, "--lod is 1 on this rank and 0 on rank 0")


if __name__ == "__main__":
    harness.main(argv=sys.argv[:1])
