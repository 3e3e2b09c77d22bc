#!/usr/bin/env python3
"""An invalid command line gets one line that names the probably intended word; --help and --version are correct.

Usage: usage_test.py GIGABAKE SOURCE_DIR
"""
import os
import pty
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

# Command lines, and the text that the message must contain. All are of 2026-11-22.
MISTAKES = [
    (["bkae", "scene.glb"], "gigabake: unknown command 'bkae'; did you mean bake?"),
    (["bench", "acuracy"], "gigabake bench: unknown command 'acuracy'; did you mean accuracy?"),
    (["frobnicate"], "unknown command 'frobnicate'; expected one of sample, plan, bake"),
    ([], "gigabake: expected a command"),
    (["bake", "scene.glb", "--voxle-size", "1"], "unknown option '--voxle-size'; did you mean --voxel-size?"),
    (["bake", "scene.glb", "--voxelsize=1"], "unknown option '--voxelsize'; did you mean --voxel-size?"),
    (["bake", "scene.glb", "--voxel", "1"], "unknown option '--voxel'; did you mean --voxel-size?"),
    (["bake", "--eye", "1,2,3"], "gigabake bake: unknown option '--eye', which belongs to: render, view, serve"),
    (["--voxel-size", "1", "bake", "scene.glb"], "gigabake: expected --voxel-size behind the command"),
    (["info", "--xyzzy", "a"], "gigabake info: unknown option '--xyzzy'; gigabake info --help lists them"),
    (["info", "-x", "a"], "gigabake info: unknown option '-x'; gigabake info --help lists them"),
    (["info", "a", "b"], "gigabake info: did not expect 'b'"),
    (["bake"], "gigabake bake: missing SOURCE, --voxel-size, -o,--out; gigabake bake --help has examples"),
    (["bake", "scene.glb", "-o", "out"], "missing --voxel-size;"),
    (["plan", "scene.glb", "--voxel-size", "1", "--backend", "gpu"],
     "--backend: expected one of auto, cpu, cuda, got 'gpu'"),
    (["plan", "scene.glb", "--voxel-size", "1", "--threads", "two"], "--threads"),
    (["man", "fly"], "expected one of sample, plan, bake"),
    (["bake", "--" + "x" * 100000], "unknown option"),
]


def commands(words=()):
    """Yields the words of each command, and its help."""
    text = GIGABAKE.succeed(*words, "--help")
    yield list(words), text
    listed = text.partition("Subcommands:\n")[2].partition("\n\n")[0]
    for name in re.findall(r"^  (\S+)", listed, re.M):
        yield from commands((*words, name))


