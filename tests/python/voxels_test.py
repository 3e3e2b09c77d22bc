#!/usr/bin/env python3
"""The Python package returns the voxels that `export --to ply` writes, of all golden scenes and of bakes.

Usage: voxels_test.py GIGABAKE SOURCE_DIR
"""
import re
import shutil
import sys
import tracemalloc
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli/support"))
from package_imports import gigabake, h5py, numpy

import harness

GOLDEN = Path(sys.argv[2]) / "tests/format/golden"
VOXEL_M = 0.25
# Reading works on whole columns: it executes about 2,300 lines per cell of 20,000 voxels. A loop over voxels executes
# more.
# The goal of 5 million voxels in 5 s is measured by tools/figures (docs/python.md).
MAX_LINES_PER_CELL = 4000
MAX_BYTES_PER_VOXEL = 100  # at the peak, with the result


def solid_and_hills(path):
    """Writes bumpy ground, and a solid block of stacked squares, which gives constant nodes of several levels."""
    random = numpy.random.default_rng(7)
    grid = numpy.arange(33) * 0.5
    x, z = numpy.meshgrid(grid, grid)
    ground = numpy.stack([x, numpy.sin(x) + 0.2 * random.standard_normal(x.shape), -z], -1).reshape(-1, 3)
    layers = [[[0, y, 0], [8, y, 0], [8, y, -8], [0, y, -8]] for y in 8 + numpy.arange(33) * VOXEL_M]
    first = len(ground) + 4 * numpy.arange(33)[:, None]
    indices = numpy.concatenate([harness.squares_of_grid(33).reshape(-1), (first + [0, 1, 2, 0, 2, 3]).reshape(-1)])
    positions = numpy.concatenate([ground, numpy.reshape(layers, (-1, 3))])
    colours = random.integers(0, 256, (len(positions), 4))
    colours[len(ground):] = [200, 100, 50, 255]
    colours[:, 3] = 255
    harness.write_glb(path, positions, indices, colours)
    return path


def in_order(voxels):
    """Returns the voxels sorted by index, as harness.read_ply() returns them."""
    return voxels.where(numpy.lexsort(voxels.index.T))


