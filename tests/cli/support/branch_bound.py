"""The bound of `bake --depth-error`, checked for each voxel that was ended. Shares no code with the program: it reads
shards with the Python package, and computes in double."""
import numpy

EXACT = 1e-6
# Unit normals of the program have 15 bits.
CHORD_ROUNDING = 1e-4


def keys_of(index):
    """Returns a number per lattice position, below 2^60."""
    return (index[:, 0] + (1 << 19)) + ((index[:, 1] + (1 << 19)) << 20) + ((index[:, 2] + (1 << 19)) << 40)


class Level:
    """The voxels of a level of a scene, sorted by position."""

    def __init__(self, scene, lod):
        voxels = scene.level(lod).region()
        keys = keys_of(voxels.index)
        order = numpy.argsort(keys)
        self.keys, self.index = keys[order], voxels.index[order]
        self.bytes = numpy.concatenate([voxels.columns[name][order].reshape(len(order), -1).view(numpy.uint8)
                                        for name in ("rgb", "alpha", "normal", "plane")], axis=1)
        self.rgb, self.alpha = voxels.rgb[order].astype(int), voxels.alpha[order]
        self.unit = voxels.normal[order].astype(float)
        self.unit /= numpy.linalg.norm(self.unit, axis=1)[:, None]
        self.octahedral = self.unit / abs(self.unit).sum(axis=1)[:, None]
        plane = voxels.columns["plane"][order].reshape(-1).astype(int)
        self.offset, self.thirds = ((plane >> 2) - 8) / 7, plane & 3
        self.is_leaf = numpy.zeros(len(order), bool) if voxels.is_leaf is None else voxels.is_leaf[order].astype(bool)

    def rows(self, index):
        """Returns the row of each position; -1 where there is no voxel."""
        keys = keys_of(index)
        row = numpy.searchsorted(self.keys, keys)
        row[row == len(self.keys)] = 0
        return numpy.where(len(self.keys) > 0 and self.keys[row] == keys, row, -1)

    def height(self, rows, axis, u, v, across, edge):
        """Returns the heights of planes along `axis`, from the centres of their voxels, which are `edge` wide."""
        n, row = self.octahedral[rows], numpy.arange(len(rows))
        slope = n[row, u] * across[0] + n[row, v] * across[1]
        along = n[row, axis]
        safe = numpy.where(along == 0, 1, along)
        return numpy.where(along == 0, numpy.inf, (self.offset[rows] * edge / 2 - slope) / safe)


def max_axis(n):
    axis = abs(n).argmax(axis=1)
    return axis, numpy.where(axis == 0, 1, 0), numpy.where(axis == 2, 1, 2)


def ended(full, stored, lod, leaves):
    """Returns the rows of `full` that `stored` lacks, and the level and row of the leaf above each."""
    missing = numpy.flatnonzero(stored[lod].rows(full[lod].index) < 0)
    leaf_lod, leaf_row = numpy.full(len(missing), -1), numpy.full(len(missing), -1)
    for above in range(lod + 1, leaves + 1):
        row = stored[above].rows(full[lod].index[missing] >> (above - lod))
        found = (row >= 0) & stored[above].is_leaf[numpy.maximum(row, 0)]
        assert not (found & (leaf_row >= 0)).any(), "two leaves describe a voxel"
        leaf_lod[found], leaf_row[found] = above, row[found]
    assert (leaf_row >= 0).all(), f"level {lod}: no leaf describes {(leaf_row < 0).sum()} voxels that are not stored"
    return missing, leaf_lod, leaf_row