class Usage(unittest.TestCase):
    # Regression of 2026-11-22: the message named a missing argument instead of the mistake.
    def test_a_mistake_is_named_before_what_is_missing_in_one_line(self):
        for words, expected in MISTAKES:
            with self.subTest(words=[word[:40] for word in words]):
                result = GIGABAKE.run(*words)
                self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
                self.assertIn(expected, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertLessEqual(len(result.stderr.encode()), 301)

    def test_pictures_of_unknown_kinds_are_refused_before_anything_is_read(self):
        for name in ("picture.bmp", "picture", "picture.png.gz", ".png"):
            result = GIGABAKE.run("render", "/no/such/scene.xml", "-o", name)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(f"-o: expected a name that ends in .png, .jpg, .jpeg or .exr, got '{name}'", result.stderr)
        result = GIGABAKE.run("render", "/no/such/scene.xml", "-o", "p.jpg", "--background", "0,0,0,0")
        self.assertIn("a JPEG is opaque", result.stderr)

    def test_every_command_has_examples_whose_options_it_has(self):
        helps = {" ".join(words): text for words, text in commands()}
        for words, text in helps.items():
            lines = re.findall(r"^  (.*)$", text.partition("Examples:\n")[2], re.M)
            self.assertTrue(lines, words)
            for line in lines:
                tokens = shlex.split(line, comments=True)
                if "gigabake" not in tokens:
                    continue  # the shell reads completions in a special way
                typed = tokens[tokens.index("gigabake") + 1:]
                name = max((n for n in helps if typed[:len(n.split())] == n.split()), key=len)
                self.assertTrue(name.startswith(words), (words, line))
                for option in (token for token in typed if token.startswith("-")):
                    self.assertRegex(helps[name], rf"(?m)^  (-\w,)?{re.escape(option)}\b|^  {re.escape(option)},", line)

    def test_help_lists_what_a_scene_may_be_and_what_modes_mean(self):
        for words, text in commands():
            usage = re.search(r"^Usage:.*$", text, re.M).group()
            for name in ("SOURCE", "SCENE"):
                self.assertEqual(f"{name} may be:" in text, name in usage, words)
        for kind in (".glb", "tileset.json", ".obj", "scene .json", "folder"):
            self.assertIn(kind, GIGABAKE.succeed("bake", "--help"))
        modes = GIGABAKE.succeed("render", "--help").partition("Modes:\n")[2].partition("\n\n")[0]
        self.assertEqual(re.findall(r"^  (\w+) ", modes, re.M),
                         ["lit", "albedo", "normal", "coverage", "lod", "cell", "requests",
                          "sun", "sky", "shadow", "height", "slope", "class"])
        viewer = (Path(SOURCE) / "docs" / "viewer.md").read_text(encoding="utf-8")
        for mode, legend in re.findall(r"^  (\w+) +(.*)$", modes, re.M)[1:]:
            self.assertIn(f"| `{mode}` | {legend} |", viewer)

    def test_the_version_names_commit_toolkit_libraries_and_formats(self):
        text = GIGABAKE.succeed("--version")
        self.assertRegex(text, r"\Agigabake \d+\.\d+\.\d+(, commit [0-9a-f]{12}( with changes)?)?\n")
        for line in (r"formats .*shards: writes version \d+.*scenes: writes version \d+",
                     r"compiler +\S+", r"CUDA +(toolkit \d|not built in)",
                     r"MPI +\w.* v?\d", r"libraries HDF5 \d.*LZ4 \d.*libdeflate \d", r"loaded .*GDAL.*OpenVDB",
                     r"codecs +\w"):
            self.assertRegex(text, rf"(?m)^{line}")
        # Regression of 2026-11-25: this test failed on a machine without git. The build needs no git.
        if not shutil.which("git"):
            return
        head = subprocess.run(["git", "-C", SOURCE, "rev-parse", "--show-toplevel"], capture_output=True, text=True,
                              check=False)
        if head.returncode == 0 and Path(head.stdout.strip()).resolve() == Path(SOURCE).resolve():
            self.assertIn("commit", text.splitlines()[0])

    def test_the_version_is_checked_without_git(self):
        with tempfile.TemporaryDirectory() as empty, unittest.mock.patch.dict(os.environ, PATH=empty):
            self.assertIsNone(shutil.which("git"))
            self.test_the_version_names_commit_toolkit_libraries_and_formats()


@unittest.skipUnless(shutil.which("man") or shutil.which("groff"), "neither man nor groff is installed")
class ManualOnATerminal(unittest.TestCase):
    def test_a_page_is_formatted_on_a_terminal_and_raw_in_a_pipe(self):
        leader, follower = pty.openpty()
        environment = dict(os.environ, PAGER="cat", MANPAGER="cat", LC_ALL="C.UTF-8", TERM="dumb")
        with subprocess.Popen([GIGABAKE.executable, "man", "bake"], stdin=follower, stdout=follower, stderr=follower,
                              env=environment) as program:
            os.close(follower)
            shown = b""
            while True:
                try:
                    piece = os.read(leader, 65536)
                except OSError:  # the other end is closed
                    break
                if not piece:
                    break
                shown += piece
            self.assertEqual(program.wait(timeout=60), 0, shown)
        os.close(leader)
        text = re.sub(r"\x1b\[[0-9;]*m|.\x08", "", shown.decode())
        self.assertIn("EXAMPLES", text)
        self.assertNotIn(".SH", text)
        self.assertIn(".SH EXAMPLES", GIGABAKE.succeed("man", "bake"))


class Jpeg(unittest.TestCase):
    # Regression of 2026-11-22: the program wrote a PNG into a file named .jpg.
    def test_render_writes_a_jpeg_where_the_name_says_so(self):
        with tempfile.TemporaryDirectory() as folder:
            GIGABAKE.succeed("sample", f"{folder}/sample", "--size", 64, "--tiles", 1)
            GIGABAKE.succeed("bake", f"{folder}/sample/tileset.json", "-o", f"{folder}/out", "--voxel-size", 0.5)
            for name in ("image.jpg", "image.JPEG"):
                said = GIGABAKE.succeed("render", f"{folder}/out/scene.xml", "-o", f"{folder}/{name}",
                                        "--size", "64x48", "--mode", "lod")
                data = (Path(folder) / name).read_bytes()
                self.assertEqual((data[:3], data[-2:]), (b"\xff\xd8\xff", b"\xff\xd9"))
                self.assertIn("lod: level of the voxels: 0 (finest) red", said)
                self.assertRegex(said, r"\d+ MB of voxels held")


if __name__ == "__main__":
    GIGABAKE, SOURCE = harness.Gigabake(sys.argv[1]), sys.argv[2]
    unittest.main(argv=sys.argv[:1], verbosity=2)
