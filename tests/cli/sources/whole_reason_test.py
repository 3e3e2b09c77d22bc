#!/usr/bin/env python3
"""Messages have their whole reason, however long the paths and names are that files give them.

Each case is a refusal or a warning of one reader. It runs twice: in a short folder, and below two folders whose names
have 200 characters. Both lines must give the same reason; only paths and names that a file states may be shortened.

Usage: whole_reason_test.py GIGABAKE SOURCE_DIR
"""
import json
import re
import shutil
import struct
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

SOURCE = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(SOURCE / "tests/fuzz"), str(SOURCE / "tests/hostile")]
import made_seeds as made  # noqa: E402
import source_seeds  # noqa: E402

MAX_LINE_BYTES = 1000  # core/base/quote.h; a command may prepend the beginning of a line
LONG, SPACED = "n" * 4000, "nnnn " * 800 + "n"
FOLDER = Path("a" * 100 + " " + "b" * 99) / ("c" * 200)


def text(value):
    return json.dumps(value).encode()


def changed(document, *path, value):
    """Returns a copy of a document with one member set."""
    document = json.loads(json.dumps(document))
    at = document
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return document


def obj_cases(name):
    faces = b"v 0 0 0\nv 1 0 0\nv 1 1 0\n"
    for line in (f"f 1 2 {name}", f"v 1 {name} 3", f"f 1 2 99{name}", f"mtllib {name}.mtl\nf 1 2 3"):
        yield "a.obj", {"a.obj": faces + line.encode()}
    use = b"mtllib a.mtl\nusemtl m\n" + faces + b"vt 0 0\nf 1/1 2/1 3/1\n"
    for line in (f"map_Kd {name}.png", f"map_Kd ../{name}.png", f"Kd 1 2 {name}", f"d {name}", "Kd 1 0"):
        yield "a.mtl", {"a.obj": use, "a.mtl": b"newmtl m\n" + line.encode()}


def ply_cases(name):
    head = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
    for line in (f"property {name} x", "property list uchar int", f"format {name} 1.0", f"{name} 1"):
        yield "a.ply", {"a.ply": head + line.encode() + b"\nend_header\n0 0 0\n"}
    yield "a.ply", {"a.ply": head + b"end_header\n0 " + name.encode() + b" 0\n"}
    yield "a.ply", {"a.ply": head.replace(b"vertex 1", b"vertex 7") + b"end_header\n0 0 0\n"}


def stl_cases(name):
    facet = "solid {0}\nfacet normal 0 0 1\nouter loop\nvertex 0 0 {0}\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
    yield "a.stl", {"a.stl": facet.format(name).encode()}
    yield "a.stl", {"a.stl": facet.format(1).encode()}
    yield "a.stl", {"a.stl": b"a name".ljust(80, b"\0") + struct.pack("<I", 9) + bytes(50)}


def gltf_cases(name):
    square = made.square()
    for path, value in ((("buffers", 0, "uri"), name + ".bin"), (("buffers", 0, "uri"), "../" + name),
                        (("buffers", 0, "uri"), "data:" + name), (("asset", "version"), name),
                        (("extensionsRequired",), [name]), (("accessors", 0, "type"), name),
                        (("bufferViews", 0, "byteLength"), 99999), (("nodes", 0, "mesh"), 7), (("nodes", 0), name),
                        (("accessors", 0, "componentType"), name), (("accessors", 1, "count"), 7),
                        (("scenes", 0, "nodes"), [9])):
        yield "a.gltf", {"a.gltf": text(changed(square, *path, value=value))}
    yield "a.gltf", {"a.gltf": text(square)[:-9]}
    image = source_seeds.external_picture(name + ".png", b"", "image/png")
    yield "a.gltf", {"a.gltf": text(image)}
    glb = source_seeds.glb_of()(text(source_seeds.in_chunk()))
    yield "a.glb", {"a.glb": glb[:-20]}
    yield "a.glb", {"a.glb": glb[:16] + b"TEXT" + glb[20:]}
    yield "a.glb", {"a.glb": source_seeds.glb_of()(text(changed(source_seeds.in_chunk(), "images", value=[
        {"uri": name}]))).replace(b'"POSITION"', b'"NOTHING_"')}


