#!/usr/bin/env python3
"""Each command that a document names works: it is run on a small scene, or at least its options are checked.

README.md, CONTRIBUTING.md, SECURITY.md and docs/*.md. Every `gigabake` command, in a block or between backquotes, must
have a subcommand, options and values that the program accepts. The commands of blocks are run, unless CHECKED gives a
reason. Scripts, presets, targets and tests that other commands name must exist.

Usage: documents_test.py GIGABAKE SOURCE_DIR
"""
import json
import re
import shlex
import shutil
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy
from osgeo import gdal, osr

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

# Beginnings of commands in blocks that this test does not run, each with the reason.
CHECKED = {
    "gigabake view": "needs a display; view_test.py opens one",
    "gigabake serve": "does not end; serve_test.py runs it",
    "gigabake bench": "takes minutes; bench_test.py, accuracy_test.py and leaks_test.py run it on small scenes",
}
# Other first words of a command line.
SHELL = {"cd", "export"}
# Beginnings of commands that build or test everything; the tests cannot run them. tests/python/page_test.py runs pip.
TOOLS = {"cmake", "cpack", "ctest", "pip", "./quickstart", "./check"}
STARTERS = {"mpirun": 2}  # the number of words of a starter
PLACEHOLDER = re.compile(r"[A-Z]{1,}|…|^\.\.+$|%|^<")
SMALL = {"sample": {"--size": "64"}, "plan": {"--voxel-size": "2"},
         "bake": {"--voxel-size": "2", "--cell-voxels": "64"},
         "render": {"--size": "64x48", "--frames": "2", "--eye": "60,-60,300", "--target": "0,0,0"},
         "query": {"--step": "20"}}
# Values for the placeholders in documents.
OPEN_VALUES = {"--path ...": "--path path.json --frames 2 -o f%04d.png", "--grid ...": "--grid=-5,-5,5,5 --step 5",
               "--profile ...": "--profile line.geojson --step 5",
               "--volume A.geojson": "--volume area.geojson --above 600"}
NEEDED = {"bake": [("-o", "SCENE"), ("--voxel-size", "2")], "render": [("-o", "P.png")]}
NUMBERS = [("X,Y,Z,DX,DY,DZ", "0,0,900,0,0,-1"), ("X,Y,Z,X,Y,Z", "0,0,900,5,5,900"), ("X,Y,X,Y", "-5,-5,5,5"),
           ("X,Y", "0,0"), ("W,S,E,N", "8.3,46.93,8.303,46.932")]


def documents(root):
    return [root / "README.md", root / "CONTRIBUTING.md", root / "SECURITY.md", *sorted((root / "docs").glob("*.md"))]


def without_text(line):
    """Returns a command without the comment or the description in the next column."""
    line = re.split(r"\s+# ", line)[0]
    return " ".join((line[:16] + re.split(r"  +", line[16:])[0]).split())


def blocks(text):
    """Yields a list of commands per block of shell lines, per group of indented lines and per table row."""
    for language, body in re.findall(r"^```(\w*)\n(.*?)^```", text, re.M | re.S):
        if language in ("", "sh", "bash"):
            yield [without_text(line) for line in body.replace("\\\n", " ").splitlines() if line.strip()]
    for group in re.findall(r"(?:^    (?:gigabake|mpirun|cluster/|\./|cmake) ?.*\n)+", text, re.M):
        yield [without_text(line.strip()) for line in group.splitlines()]
    yield from ([command] for command in re.findall(r"^\|.*\| `(gigabake [^`…]+)` \|$", text, re.M))


def spans(text):
    """Yields the commands between backquotes, without their starters."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    for span in re.findall(r"`([^`]+)`", text):
        words = span.split()
        for at, word in enumerate(words):
            if Path(word).name in ("gigabake", "gigabake-mpirun", "gigabake.sbatch"):
                rest = words[at + 1:]
                yield ["gigabake", *(rest[1:] if word.endswith("mpirun") else rest)]
                break


def parts(command):
    """Yields the commands of a line, without variables and a starter."""
    for part in re.split(r" && |; |[()]", command):
        words = shlex.split(part, posix=False)
        while words and re.match(r"[A-Z_]+=", words[0]):
            words.pop(0)
        if words and words[0] in STARTERS:
            words = words[1 + STARTERS[words[0]]:]
        if words:
            yield [word.strip("'") for word in words]


class Parser:
    """The program's command line: subcommands and options from its completion script, values from its own parser."""

    def __init__(self):
        script = PROGRAM.succeed("completion", "bash")
        self.options = {name: set(re.split(r" ", options.strip("'"))) for name, options in re.findall(
            r"'(gigabake[\w ]*)'\) commands=(?:'[^']*'|\S*) options=('[^']*'|\S*) ;;", script)}

    def subcommand(self, words):
        """Returns the longest command that begins the words."""
        for count in (3, 2):
            if " ".join(words[:count]) in self.options:
                return " ".join(words[:count])
        return None

    def problem(self, words):
        command = self.subcommand(words)
        if command is None:
            return "no such subcommand"
        arguments, kept = words[len(command.split()):], []
        for at, word in enumerate(arguments):
            name, _, value = word.partition("=")
            if not re.match(r"-+[a-z]", name):
                continue
            if name not in self.options[command]:
                return f"{command} has no option {name}"
            following = arguments[at + 1] if at + 1 < len(arguments) else ""
            value = value or ("" if following.startswith("-") else following)
            if value and not PLACEHOLDER.search(value):
                kept += [name, value]
        result = PROGRAM.run(*command.split()[1:], *kept, "--help")
        return "" if result.returncode == 0 else result.stderr


