"""Decoder of the levels of shards since version 7 (docs/format.md, "Differences").

A level is decoded in blocks of bricks. Arrays have 512 entries per brick, by Morton code: bits 0, 1 and 2 of a code are
bit 0 of x, y and z, and so on. Eight consecutive codes are a group; its parent voxel has the code without three bits.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy
from numpy.typing import NDArray

from .bricks import BRICK_VOXELS, GROUPS, PLACES
from .columns import Array, Column

BRICKS_PER_START = 64
OF_VOXELS, OF_CHILDREN, OF_FACING = 0, 1, 2
CODES = ((PLACES[:, :, None] >> numpy.arange(3) & 1) << 3 * numpy.arange(3) + numpy.arange(3)[:, None]).sum(
    axis=(1, 2))
"""The Morton code of each place x + 8y + 64z."""


@dataclass(frozen=True)
class NodeRows:
    """The nodes of one level: bricks, and constant nodes. Rows are in the order of the keys."""

    key: NDArray[numpy.uint64]
    is_brick: NDArray[numpy.bool_]
    brick: NDArray[numpy.int64]     # of each row: the number of bricks before it
    rgb: NDArray[numpy.uint8]       # of constant nodes
    normal: NDArray[numpy.uint8]


def node_rows(nodes: dict[str, Array], lod: int) -> NodeRows:
    """Returns the nodes of a level from the columns of all nodes."""
    there = nodes["lod"] == lod
    is_brick = nodes["kind"][there] == 0
    rgba = nodes["value"][there].astype("<u4").view(numpy.uint8).reshape(-1, 4)
    return NodeRows(nodes["key"][there].astype(numpy.uint64), is_brick, numpy.cumsum(is_brick) - is_brick,
                    rgba[:, :3], nodes["normal"][there].view(numpy.uint8))


@dataclass(frozen=True)
class Bricks:
    """Consecutive bricks of a level: which voxels exist, colours, and normals if the scene has them."""

    begin: int
    exists: NDArray[numpy.bool_]            # [brick][code]
    rgb: NDArray[numpy.uint8]               # [brick][code][3]
    normal: NDArray[numpy.uint8] | None     # [brick][code][2]


class Level:
    """One level of an open shard. `above` is the next coarser level, if there is one."""

    def __init__(self, columns: dict[str, Column], nodes: NodeRows, above: Level | None) -> None:
        self.columns, self.nodes, self.above = columns, nodes, above
        self.bricks = int(nodes.is_brick.sum())
        self._starts = columns["first"].rows().astype(numpy.int64)
        if len(self._starts) != -(-self.bricks // BRICKS_PER_START) + 1:
            raise columns["first"].fail(f"does not agree with /nodes, which have {self.bricks} bricks of this level")
        self.totals = self._starts[-1]
        if self._starts[0].any() or (numpy.diff(self._starts, axis=0) < 0).any():
            raise columns["first"].fail("is not ascending from 0")
        self._is_dense = int(self.totals[OF_CHILDREN]) == self.bricks * GROUPS
        self._is_complete = self.totals[OF_FACING] == self.totals[OF_VOXELS]

    def start(self, brick: int) -> NDArray[numpy.int64]:
        """Returns the first row of a brick in the three sorts of columns. Its number is a multiple of 64."""
        row: NDArray[numpy.int64] = self._starts[brick // BRICKS_PER_START]
        return row

    def decode(self, begin: int, end: int) -> Bricks:
        """Decodes bricks. `begin` is a multiple of 64."""
        parents = self._parents(begin, end)
        there = parents.exists | self._is_dense
        children = numpy.zeros(there.shape, numpy.uint8)
        children[there] = self._rows("children", OF_CHILDREN, begin, int(there.sum()))
        exists = numpy.unpackbits(children, axis=1, bitorder="little").astype(bool)
        self._expect_starts(begin, there, exists)
        count = int(exists.sum())
        rgb = numpy.repeat(parents.rgb, 8, axis=1)
        rgb[exists] += from_ycocg(self._rows("rgb", OF_VOXELS, begin, count))
        normal = None
        if parents.normal is not None:
            normal = numpy.repeat(parents.normal, 8, axis=1)
            normal[exists] += self._rows("normal", OF_VOXELS, begin, count).view(numpy.uint8)
        return Bricks(begin, exists, rgb, normal)

    def _expect_starts(self, begin: int, there: NDArray[numpy.bool_], exists: NDArray[numpy.bool_]) -> None:
        """Raises an error unless `first` states the rows of the bricks."""
        bricks = numpy.arange(0, len(exists) + 1, BRICKS_PER_START)
        if begin + len(exists) == self.bricks and bricks[-1] != len(exists):
            bricks = numpy.append(bricks, len(exists))
        starts = self._starts[-(-(begin + bricks) // BRICKS_PER_START)] - self.start(begin)
        for kind, of_brick in ((OF_VOXELS, exists), (OF_CHILDREN, there)):
            rows = numpy.concatenate([[0], numpy.cumsum(of_brick.sum(axis=1))])
            if not numpy.array_equal(starts[:, kind], rows[bricks]):
                raise self.columns["first"].fail("does not agree with the children of voxels")

    def _rows(self, name: str, kind: int, begin: int, count: int) -> Array:
        first = int(self.start(begin)[kind])
        return self.columns[name].rows(first, first + count)

    def _parents(self, begin: int, end: int) -> Bricks:
        """Returns the parent voxels of the groups of bricks: 64 per brick."""
        shape = (end - begin, GROUPS)
        exists = numpy.ones(shape, bool)
        rgb = numpy.zeros((*shape, 3), numpy.uint8)
        normal = numpy.zeros((*shape, 2), numpy.uint8) if "normal" in self.columns else None
        found = Bricks(begin, exists, rgb, normal)
        if self.above is None or begin == end:
            return found
        keys = self.nodes.key[self.nodes.is_brick][begin:end]
        above = self.above.nodes
        row = numpy.searchsorted(above.key, keys >> numpy.uint64(3))
        if (row == len(above.key)).any() or (above.key[numpy.minimum(row, len(above.key) - 1)] != keys >> 3).any():
            raise self.columns["first"].fail("has a brick without parent node")
        is_brick = above.is_brick[row]
        constant = numpy.flatnonzero(~is_brick)
        rgb[constant] = above.rgb[row[constant], None]
        if normal is not None:
            normal[constant] = above.normal[row[constant], None]
        child, brick = numpy.flatnonzero(is_brick), above.brick[row[is_brick]]
        if len(child):
            low = int(brick[0]) // BRICKS_PER_START * BRICKS_PER_START
            block = self.above.decode(low, int(brick[-1]) + 1)
            code = (keys[child] & numpy.uint64(7)).astype(numpy.int64)[:, None] * GROUPS + numpy.arange(GROUPS)
            at = (brick[:, None] - low, code)
            exists[child], rgb[child] = block.exists[at], block.rgb[at] * block.exists[at][..., None]
            if normal is not None and block.normal is not None:
                normal[child] = block.normal[at] * block.exists[at][..., None]
        return found

    def read(self, begin: int, end: int) -> tuple[NDArray[numpy.intp], dict[str, Array]]:
        """Returns the voxels of bricks by rising 512 · brick + place, the brick counted from `begin`, and their values."""
        low = begin // BRICKS_PER_START * BRICKS_PER_START
        bricks = self.decode(low, end)
        exists = bricks.exists[:, CODES]
        there = numpy.flatnonzero(exists)
        read: dict[str, Array] = {"rgb": bricks.rgb[:, CODES][exists]}
        for name in self.columns:
            if name not in ("first", "children", "rgb", "normal", "facing"):
                read[name] = self._rows(name, OF_VOXELS, low, len(there))
        if bricks.normal is not None:
            read["normal"] = bricks.normal[:, CODES][exists].view(numpy.int8)
        if "facing" in self.columns:
            read["facing"] = self._coverages(low, read)
        own = int(numpy.searchsorted(there, (begin - low) * BRICK_VOXELS))
        return there[own:] - (begin - low) * BRICK_VOXELS, {name: rows[own:] for name, rows in read.items()}

    def _coverages(self, low: int, read: dict[str, Array]) -> Array:
        """Returns the coverages along the axes, from their differences from alpha."""
        alpha = read["alpha"]
        is_planar = read["plane"] & 3 == 3 if "plane" in read else numpy.zeros(len(alpha), bool)
        stored = ~is_planar | self._is_complete
        coverage = numpy.zeros((len(stored), 3), numpy.uint8)
        predicted = numpy.where(is_planar, numpy.uint8(0), alpha)[stored, None]
        coverage[stored] = self._rows("facing", OF_FACING, low, int(stored.sum())) + predicted
        return coverage


def from_ycocg(rows: Array) -> NDArray[numpy.uint8]:
    """Returns the differences of r, g and b, modulo 256, from their YCoCg-R transform."""
    co, cg = rows[:, 1].view(numpy.int8), rows[:, 2].view(numpy.int8)
    t: NDArray[numpy.uint8] = rows[:, 0] - (cg >> 1).view(numpy.uint8)
    b = t - (co >> 1).view(numpy.uint8)
    return numpy.stack([b + co.view(numpy.uint8), t + cg.view(numpy.uint8), b], axis=1)
