#!/usr/bin/env python3
"""A .3tz archive is baked as the folder it was packed from, and only what changed in it is baked again.

Usage: archive_test.py GIGABAKE SOURCE_DIR
"""
import json
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

SQUARE = [[0, 0, 0], [20, 0, 0], [20, 0, -20], [0, 0, -20]]
TWO = [0, 1, 2, 0, 2, 3]


def tile(uri, x):
    return {"geometricError": 0, "boundingVolume": {"sphere": [x, 0, 0, 30]}, "content": {"uri": uri},
            "transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1]}


class ArchiveTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        self.source = self.root / "source"
        (self.source / "tiles").mkdir(parents=True)
        for name in ("a", "b"):
            harness.write_glb(self.source / f"tiles/{name}.glb", SQUARE, TWO)
        (self.source / "tileset.json").write_text(json.dumps({
            "asset": {"version": "1.1"}, "geometricError": 1,
            "root": {"geometricError": 1, "refine": "ADD", "boundingVolume": {"sphere": [0, 0, 0, 500]},
                     "children": [tile("tiles/a.glb", 0), tile("tiles/b.glb", 320)]}}))
        self.archive = self.root / "set.3tz"

    def tearDown(self):
        self.folder.cleanup()

    def pack(self, method=zipfile.ZIP_DEFLATED):
        with zipfile.ZipFile(self.archive, "w", method) as packed:
            for file in sorted(self.source.rglob("*")):
                if file.is_file():
                    packed.write(file, file.relative_to(self.source).as_posix())

    def bake(self, source, out):
        return PROGRAM.bake(source, self.root / out, 1, "--cell-voxels", 64)

    def test_archive_is_the_folder_it_was_packed_from(self):
        folder = self.bake(self.source / "tileset.json", "folder")
        for method in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            self.pack(method)
            packed = self.bake(self.archive, f"packed_{method}")
            self.assertEqual(harness.lod_hashes(packed), harness.lod_hashes(folder))

    def test_only_what_changed_in_it_is_baked_again(self):
        self.pack()
        self.bake(self.archive, "out")
        shards = {p.name: p.stat().st_mtime_ns for p in (self.root / "out").rglob("c_*.h5")}
        harness.write_glb(self.source / "tiles/b.glb", [[x, y + 1, z] for x, y, z in SQUARE], TWO)
        self.pack()
        self.bake(self.archive, "out")
        again = {p.name: p.stat().st_mtime_ns for p in (self.root / "out").rglob("c_*.h5")}
        kept = [name for name in shards if again.get(name) == shards[name]]
        self.assertEqual(len(shards), 2)
        self.assertGreaterEqual(len(kept), 1)
        self.assertGreater(len(set(again) - set(shards)), 0)

    def test_an_archive_that_lies_is_refused_in_one_line(self):
        self.archive.write_bytes(b"PK\x03\x04" + bytes(100))
        self.refuse("expected a ZIP archive")
        with zipfile.ZipFile(self.archive, "w") as packed:
            packed.writestr("readme.txt", "no tileset")
        self.refuse("holds no tileset.json")
        self.pack()
        content = bytearray(self.archive.read_bytes())
        at = content.index(b"tiles/a.glb") + 20  # in the compressed bytes
        content[at] ^= 0xff
        self.archive.write_bytes(content)
        result = PROGRAM.run("bake", self.archive, "-o", self.root / "out", "--voxel-size", 1)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("tiles/a.glb", result.stderr)
        self.assertIn("cannot be unpacked", result.stderr)

    def refuse(self, *words):
        result = PROGRAM.run("bake", self.archive, "-o", self.root / "refused", "--voxel-size", 1)
        self.assertEqual(result.returncode, 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.skip_without(PROGRAM, "libzip", "probe.3tz")
    harness.main(argv=sys.argv[:1], verbosity=2)