def write_rasters(folder):
    """Writes an elevation raster, a folder of rasters, and a photo."""
    (folder / "tiles").mkdir()
    for name, values in (("dem.tif", numpy.full((1, 40, 40), 500, "f4")), ("photo.tif", numpy.ones((3, 40, 40), "u1"))):
        kind = gdal.GDT_Float32 if len(values) == 1 else gdal.GDT_Byte
        raster = gdal.GetDriverByName("GTiff").Create(str(folder / name), 40, 40, len(values), kind)
        raster.SetGeoTransform([446800, 2, 0, 5197780, 0, -2])
        crs = osr.SpatialReference()
        crs.ImportFromEPSG(25832)
        raster.SetSpatialRef(crs)
        for i, band in enumerate(values, 1):
            raster.GetRasterBand(i).WriteArray(band)
        raster = None
    shutil.copy(folder / "dem.tif", folder / "tiles")


class Documents(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.texts = {path: path.read_text(encoding="utf-8") for path in documents(ROOT)}
        cls.parser = Parser()
        scene = cls.root / "made" / "scene"
        PROGRAM.sample(scene, size=64, tiles=1)
        PROGRAM.bake(scene / "tileset.json", cls.root / "made" / "SCENE", 2, "--cell-voxels", 64)
        shutil.copytree(cls.root / "made" / "SCENE", cls.root / "made" / "OTHER")
        keyframe = {"time_s": 0, "eye": [60, -60, 300], "target": [0, 0, 0]}
        (cls.root / "made" / "path.json").write_text(json.dumps({"keyframes": [keyframe, {**keyframe, "time_s": 1}]}))
        for name, columns in (("rays", "x,y,z,dx,dy,dz\n0,0,900,0,0,-1"), ("places", "x,y\n0,0"),
                              ("pairs", "x,y,z,to_x,to_y,to_z\n0,0,900,5,5,900")):
            (cls.root / "made" / f"{name}.csv").write_text(columns + "\n")
        ring = [[8.3, 46.93], [8.303, 46.93], [8.303, 46.933], [8.3, 46.93]]
        for name in ("district", "area"):
            polygon = {"type": "Polygon", "coordinates": [ring]}
            (cls.root / "made" / f"{name}.geojson").write_text(json.dumps(polygon))
        line = {"type": "LineString", "coordinates": ring[:2]}
        edit = {"type": "carve", "sphere": {"position_m": [0, 0, 0], "radius_m": 9}}
        (cls.root / "made" / "edits.json").write_text(json.dumps({"edits": [edit]}))
        (cls.root / "made" / "line.geojson").write_text(json.dumps(line))
        numpy.save(cls.root / "made" / "rays.npy", [[0.0, 0, 900, 0, 0, -1]])
        write_rasters(cls.root / "made")
        harness.write_glb(cls.root / "made" / "machine.glb", [[0, 9, 0], [4, 9, 0], [4, 9, -4]], [0, 1, 2])

    def commands(self):
        """Yields the document and the words of each gigabake command in blocks and between backquotes."""
        for path, text in self.texts.items():
            for block in blocks(text):
                for line in block:
                    yield from ((path, words) for words in parts(line))
            yield from ((path, words) for words in spans(text) if len(words) > 1 and words[1] != "…")

    def test_options_of_every_command(self):
        checked = {tuple(words): path.name for path, words in self.commands()
                   if words[0] == "gigabake" and re.match("[a-z]", words[1])}
        self.assertGreater(len(checked), 60)
        with ThreadPoolExecutor(2) as pool:
            for (words, name), problem in zip(checked.items(), pool.map(self.parser.problem, checked)):
                with self.subTest(document=name, command=" ".join(words)):
                    self.assertEqual(problem, "")

    def real_words(self, words):
        """Returns the command with existing, small files as arguments."""
        command, text = words[1], " ".join(words).replace("/tmp/", "")
        for open_value, value in OPEN_VALUES.items():
            text = text.replace(open_value, value)
        text = re.sub(r" \.\.+$", "", re.sub(r"(?<=bake) \.\.\.(?= -)", " SOURCE", text))
        for shape, numbers in NUMBERS:
            text = re.sub(rf"{shape}(?=\s|$)", numbers, text)
        out = re.sub(r" (SOURCE|tileset\.json)\b", " scene/tileset.json", text).split()
        for option, value in NEEDED.get(command, ()):
            out += [] if option in out else [option, value]
        for option, value in SMALL.get(command, {}).items():
            if option in out:
                out[out.index(option) + 1] = value
        return ["1" if word == "N" else word for word in out][1:]

    def faults_of_block(self, block):
        """Runs all commands of the block in one folder. Returns each command that fails, with its output."""
        folder = Path(tempfile.mkdtemp(dir=self.root))
        shutil.copytree(self.root / "made", folder, dirs_exist_ok=True)
        faults = []
        for line in block:
            for words in parts(line):
                if words[0] != "gigabake" or any(" ".join(words).startswith(begin) for begin in CHECKED):
                    continue
                words = self.real_words(words)
                if words[0] == "bake" and words[words.index("-o") + 1] == "SCENE":
                    shutil.rmtree(folder / "SCENE", ignore_errors=True)
                if "-o" in words:
                    (folder / words[words.index("-o") + 1]).parent.mkdir(exist_ok=True)
                result = PROGRAM.run(*words, cwd=folder)
                if result.returncode != 0:
                    faults.append(f"{line}: exit {result.returncode}\n{words}\n{result.stdout}{result.stderr}")
        return faults

    def test_commands_of_blocks_run(self):
        all_blocks = [(path.name, block) for path, text in self.texts.items() for block in blocks(text)
                      if any("gigabake " in line for line in block)]
        self.assertGreater(len(all_blocks), 8)
        with ThreadPoolExecutor(2) as pool:
            runs = pool.map(self.faults_of_block, [block for _, block in all_blocks])
            for (name, _), faults in zip(all_blocks, runs):
                for fault in faults:
                    with self.subTest(document=name):
                        self.fail(fault)

    def test_the_list_of_commands_that_are_not_run_names_commands_of_documents(self):
        lines = [" ".join(words) for path, words in self.commands()]
        for begin in CHECKED:
            self.assertTrue(any(line.startswith(begin) for line in lines), f"no document names: {begin}")

    def problem_of_tool(self, words):
        """Returns the first preset, target, test or file that the command names and that does not exist."""
        presets = json.loads((ROOT / "CMakePresets.json").read_text())
        tests = (ROOT / "tests/CMakeLists.txt").read_text()
        kind = "buildPresets" if "--build" in words else "configurePresets"
        for option, value in zip(words, words[1:]):
            if option == "--preset" and value not in {preset["name"] for preset in presets[kind]}:
                return f"no preset {value} in {kind}"
            if option == "--target" and not re.search(rf"gb_test\({value.removeprefix('gigabake_test_')} ", tests):
                return f"no target {value}"
            if option == "-R" and not self.has_test(value, tests):
                return f"no test {value}"
        script = next((word for word in words[:2] if "/" in word and not word.startswith(("/", "build/"))), None)
        if script is None:
            return ""
        if not (ROOT / script).is_file():
            return f"{script} is not there"
        source = (ROOT / script).read_text(encoding="utf-8")
        return next((f"{script} has no option {word}" for word in words if re.match("--[a-z]", word) and
                     word.split("=")[0] not in source and "unittest" not in source), "")

    @staticmethod
    def has_test(pattern, tests):
        name = pattern.strip("^'").replace("\\.", "")
        return f"gb_test({name} " in tests or any(f"TEST({name}" in path.read_text(encoding="utf-8")
                                                  for path in (ROOT / "tests").rglob("*_test.cpp"))

    def test_files_presets_and_tests_that_other_commands_name_exist(self):
        count = 0
        for path, text in self.texts.items():
            for words in (words for block in blocks(text) for line in block for words in parts(line)):
                if words[0] in {"gigabake", *SHELL}:
                    continue
                count += 1
                message = f"{path.name}: {' '.join(words)}"
                known = words[0] in TOOLS or "/" in words[0] or words[0] == "python3"
                self.assertTrue(known, f"{message}: unknown program {words[0]}: add it to this test")
                self.assertEqual(self.problem_of_tool(words), "", message)
        self.assertGreater(count, 20)


if __name__ == "__main__":
    PROGRAM, ROOT = harness.Gigabake(str(Path(sys.argv[1]).resolve())), Path(sys.argv[2]).resolve()
    harness.main(argv=sys.argv[:1])
