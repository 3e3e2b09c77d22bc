#!/usr/bin/env python3
"""Checks that the manual pages (read by man without warnings) and the shell completions agree with --help.

Usage: manual_test.py GIGABAKE SOURCE_DIR
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import programs

PROGRAM = sys.argv[1]
# Words that bash would complete, with expected and forbidden completions.
CASES = [
    (["ex"], {"export"}, {"bake"}),
    (["bench", "acc"], {"accuracy"}, {"export"}),
    (["export", "--lo"], {"--lod"}, {"--to"}),
    (["export", "--to", "gigavoxel"], {"gigavoxel-xml", "gigavoxel-binary"}, {"ply"}),
    (["bench", "render", "--s"], {"--size"}, {"--surface"}),
    (["completion", ""], {"bash", "zsh", "fish"}, set()),
    (["bake", "scene.glb", "--voxel"], {"--voxel-size"}, set()),
    # Options with a list of words. Regressions of 2026-11-22.
    (["bake", "--surface", ""], {"area", "conservative", "thin"}, {"--surface"}),
    (["plan", "--mip", ""], {"coverage", "thesis", "box"}, set()),
    (["bake", "--codec", "l"], {"lz4"}, {"deflate"}),
    (["bake", "--up", ""], {"x", "y", "z"}, set()),
    (["bake", "--channels", "rgba,"], {"rgba,normal", "rgba,facing", "rgba,normal,facing"}, set()),
    (["bench", "bake", "--backend", "c"], {"cpu", "cuda"}, {"auto"}),
    (["bench", "accuracy", "--settings", "thin-b"], {"thin-box", "thin-box-x2"}, set()),
    (["plan", "--backend", ""], {"auto", "cpu", "cuda"}, set()),
    (["serve", "--backend", "a"], {"auto"}, {"cpu"}),
    (["render", "--mode", "co"], {"coverage"}, {"lod"}),
    (["man", "ben"], {"bench"}, set()),
    (["man", "bench", "acc"], {"accuracy"}, set()),
]


def output(*command, **options):
    result = programs.run(command, 120, **options)
    assert result.returncode == 0, f"{command}: exit {result.returncode}\n{result.stdout}\n{result.stderr}"
    return result.stdout


def commands():
    """Returns the words of each command. The only source is --help."""
    def below(words):
        yield words
        listed = output(PROGRAM, *words, "--help").partition("Subcommands:\n")[2].partition("\n\n")[0]
        for name in re.findall(r"^  (\S+)", listed, re.M):
            yield from below(words + [name])
    return list(below([]))


class Manual(unittest.TestCase):
    @unittest.skipUnless(shutil.which("man") and shutil.which("groff"), "man-db or groff is not installed")
    def test_man_shows_every_option_of_every_command_without_a_warning(self):
        environment = dict(os.environ, LC_ALL="C.UTF-8", MANWIDTH="200", MANROFFOPT="")
        for words in commands():
            page = output(PROGRAM, "man", *words)
            with tempfile.NamedTemporaryFile("w", suffix=".1", encoding="utf-8") as file:
                file.write(page)
                file.flush()
                shown = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", file.name], env=environment,
                                       capture_output=True, text=True, timeout=120, check=True)
            self.assertEqual(shown.stderr, "", words)
            help_text = output(PROGRAM, *words, "--help")
            for option in re.findall(r"^  (?:-\w,)?(--[\w-]+)", help_text, re.M):
                self.assertIn(option, shown.stdout, words)
            self.assertIn("EXIT STATUS", shown.stdout)

    def test_all_pages_are_written_into_a_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            output(PROGRAM, "man", "--all", folder)
            expected = {"-".join(["gigabake", *words]) + ".1" for words in commands()}
            self.assertEqual({path.name for path in Path(folder).iterdir()}, expected)

    def test_an_unknown_command_has_no_page(self):
        result = subprocess.run([PROGRAM, "man", "fly"], capture_output=True, text=True, check=False)
        self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1))


class Completion(unittest.TestCase):
    def script(self, shell):
        file = Path(self.folder.name) / shell
        file.write_text(output(PROGRAM, "completion", shell), encoding="utf-8")
        return file

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def expect(self, words, found, wanted, unwanted):
        self.assertLessEqual(wanted, found, words)
        self.assertFalse(found & unwanted, (words, found))

    def test_bash_completes_commands_options_and_values(self):
        script = self.script("bash")
        for words, wanted, unwanted in CASES:
            call = f"""source {script}; COMP_WORDS=(gigabake "$@"); COMP_CWORD=$#
                {re.search("complete -F (.*) gigabake", script.read_text()).group(1)} 2>&1
                printf '%s\\n' "${{COMPREPLY[@]}}" """
            found = set(output("bash", "--norc", "-c", call, "bash", *words).split())
            self.expect(words, found, wanted, unwanted)

    def test_bash_completes_files_where_a_path_is_expected(self):
        (Path(self.folder.name) / "scene.xml").touch()
        call = f"""source {self.script("bash")}; COMP_WORDS=(gigabake info sce); COMP_CWORD=2; _gigabake
            echo "${{COMPREPLY[@]}}" """
        self.assertEqual(output("bash", "--norc", "-c", call, cwd=self.folder.name).split(), ["scene.xml"])

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish_completes_commands_options_and_values(self):
        script = self.script("fish")
        environment = dict(os.environ, HOME=self.folder.name)
        for words, wanted, unwanted in CASES:
            line = " ".join(["gigabake", *words])
            text = output("fish", "-N", "-c", f"source {script}; complete -C '{line}'", env=environment)
            self.expect(words, {row.split("\t")[0] for row in text.splitlines()}, wanted, unwanted)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_completes_commands_options_and_values(self):
        # Stubs of the functions of zsh's completion system print their words.
        stub = """
            compdef() { : }; _files() { print files }; compadd() { shift; print -l -- $@ }
            _describe() { [[ $1 == -o ]] && shift; print -l -- ${(@)${(P)2}%%:*} }
            source $1; shift; words=(gigabake "$@"); CURRENT=$#words; _gigabake"""
        script = self.script("zsh")
        for words, wanted, _ in CASES:
            found = set(output("zsh", "-f", "-c", stub, "zsh", str(script), *words).split())
            self.expect(words, found, wanted, set())


if __name__ == "__main__":
    programs.main(argv=sys.argv[:1], verbosity=2)