def tileset_cases(name):
    good = made.tileset(made.tile())
    for path, value in ((("root", "content", "uri"), name), (("root", "content", "uri"), "../" + name),
                        (("root", "content", "uri"), f"http://{name}/a.glb"), (("asset", "version"), name),
                        (("extensionsRequired",), [name]), (("root", "refine"), name), (("root", "children"), name),
                        (("root", "boundingVolume"), {}), (("root", "transform"), [1, 2]), (("geometricError",), name),
                        (("root", "implicitTiling"), {"subdivisionScheme": name})):
        yield "tileset.json", {"tileset.json": text(changed(good, *path, value=value))}
    yield "tileset.json", {"tileset.json": text(good)[:40]}


def scene_cases(name):
    files = {"a.glb": source_seeds.glb_of()(text(source_seeds.in_chunk())), "d.asc": made.rasters()[1]}
    for source in ({"path": name + ".glb"}, {"path": "../" + name}, {"path": "a.glb", name: 1}, {"path": name},
                   {"path": "a.glb", "scale": name}, {"path": "a.glb", "place": {"lon_lat_height": [name]}},
                   {"dem": name + ".tif"}, {"dem": "d.asc"}, {"dem": "d.asc", "crs": name},
                   {"dem": "d.asc", "crs": "EPSG:25832", "ortho": name + ".tif"},
                   {"dem": "d.asc", "crs": "EPSG:25832", "ortho": "d.asc", "nodata": name}):
        yield "s.json", {**files, "s.json": text({"gigabake": 1, "sources": [source]})}
    yield "s.json", {**files, "s.json": text({"gigabake": name, "sources": []})}
    yield "s.json", {**files, "s.json": text({"gigabake": 1, "sources": [], name: 0})}
    grid = b"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize " + name.encode() + b"\n1 2 3\n4 5 6\n"
    dem = text({"gigabake": 1, "sources": [{"dem": "g.asc", "crs": "EPSG:25832"}]})
    yield "g.asc", {"s.json": dem, "g.asc": grid}
    yield "d.tif", {"d.tif": made.rasters()[0][:100]}


def tile_cases(name):
    """Yields faults that cost one tile: fewer than the 50 that a bake prints."""
    for cases in (obj_cases, ply_cases, stl_cases, gltf_cases):
        yield from cases(name)


def whole_cases():
    """Yields faults that end a command, alternating between long names and names with spaces."""
    for cases in (tileset_cases, scene_cases):
        for i, (long, spaced) in enumerate(zip(cases(LONG), cases(SPACED))):
            yield spaced if i % 2 else long
    yield next(obj_cases(LONG))


def reason_of(line, file):
    """Returns the text after the name of the file, without folders that the reason names."""
    reason = line.partition(file)[2] if file in line else line
    reason = re.sub(r"(source folder|the bake in) .*?(;|$)", r"\1\2", re.sub(r"/tmp/[^:]*/", "", reason))
    return re.sub(r"n[n ]{19,}(…[n ]*)?", "n", reason)  # names consist of n: only they may be shortened after the path


