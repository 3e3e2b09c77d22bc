#!/usr/bin/env python3
"""The Python package refuses scenes that are damaged or incomplete with one clear error, and never returns less.

Usage: errors_test.py GIGABAKE SOURCE_DIR
"""
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

from package_imports import gigabake, h5py, numpy

GOLDEN = Path(sys.argv[2]) / "tests/format/golden"
NEWEST = GOLDEN / "version_5_scene_5"


class Errors(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def copy(self, scene=NEWEST):
        folder = Path(tempfile.mkdtemp(dir=self.root)) / "scene"
        shutil.copytree(scene, folder)
        return folder

    def edit(self, folder, pattern, replacement):
        """Edits scene.xml. Its checksum is not compared by this package (docs/format.md)."""
        path = folder / "scene.xml"
        text = path.read_text(encoding="utf-8")
        edited, count = re.subn(pattern, replacement, text, count=1)
        self.assertEqual(count, 1, pattern)
        path.write_text(edited, encoding="utf-8")

    def expect_error(self, folder, file, key, cause, lods=(0, 1, 2)):
        """Expects that each level of the scene is refused with these parts of one message."""
        for lod in lods:
            with self.assertRaises(gigabake.GigabakeError) as caught:
                gigabake.open(folder).level(lod).region()
            error = caught.exception
            self.assertEqual(error.file, folder / file)
            self.assertIn(key, error.key)
            self.assertRegex(error.cause, cause)
            self.assertGreater(len(error.remedy), 10)
            self.assertEqual(len(str(error).splitlines()), 1)

    def test_a_missing_shard(self):
        folder = self.copy()
        (folder / "shards/c_0_0_0.h5").unlink()
        self.expect_error(folder, "shards/c_0_0_0.h5", "", "is missing", (0, 1))
        self.assertEqual(len(gigabake.open(folder).level(2).region()), 5)

    def test_a_missing_overview(self):
        folder = self.copy()
        (folder / "shards/p2_-1_1_0.h5").unlink()
        self.expect_error(folder, "shards/p2_-1_1_0.h5", "", "is missing", (2,))

    def test_scenes_whose_shards_are_missing_name_the_first(self):
        for scene in ("pages_scene_4", "pages_scene_5"):
            opened = gigabake.open(GOLDEN / scene)
            self.assertEqual(opened.level(0).voxel_count, 104894500)
            self.assertEqual(len(list(opened.xml.owners(0))), 100)
            with self.assertRaisesRegex(gigabake.GigabakeError, r"shards/c_.*is missing"):
                opened.level(0).region()

    def test_a_missing_page_and_a_page_of_another_scene(self):
        folder = self.copy(GOLDEN / "pages_scene_5")
        pages = sorted((folder / "pages").glob("g_*_8192-*.xml"))
        shutil.copy(pages[1], pages[0])
        self.expect_error(folder, pages[0].relative_to(folder), "BlockMin", "another scene or block", (0,))
        pages[0].unlink()
        self.expect_error(folder, pages[0].relative_to(folder), "", "does not exist", (0,))

    def test_a_page_that_lost_a_cell(self):
        folder = self.copy(GOLDEN / "pages_scene_5")
        page = sorted((folder / "pages").glob("g_*_8192-*.xml"))[0]
        text = page.read_text(encoding="utf-8")
        page.write_text(re.sub(r"\n *<PagedOctTree[^>]*/>", "", text, count=1), encoding="utf-8")
        self.expect_error(folder, page.relative_to(folder), "Voxels", "add up to", (0,))

    def test_truncated_files(self):
        for name, cause in (("shards/c_0_0_0.h5", "has .* bytes, but .* states"), ("scene.xml", "is not valid XML")):
            folder = self.copy()
            content = (folder / name).read_bytes()
            for size in (0, 100, len(content) // 2, len(content) - 1 - (name == "scene.xml")):
                (folder / name).write_bytes(content[:size])
                self.expect_error(folder, name, "", cause, (0,))

    def test_a_truncated_shard_whose_size_is_listed(self):
        folder = self.copy()
        content = (folder / "shards/c_0_0_0.h5").read_bytes()
        for size in (1000, 5000, len(content) - 1):
            (folder / "shards/c_0_0_0.h5").write_bytes(content[:size])
            self.edit(folder, r'Lods="2" Bytes="\d+" Lev', f'Lods="2" Bytes="{size}" Lev')
            self.expect_error(folder, "shards/c_0_0_0.h5", "", "cannot be read", (0,))

    def test_unknown_versions(self):
        folder = self.copy()
        self.edit(folder, 'Version="5"', 'Version="99"')
        self.expect_error(folder, "scene.xml", "Version", "is 99; this package reads 1 to 7", (0,))
        folder = self.copy()
        with h5py.File(folder / "shards/c_0_0_0.h5", "r+") as shard:
            shard.attrs.modify("version", numpy.int32(99))
        self.expect_error(folder, "shards/c_0_0_0.h5", "version", "is 99; this package reads 1 to", (0, 1))

    def test_a_scene_that_lists_less_or_other_shards(self):
        for pattern, replacement, cause in (
                (r"  <PagedOctTree[^>]*c_0_0_0[^>]*/>\n", "", "add up to 0 cells"),
                (r'Voxels="515 2"', 'Voxels="514 2"', "add up to"),
                (r'TreeFile="shards/c', 'TreeFile="../shards/c', "expected a file below"),
                (r'TreeFile="shards/p2_-1_1_0', 'TreeFile="shards/c_0_0_0', "two shards have one file"),
                (r'CellVoxels="16" Lods', 'CellVoxels="32" Lods', "does not agree"),
                (r'LatticeMin="-16 32 8" CellVoxels', 'LatticeMin="-16 x 8" CellVoxels', "expected integers"),
                (r'Name="c_0_0_0" ', "", "is missing")):
            folder = self.copy()
            self.edit(folder, pattern, replacement)
            with self.subTest(pattern=pattern):
                self.expect_error(folder, "scene.xml", "", cause, (0,))

    def test_a_shard_of_another_scene(self):
        folder = self.copy()
        self.edit(folder, 'LatticeMin="-16 32 8" CellVoxels', 'LatticeMin="0 32 8" CellVoxels')
        self.expect_error(folder, "shards/c_0_0_0.h5", "lattice_min", "differs from", (0,))

    def test_levels_that_do_not_exist(self):
        for lod in (-1, 3):
            with self.assertRaisesRegex(gigabake.GigabakeError, f"level {lod}: does not exist; .* 0 to 2"):
                gigabake.open(NEWEST).level(lod)
        with self.assertRaisesRegex(gigabake.GigabakeError, "scene.xml"):
            gigabake.open(self.root / "none")

    def test_boxes_that_are_no_boxes(self):
        for box in ([0, 0, 0, 1, 1, 1], [[0, 0, 0]], [[0, 0, numpy.nan], [1, 1, 1]]):
            with self.assertRaisesRegex(ValueError, "expected a box"):
                gigabake.open(NEWEST).level(0).region(box)

    def test_each_damaged_byte_is_an_error_or_changes_no_voxel(self):
        random = numpy.random.default_rng(20261127)
        refused = 0
        for scene in ("version_1", "version_2", "version_5_scene_5"):
            intact = [gigabake.open(GOLDEN / scene).level(lod).region() for lod in (0, 1)]
            folder = self.copy(GOLDEN / scene)
            path = folder / "shards/c_0_0_0.h5"
            content = path.read_bytes()
            for at in random.integers(0, len(content), 150):
                path.write_bytes(content[:at] + bytes([content[at] ^ 1 << random.integers(8)]) + content[at + 1:])
                with self.subTest(scene=scene, byte=int(at)):
                    refused += self.is_refused(folder, intact)
        self.assertGreater(refused, 100)

    def is_refused(self, folder, intact):
        """Returns whether the scene is refused. Fails if it is read with other voxels."""
        try:
            for lod, expected in enumerate(intact):
                voxels = gigabake.open(folder).level(lod).region()
                numpy.testing.assert_array_equal(voxels.index, expected.index)
                self.assertEqual(set(voxels.columns), set(expected.columns))
                for name, column in expected.columns.items():
                    numpy.testing.assert_array_equal(voxels.columns[name], column)
        except gigabake.GigabakeError as error:
            self.assertEqual(error.file, folder / "shards/c_0_0_0.h5")
            return True
        return False


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
