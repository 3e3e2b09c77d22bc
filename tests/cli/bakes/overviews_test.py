#!/usr/bin/env python3
"""Tests the overview levels above the cells, up to the root.

The levels are equal for any cell size and any ranks, and are rebuilt after changes. Some tests damage a child.

Usage: overviews_test.py GIGABAKE SOURCE_DIR
"""
import re
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import h5py_there
import harness
import numpy
from h5py_test import level_of
from invariance_test import VOXEL_M, hills
from png_file import read_png

SEED = 20261123


class Overviews(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.positions, cls.indices, cls.colours = hills(SEED)
        cls.four = cls.root / "four"
        cls.four.mkdir()
        for k in range(4):
            harness.write_glb(cls.four / f"part{k}.glb", cls.positions, cls.indices[k::4], cls.colours)
        cls.fine = cls.bake("fine", "--cell-voxels", 16)

    @classmethod
    def bake(cls, name, *arguments, **options):
        return PROGRAM.bake(cls.four, cls.root / name, VOXEL_M, *arguments, **options)

    def expect_same_levels(self, a, b, levels=5):
        both = min(len(a["lods"]), len(b["lods"]))
        self.assertGreaterEqual(both, levels)
        self.assertEqual(harness.lod_hashes(a, both), harness.lod_hashes(b, both), f"seed {SEED}")

    def test_levels_up_to_the_root_for_every_size_of_cells_and_number_of_ranks(self):
        for cell_voxels, ranks in ((8, 3), (32, 2), (64, 5), (256, 1)):
            info = self.bake(f"cells{cell_voxels}", "--cell-voxels", cell_voxels, ranks=ranks)
            self.expect_same_levels(self.fine, info)
            PROGRAM.succeed("verify", self.root / f"cells{cell_voxels}")

    def test_levels_of_every_filter(self):
        for options in (("--mip", "thesis"), ("--mip", "box"), ("--channels", "rgba"), ("--codec", "lz4")):
            few = self.bake("few", "--cell-voxels", 128, *options)
            many = self.bake("many", "--cell-voxels", 16, *options, ranks=2)
            self.expect_same_levels(few, many)
            self.assertEqual(PROGRAM.run("diff", self.root / "few", self.root / "many").returncode, 0, options)
            for name in ("few", "many"):
                shutil.rmtree(self.root / name)

    def test_a_bake_without_overviews_has_the_same_cells_and_gets_them_from_a_bake_with(self):
        out = self.root / "without"
        info = self.bake("without", "--cell-voxels", 16, "--no-overviews")
        self.assertEqual(list((out / "shards").glob("p*.h5")), [])
        self.expect_same_levels(self.fine, info, levels=2)
        PROGRAM.succeed("verify", out)
        self.assertEqual(self.bake("without", "--cell-voxels", 16)["content_hash"], self.fine["content_hash"])
        for shard in sorted((self.root / "fine/shards").glob("*.h5")):
            self.assertEqual((out / "shards" / shard.name).read_bytes(), shard.read_bytes(), shard.name)

    def test_a_lost_shard_comes_back_and_nothing_else_is_written(self):
        self.bake("again", "--cell-voxels", 16)
        shards = sorted((self.root / "again/shards").glob("*.h5"))
        stamps = {p.name: p.stat().st_mtime_ns for p in shards}
        root = [p for p in shards if p.name.startswith("p")][-1]
        for lost in (root, shards[0]):
            lost.unlink()
            info = self.bake("again", "--cell-voxels", 16)
            self.assertEqual(info["content_hash"], self.fine["content_hash"])
        now = {p.name: p.stat().st_mtime_ns for p in shards}
        self.assertEqual([n for n in stamps if stamps[n] != now[n]], sorted({root.name, shards[0].name}))

    def test_a_damaged_child_is_baked_again_and_its_ancestors_are_those_of_before(self):
        out = self.root / "damaged"
        shutil.copytree(self.root / "fine", out)
        cell = sorted((out / "shards").glob("c_*.h5"))[3]
        content = bytearray(cell.read_bytes())
        content[len(content) // 4:len(content) // 2] = bytes(len(content) // 2 - len(content) // 4)
        cell.write_bytes(content)
        self.assertEqual(PROGRAM.run("verify", out).returncode, 1)
        for overview in (out / "shards").glob("p*.h5"):
            overview.unlink()
        self.assertEqual(self.bake("damaged", "--cell-voxels", 16)["content_hash"], self.fine["content_hash"])
        PROGRAM.succeed("verify", out)

    def test_a_lost_cell_leaves_a_hole_in_its_ancestors_that_is_said_until_it_is_there(self):
        out = self.root / "holed"
        shutil.copytree(self.root / "fine", out)
        cell = sorted((out / "shards").glob("c_*.h5"))[3]
        cell.unlink()
        (out / "journal").unlink()
        for overview in (out / "shards").glob("p*.h5"):
            overview.unlink()
        cell.mkdir()
        (cell / "in the way").touch()
        result = PROGRAM.run("bake", self.four, "-o", out, "--voxel-size", VOXEL_M, "--cell-voxels", 16)
        self.assertNotEqual(result.returncode, 0)
        losses = PROGRAM.info(out)["losses"]
        self.assertEqual(losses[0]["name"], "cell " + cell.name.rsplit("-", 1)[0])
        of_overviews = [loss for loss in losses if loss["name"].startswith("parent p")]
        self.assertGreaterEqual(len(of_overviews), 1)
        self.assertEqual({loss["reason"] for loss in of_overviews}, {"was made without cells below it that are lost"})
        verify = PROGRAM.run("verify", out)
        self.assertEqual(verify.returncode, 3, verify)
        self.assertIn("sound, but incomplete: 1 of 65 cells is missing", verify.stdout)
        shutil.rmtree(cell)
        self.assertEqual(self.bake("holed", "--cell-voxels", 16)["content_hash"], self.fine["content_hash"])
        self.assertEqual(PROGRAM.info(out)["losses"], [])

    def test_a_child_that_changed_beneath_its_parent_is_named(self):
        out = self.root / "changed"
        shutil.copytree(self.root / "fine", out)
        with h5py_there.h5py.File(sorted((out / "shards").glob("c_*.h5"))[0], "r+") as file:
            file.attrs["fingerprint"] = numpy.bytes_(b"0" * 32)
        result = PROGRAM.run("verify", out)
        self.assertEqual(result.returncode, 1)
        self.assertIn("fingerprint", result.stdout + result.stderr)

    def picture(self, out, *options, code=0):
        """Renders a bake before a black background. Returns the image and the finished process."""
        path = self.root / "picture.png"
        result = PROGRAM.run("render", self.root / out, "-o", path, "--size", "200x150", "--background", "0,0,0,0",
                             *options)
        self.assertEqual(result.returncode, code, result.stderr)
        return read_png(path), result

    def test_pictures_are_the_same_however_the_scene_is_cut(self):
        self.bake("cut64", "--cell-voxels", 64)
        for eye, pixel_error in (("2,-9,6", 1), ("0.1,0,20", 3), ("0.1,0,30", 8)):
            options = ("--eye=" + eye, "--target=0,0,0", "--pixel-error", pixel_error)
            fine, cut = self.picture("fine", *options)[0], self.picture("cut64", *options)[0]
            self.assertGreater((fine[..., 3] > 0).mean(), .2)
            self.assertLess((numpy.abs(fine - cut).max(2) > 2).mean(), .002, (options, f"seed {SEED}"))

    def test_a_picture_from_afar_opens_few_files_and_is_told_how_many(self):
        for distance, maximum in ((4000, 1), (400, 1)):
            output = self.picture("fine", f"--eye=0.1,0,{distance}", "--target=0,0,0")[1].stdout
            self.assertTrue(1 <= int(re.search(r"from (\d+) file", output)[1]) <= maximum, output)

    def test_a_scene_with_an_error_is_drawn_from_its_root_too(self):
        # Regression of 2026-11-25: viewers opened every cell of the scene.
        self.bake("lossy", "--cell-voxels", 16, "--max-error", 4)
        for distance, maximum in ((4000, 1), (400, 1)):
            options = (f"--eye=0.1,0,{distance}", "--target=0,0,0")
            lossy, result = self.picture("lossy", *options)
            self.assertTrue(1 <= int(re.search(r"from (\d+) file", result.stdout)[1]) <= maximum, result.stdout)
        for eye, pixel_error in (("2,-9,6", 1), ("0.1,0,20", 3), ("0.1,0,30", 8), ("0.1,0,60", 8)):
            options = ("--eye=" + eye, "--target=0,0,0", "--pixel-error", pixel_error)
            exact, lossy = self.picture("fine", *options)[0], self.picture("lossy", *options)[0]
            self.assertGreater((exact[..., 3] > 0).mean(), .05)
            self.assertLess((numpy.abs(exact - lossy).max(2) > 8).mean(), .002, (options, f"seed {SEED}"))
        PROGRAM.bake(self.four, self.root / "lossy_finer", VOXEL_M / 2, "--cell-voxels", 16, "--max-error", 4)
        self.expect_equal_copies("lossy_finer")
        queried = [PROGRAM.succeed("query", self.root / name, "--at", "0.2,0.1", "--lod", 4).splitlines()[1].split(",")
                   for name in ("fine", "lossy")]
        self.assertEqual(queried[0][10:], queried[1][10:], "level and overview")

    def test_a_cell_that_is_gone_or_damaged_is_drawn_by_its_parent(self):
        options = ("--eye=0.1,0,30", "--target=0,0,0")
        whole = self.picture("fine", *options)[0]
        for name, damage in (("gone", lambda cell: cell.unlink()), ("truncated", lambda cell: cell.write_bytes(
                cell.read_bytes()[:1000]))):
            shutil.copytree(self.root / "fine", self.root / name)
            cells = sorted((self.root / name / "shards").glob("c_0_0_*.h5"))
            self.assertGreater(len(cells), 0)
            for cell in cells:
                damage(cell)
            drawn, result = self.picture(name, *options, code=3)
            named = re.findall(r"^gigabake: rendered from coarser levels: (\S+\.h5): ", result.stderr, re.MULTILINE)
            self.assertTrue(named and set(named) <= {str(cell) for cell in cells}, "hidden cells need not be named")
            different = numpy.abs(drawn - whole).max(2) > 0
            self.assertTrue(.002 < different.mean() < .3, (name, different.mean()))
            self.assertEqual(((whole[..., 3] == 255) & (drawn[..., 3] < 200)).sum(), 0, "a hole")

    def voxels_of(self, shards, lod):
        """Returns index, colour and normal of a level's voxels in some shards, by place."""
        parts = []
        for path in shards:
            with h5py_there.h5py.File(path) as shard:
                first = int(shard.attrs["first_lod"])
                if not first <= lod < first + shard.attrs["lods"]:
                    continue
                index, rgba, normal = level_of(shard, lod - first)
                low = shard.attrs["lattice_min"]
                parts.append((index - (low >> lod - first) + (low >> lod), rgba, normal))
        index, rgba, normal = [numpy.concatenate(column) for column in zip(*parts)]
        order = numpy.lexsort(index.T)
        return index[order], rgba[order], normal[order]

    def test_copies_are_the_voxels_of_those_that_the_level_is_of(self):
        PROGRAM.bake(self.four, self.root / "finer", VOXEL_M / 2, "--cell-voxels", 16)
        self.expect_equal_copies("finer")

    def expect_equal_copies(self, name):
        shards = sorted((self.root / name / "shards").glob("*.h5"))
        tiers = {}
        for path in shards:
            with h5py_there.h5py.File(path) as shard:
                first = int(shard.attrs["first_lod"])
                tiers.setdefault(first + int(shard.attrs["copied_lods"]), [[], first])[0].append(path)
        self.assertGreaterEqual(len(tiers), 3, "cells, overviews and a root")
        copied = 0
        for own, (tier, first) in tiers.items():
            for lod in range(first, own):
                owner = max(begin for begin in tiers if begin <= lod)
                for mine, theirs in zip(self.voxels_of(tier, lod), self.voxels_of(tiers[owner][0], lod)):
                    numpy.testing.assert_array_equal(mine, theirs)
                copied += 1
        self.assertGreaterEqual(copied, 4)

    def test_what_h5py_reads_of_a_shard_is_what_the_format_says(self):
        for shard in list((self.root / "fine/shards").glob("*.h5"))[:20]:
            with h5py_there.h5py.File(shard) as file:
                above, lod = file["above"], int(file.attrs["first_lod"]) + int(file.attrs["lods"]) - 1
                voxels = len(above["place"])
                self.assertTrue((above["place"][:, 0] == 0).all())
                self.assertTrue((above["place"][:, 1:] < 8).all())
                self.assertEqual(above["rgba"].shape, (voxels, 4))
                self.assertEqual(above["raster"].shape, (voxels, 3 * min(8, 2**lod) ** 2))
                self.assertEqual(above["patch"].shape, (voxels, 8))


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