class WholeReason(harness.FolderTest):
    # Regression of 2026-11-25: messages lost their middle or their end beyond 240 bytes.
    def lines_of(self, arguments):
        result = PROGRAM.run(*arguments)
        # Progress lines of a slow step, and measured times, depend on the machine's load.
        return [line for line in (result.stderr + result.stdout).splitlines()
                if re.search(r"[a-z]: |^warning", line) and not re.search(r"^measured: |: [0-9]+ s$", line)]

    def compare(self, file, short_lines, long_lines, what):
        self.assertTrue(short_lines, f"{what}: no message")
        self.assertEqual([reason_of(line, file) for line in short_lines],
                         [reason_of(line, file) for line in long_lines], what)
        for line in short_lines + long_lines:
            self.assertLessEqual(len(line.encode()), MAX_LINE_BYTES, f"{what}: {line}")
            self.assertNotIn("…", reason_of(line, file), f"{what}: {line}")
            self.assertNotRegex(line, "[\0-\x1f\x7f]", what)

    def folders(self, name):
        """Returns a folder with a short name, and a folder with a long path."""
        both = self.root / f"s{name}", self.root / FOLDER / f"l{name}"
        for folder in both:
            folder.mkdir(parents=True)
        return both

    def test_sources(self):
        for number, (file, files) in enumerate(whole_cases()):
            lines = []
            for folder in self.folders(number):
                for name, content in files.items():
                    (folder / name).write_bytes(content)
                main = "s.json" if "s.json" in files else file
                lines.append(self.lines_of(["plan", folder / main, "--voxel-size", 0.5, "--local"]))
            with self.subTest(file=file, number=number):
                self.compare(file, *lines, files[file][-200:])

    def test_tiles_of_a_folder(self):
        for kind, name in (("long", LONG), ("spaced", SPACED)):
            self.compare_tiles(kind, list(tile_cases(name)))

    def compare_tiles(self, kind, cases):
        lines, folders = [], self.folders(kind)
        for folder in folders:
            harness.write_glb(folder / "good.glb", [[0, 0, 0], [4, 0, 0], [4, 0, -4]], [0, 1, 2])
            for number, (_, files) in enumerate(cases):
                # Cases are named by letters: lines that differ only in numbers are merged.
                case = folder / f"case_{chr(97 + number // 26)}{chr(97 + number % 26)}"
                case.mkdir()
                for name, content in files.items():
                    (case / name).write_bytes(content)
            lines.append(self.lines_of(["plan", folder, "--voxel-size", 0.5, "--local"]))
        for number, (file, files) in enumerate(cases):
            case = f"case_{chr(97 + number // 26)}{chr(97 + number % 26)}/"
            with self.subTest(kind=kind, case=case, file=file):
                short, long = ([line for line in run if case in line] for run in lines)
                if not short:  # a warning merged with warnings of other files
                    main = "a.obj" if file == "a.mtl" else file
                    short, long = (self.lines_of(["plan", folder / case / main, "--voxel-size", 0.5, "--local"])
                                   for folder in folders)
                    case = main
                self.compare(case, short, long, files[file][-200:])

    def edit_scene(self, scene, old, new):
        content = (scene / "scene.xml").read_bytes()
        self.assertIn(old, content)
        (scene / "scene.xml").write_bytes(content.replace(old, new, 1))

    def test_scenes_and_shards(self):
        source = PROGRAM.sample(self.root / "sample", size=64, tiles=1)
        PROGRAM.bake(source, self.root / "out", 2, "--cell-voxels", 32)
        scene_edits = [lambda s, n: self.edit_scene(s, b'Name="c_', b'Name="' + n + b'c_'),
                       lambda s, n: self.edit_scene(s, b"<PagedOctTree ", b"<" + n.replace(b" ", b"") + b" "),
                       lambda s, n: self.edit_scene(s, b"File=", b"Fil" + n.replace(b" ", b"") + b"="),
                       lambda s, n: self.edit_scene(s, b'File="shards/', b'File="shards/' + n),
                       lambda s, n: self.edit_scene(s, b"</", b"<" + n[:9])]
        for number, edit in enumerate(scene_edits):
            for name in (LONG.encode(), SPACED.encode()):
                self.compare_scene(f"{number}{len(name)}", "scene.xml", lambda s: edit(s, name))
        for number, at in enumerate((0, 600, 2000, -3000)):
            def damage(scene, at=at):
                shard = sorted((scene / "shards").glob("c_*.h5"))[0]
                content = bytearray(shard.read_bytes())
                content[at:at + 400 if at >= 0 else None] = b"\xee" * len(content[at:at + 400 if at >= 0 else None])
                shard.write_bytes(content)
            self.compare_scene(f"d{number}", ".h5", damage)

    def compare_scene(self, name, file, damage):
        folders = [self.root / f"s{name}", self.root / FOLDER / f"l{name}"]
        for folder in folders:
            shutil.copytree(self.root / "out", folder)
            damage(folder)
        for command in (["info"], ["verify"], ["export", "--to", "ply", "-o", self.root / "x.ply"]):
            runs = [self.lines_of([command[0], folder, *command[1:]]) for folder in folders]
            if runs[0] or command[0] == "verify":
                with self.subTest(command=command[0], name=name):
                    self.compare(file, *runs, f"{command[0]} {name}")


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(str(Path(sys.argv[1]).resolve()))
    harness.main(argv=sys.argv[:1])