def expect_bound(finer, rows, lod, leaf, leaf_rows, leaf_lod, codes):
    """Asserts that each voxel is within the bound of the leaf above it."""
    assert (finer.thirds[rows] == 3).all() and (leaf.thirds[leaf_rows] == 3).all(), "a voxel without a complete plane"
    assert lod > 0 or (finer.alpha[rows] == 255).all(), "a translucent voxel ended"
    assert abs(finer.rgb[rows] - leaf.rgb[leaf_rows]).max(initial=0) <= codes, "colour"
    chord = numpy.linalg.norm(finer.unit[rows] - leaf.unit[leaf_rows], axis=1)
    assert (chord <= 2 * codes / 255 + CHORD_ROUNDING).all(), f"normal: {chord.max() * 255 / 2}"
    # In voxels of the finer level, from the leaf's centre.
    edge = 2.0 ** (leaf_lod - lod)
    centre = finer.index[rows] + 0.5 - (leaf.index[leaf_rows] + 0.5) * edge
    axis, u, v = max_axis(leaf.octahedral[leaf_rows])
    row = numpy.arange(len(rows))
    for corner_u in (-0.5, 0.5):
        for corner_v in (-0.5, 0.5):
            own = finer.height(rows, axis, u, v, (corner_u, corner_v), 1) + centre[row, axis]
            of_leaf = leaf.height(leaf_rows, axis, u, v, (centre[row, u] + corner_u, centre[row, v] + corner_v), edge)
            assert (abs(own - of_leaf) <= codes / 8 + EXACT).all(), f"position: {abs(own - of_leaf).max()}"


def expect_coverage(finest, leaf, leaf_lod, codes):
    """Asserts that a level-0 voxel exists wherever a leaf's plane crosses the centre of a column inside the leaf."""
    rows = numpy.flatnonzero(leaf.is_leaf)
    edge = 1 << leaf_lod
    axis, u, v = max_axis(leaf.octahedral[rows])
    row = numpy.arange(len(rows))
    octant = leaf.index[rows] >> 2 << (2 + leaf_lod)
    for at_u in range(edge):
        for at_v in range(edge):
            across = (at_u + 0.5 - edge / 2, at_v + 0.5 - edge / 2)
            height = leaf.height(rows, axis, u, v, across, edge) + edge / 2
            # A plane on a face of the leaf may count on either side.
            crosses = (height > EXACT) & (height < edge - EXACT)
            exists = numpy.zeros(len(rows), bool)
            reach = codes / 8
            for step in range(-int(reach) - 1, int(reach) + 2):
                along = numpy.floor(height) + step
                is_near = (along + 1 >= height - reach - EXACT) & (along <= height + reach + EXACT)
                at = leaf.index[rows] * edge
                at[row, u] += at_u
                at[row, v] += at_v
                at[row, axis] += numpy.where(numpy.isfinite(along), along, 0).astype(int)
                inside = ((at >= octant) & (at < octant + (4 << leaf_lod))).all(axis=1)
                exists |= is_near & inside & (finest.rows(at) >= 0)
            assert (exists | ~crosses).all(), f"level {leaf_lod}: {(crosses & ~exists).sum()} columns without a voxel"


def expect_depth_error(full_scene, stored_scene, codes, coarsest=2):
    """Asserts that `stored_scene` has the voxels of `full_scene`, except voxels within the bound of a leaf. Returns the
    number of leaves of each level."""
    full = [Level(full_scene, lod) for lod in range(full_scene.level_count)]
    stored = [Level(stored_scene, lod) for lod in range(stored_scene.level_count)]
    assert len(full) == len(stored)
    for lod, level in enumerate(stored):
        row = full[lod].rows(level.index)
        assert (row >= 0).all(), f"level {lod}: a voxel that full depth lacks"
        assert (full[lod].bytes[row] == level.bytes).all(), f"level {lod}: a stored voxel differs from full depth"
        assert lod <= coarsest or len(level.keys) == len(full[lod].keys)
        assert 1 <= lod <= coarsest or not level.is_leaf.any()
    for lod in range(coarsest):
        rows, leaf_lod, leaf_row = ended(full, stored, lod, coarsest)
        for above in range(lod + 1, coarsest + 1):
            part = leaf_lod == above
            expect_bound(full[lod], rows[part], lod, stored[above], leaf_row[part], above, codes)
    for lod in range(1, coarsest + 1):
        expect_coverage(full[0], stored[lod], lod, codes)
    return [int(level.is_leaf.sum()) for level in stored]