class VoxelsOfThePackage(harness.FolderTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        source = solid_and_hills(cls.root / "scene.glb")
        cls.small = cls.root / "small"
        PROGRAM.bake(source, cls.small, VOXEL_M, "--cell-voxels", 64)
        PROGRAM.bake(source, cls.root / "lz4", VOXEL_M, "--cell-voxels", 64, "--codec", "lz4", "--max-error", 8)
        cls.village = cls.root / "village"
        cls.info = PROGRAM.bake(PROGRAM.sample(cls.root / "source", 128), cls.village, VOXEL_M, "--cell-voxels", 128)

    def ply(self, scene, lod):
        file = self.root / "v.ply"
        PROGRAM.succeed("export", scene, "--to", "ply", "--lod", lod, "-o", file)
        return harness.read_ply(file)

    def expect_export(self, scene_path):
        """Compares all levels with the export. Returns the number of levels."""
        scene = gigabake.open(scene_path)
        for lod in range(scene.level_count):
            with self.subTest(scene=str(scene_path), lod=lod):
                voxels, ply = in_order(scene.level(lod).region()), self.ply(scene.file, lod)
                self.assertEqual(len(voxels), len(ply))
                numpy.testing.assert_array_equal(voxels.index, ply["ijk"])
                numpy.testing.assert_array_equal(voxels.centre_scene_m, ply["p"])
                numpy.testing.assert_array_equal(voxels.rgb, ply["rgba"][:, :3])
                numpy.testing.assert_array_equal(voxels.alpha, ply["rgba"][:, 3])
                if voxels.normal is not None:
                    numpy.testing.assert_array_equal(voxels.normal, ply["n"])
                self.assertEqual("normal" in scene.channels, voxels.normal is not None)
                if voxels.classes is not None:
                    numpy.testing.assert_array_equal(voxels.classes, ply["class"])
                self.assertEqual("class" in scene.channels, voxels.classes is not None)
        return scene.level_count

    def test_golden_scenes_of_all_versions(self):
        scenes = sorted(path.parent.parent for path in GOLDEN.glob("*/shards/c_*.h5"))
        self.assertGreaterEqual(len(scenes), 7)
        for scene in scenes:
            self.assertGreaterEqual(self.expect_export(scene), 2)

    def test_constant_nodes_and_shared_values(self):
        self.assertGreater(self.expect_export(self.small), 4)

    def test_lz4_with_shared_values(self):
        self.expect_export(self.root / "lz4")
        lossless, lossy = (gigabake.open(self.root / name).level(0).region() for name in ("small", "lz4"))
        numpy.testing.assert_array_equal(lossless.index, lossy.index)

    def test_overviews_continue_the_levels_of_the_cells(self):
        scene = gigabake.open(self.village)
        self.assertGreater(scene.level_count, 5)
        self.assertEqual(self.expect_export(self.village), len(self.info["lods"]))
        self.assertTrue(any(entry.first_lod for entry in scene.xml.owners(scene.level_count - 1)))

    def paged(self):
        """Writes the village again with a page per block of 4³ cells, as docs/format.md describes pages."""
        folder = self.root / "paged"
        (folder / "pages").mkdir(parents=True)
        (folder / "shards").symlink_to(self.village / "shards")
        text = (self.village / "scene.xml").read_text(encoding="utf-8")
        head, edge, blocks = re.search(r"<OctTreeGroup [^>]*>", text).group(0), 512, {}
        cells = re.findall(r' *<PagedOctTree[^>]* TreeFile="shards/c_[^>]*/>\n', text)
        for cell in cells:
            low = numpy.array(re.search(r'LatticeMin="([^"]*)"', cell).group(1).split(), int)
            blocks.setdefault(tuple(low // edge * edge), []).append((low, cell))
            text = text.replace(cell, "")
        self.assertGreater(len(blocks), 2)
        references = ""
        same = " ".join(re.findall(r'(?:VoxelSize|LatticeOrigin|Channels)="[^"]*"', head))
        for number, (block, listed) in enumerate(blocks.items()):
            counts = numpy.array([re.search(r' Voxels="([^"]*)"', cell).group(1).split() for _, cell in listed], int)
            lows = numpy.array([low for low, _ in listed])
            sums = (f'BlockMin="{" ".join(map(str, block))}" BlockVoxels="{edge}" Cells="{len(listed)}" '
                    f'Voxels="{" ".join(map(str, counts.sum(axis=0)))}" '
                    f'LatticeMin="{" ".join(map(str, lows.min(axis=0)))}" '
                    f'LatticeEnd="{" ".join(map(str, lows.max(axis=0) + 128))}"')
            references += f'<OctTreeGroup GroupFile="pages/{number}.xml" {sums}/>\n'
            (folder / f"pages/{number}.xml").write_text(
                f'<OctTreeGroup Version="5" {same} {sums}>{"".join(cell for _, cell in listed)}</OctTreeGroup>')
        (folder / "scene.xml").write_text(text.replace(head, head + references))
        return folder

    def test_pages_list_the_same_voxels_and_only_pages_at_the_box_are_read(self):
        pages, whole = gigabake.open(self.paged()), gigabake.open(self.village)
        for lod in (2, whole.level_count - 1):
            found, expected = in_order(pages.level(lod).region()), in_order(whole.level(lod).region())
            numpy.testing.assert_array_equal(found.index, expected.index)
            numpy.testing.assert_array_equal(found.rgb, expected.rgb)
        box = [[-3, -3, -numpy.inf], [-1, -1, numpy.inf]]
        for page in (self.root / "paged/pages").glob("*.xml"):
            if not re.search(r'BlockMin="-512 -512 ', page.read_text(encoding="utf-8")):
                page.unlink()
        found = gigabake.open(self.root / "paged").level(0).region(box)
        self.assertGreater(len(found), 50)
        numpy.testing.assert_array_equal(in_order(found).index, in_order(whole.level(0).region(box)).index)

    def state_size(self, shard):
        """Edits the size of a shard in its scene.xml."""
        scene_xml = shard.parent.parent / "scene.xml"
        text, count = re.subn(rf'(TreeFile="shards/{shard.name}"[^>]* Bytes=")\d+', rf"\g<1>{shard.stat().st_size}",
                              scene_xml.read_text(encoding="utf-8"))
        self.assertEqual(count, 1)
        scene_xml.write_text(text, encoding="utf-8")

    def test_columns_are_read_at_each_level_that_has_them(self):
        folder = self.root / "more"
        shutil.copytree(GOLDEN / "version_5_scene_5", folder)
        path = folder / "shards/c_0_0_0.h5"
        with h5py.File(path, "r+") as shard:
            shard["lod_1/class"] = numpy.array([3, 4], "u1")
            shard["lod_0/facing"] = numpy.array([[1, 2, 3], [0, 0, 0], [4, 5, 6]], "u1")
            shard["lod_0/plane"] = numpy.array([8 << 2 | 1, 9 << 2 | 3, 0], "u1")
            shard["lod_0/class"] = numpy.array([7, 8, 9], "u1")
            shard["nodes/class"] = numpy.array([1, 2, 3], "u1")
            constant = int(numpy.flatnonzero(shard["nodes/kind"][:])[0])
            shard["nodes/facing"][constant] = [9, 9, 9, 10 << 2 | 2]
        self.state_size(path)
        voxels = gigabake.open(folder).level(0).region()
        self.assertEqual(len(voxels), 515)
        self.assertEqual(voxels.plane_thirds[:3].tolist(), [1, 3, 0])
        self.assertEqual(set(voxels.plane_thirds[3:].tolist()), {2})
        self.assertEqual(voxels.columns["facing"][:4].tolist(), [[1, 2, 3], [0, 0, 0], [4, 5, 6], [9, 9, 9]])
        self.assertEqual((voxels.classes[:3].tolist(), set(voxels.classes[3:].tolist())), ([7, 8, 9], {constant + 1}))
        self.assertEqual(gigabake.open(folder).level(1).region().classes.tolist(), [3, 4])
        with h5py.File(path, "r+") as shard:
            del shard["lod_0/facing"], shard["lod_0/class"]
        self.state_size(path)
        planes_only = gigabake.open(folder).level(0).region()
        self.assertEqual((planes_only.classes, planes_only.directional_coverage), (None, None))
        numpy.testing.assert_array_equal(planes_only.plane_thirds, voxels.plane_thirds)

    def test_boxes_that_share_faces_partition_the_voxels(self):
        random = numpy.random.default_rng(5)
        for path, lod in ((self.small, 0), (self.village, 0), (self.village, 2), (self.village, 6)):
            level = gigabake.open(path).level(lod)
            every = level.region()
            low, high = every.centre_scene_m.min(axis=0), every.centre_scene_m.max(axis=0)
            # One face passes exactly through centres of voxels: the tie.
            cut = [every.centre_scene_m[len(every) // 2, 0], *random.uniform(low, high)[1:]]
            found = []
            for octant in range(8):
                is_upper = [octant >> axis & 1 for axis in range(3)]
                box = [[cut[a] if is_upper[a] else -numpy.inf for a in range(3)],
                       [numpy.inf if is_upper[a] else cut[a] for a in range(3)]]
                part = level.region(box)
                inside = ((every.centre_scene_m >= box[0]) & (every.centre_scene_m < box[1])).all(axis=1)
                expected = in_order(every.where(inside))
                part = in_order(part)
                numpy.testing.assert_array_equal(part.index, expected.index)
                for name, column in expected.columns.items():
                    if len(expected):
                        numpy.testing.assert_array_equal(part.columns[name], column)
                found.append(len(part))
            self.assertEqual(sum(found), len(every))

    def test_small_boxes_have_the_same_voxels_as_a_selection_of_all(self):
        level = gigabake.open(self.village).level(0)
        every, random = level.region(), numpy.random.default_rng(6)
        for centre in every.centre_scene_m[random.integers(0, len(every), 20)]:
            box = [centre - random.uniform(0.1, 6, 3), centre + random.uniform(0.1, 6, 3)]
            inside = ((every.centre_scene_m >= box[0]) & (every.centre_scene_m < box[1])).all(axis=1)
            part, expected = in_order(level.region(box)), in_order(every.where(inside))
            self.assertGreater(len(part), 0)
            numpy.testing.assert_array_equal(part.index, expected.index)
            for name, column in expected.columns.items():
                numpy.testing.assert_array_equal(part.columns[name], column)

    def test_a_box_without_voxels_gives_empty_arrays(self):
        voxels = gigabake.open(self.village).level(1).region([[1e6, 0, 0], [1e6 + 1, 1, 1]])
        self.assertEqual((len(voxels), voxels.rgb.shape, voxels.normal.shape), (0, (0, 3), (0, 3)))

    def test_planes_lie_in_their_voxels_and_full_planes_give_the_coverage(self):
        for path in (self.village, GOLDEN / "version_5_scene_5"):
            scene = gigabake.open(path)
            voxels = scene.level(1).region()
            has_plane = voxels.plane_thirds > 0
            self.assertGreater(has_plane.sum(), 0)
            numpy.testing.assert_array_equal(numpy.isnan(voxels.plane_offset_m), ~has_plane)
            # The offset refers to |x| + |y| + |z| = 1: 7 touches the cube in every direction.
            reach_m = voxels.edge_m / 2 * abs(voxels.normal).sum(axis=1)
            ratio = voxels.plane_offset_m[has_plane] / reach_m[has_plane]
            numpy.testing.assert_allclose(ratio * 7, numpy.rint(ratio * 7), atol=1e-5)
            self.assertLessEqual(abs(ratio).max(), 1 + 1e-6)
            full = voxels.plane_thirds == 3
            coverage = voxels.directional_coverage
            numpy.testing.assert_allclose(coverage[full].max(axis=1), voxels.alpha[full] / 255, rtol=1e-6)
            steepness = abs(voxels.normal[full]) / abs(voxels.normal[full]).max(axis=1, keepdims=True)
            numpy.testing.assert_allclose(coverage[full], steepness * voxels.alpha[full, None] / 255, atol=1e-5)
            numpy.testing.assert_array_equal(coverage[~full] * 255, voxels.columns["facing"][~full])

    def test_reading_executes_lines_per_cell_and_holds_bytes_per_voxel(self):
        level = gigabake.open(self.village).level(0)
        self.assertGreater(level.voxel_count, 400_000)
        lines, package = 0, str(Path(gigabake.__file__).parent)

        def count(frame, event, _):
            nonlocal lines
            lines += event == "line"
            return count if frame.f_code.co_filename.startswith(package) else None

        sys.settrace(count)
        try:
            self.assertEqual(level.region().normal.shape, (level.voxel_count, 3))
        finally:
            sys.settrace(None)
        tracemalloc.start()
        try:
            self.assertEqual(level.region().normal.shape, (level.voxel_count, 3))
            peak_bytes = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        cells = self.info["cells"]
        print(f"{lines} lines for {cells} cells, {peak_bytes / level.voxel_count:.1f} bytes per voxel")
        self.assertLess(lines, MAX_LINES_PER_CELL * cells)
        self.assertLess(peak_bytes, MAX_BYTES_PER_VOXEL * level.voxel_count)

    def test_a_scene_with_losses_warns(self):
        copy = self.root / "lost"
        copy.mkdir()
        text = (self.small / "scene.xml").read_text(encoding="utf-8")
        lost = re.sub(r"</OctTreeGroup>\s*$", '  <Loss Name="tile" Reason="is cut"/>\n</OctTreeGroup>\n', text)
        self.assertEqual(lost.count("<Loss"), 1)
        (copy / "scene.xml").write_text(lost, encoding="utf-8")
        (copy / "shards").symlink_to(self.small / "shards")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            gigabake.open(copy).level(0).region()
        self.assertEqual([w.category for w in caught], [gigabake.IncompleteWarning])
        self.assertIn("tile: is cut", str(caught[0].message))
        self.assertEqual(caught[0].filename, __file__)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1], verbosity=2)
