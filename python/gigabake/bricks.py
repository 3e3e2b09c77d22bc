"""Voxels of bricks: which exist, and the values of their channels (docs/format.md, "/lod_K").

A mask is eight words of 64 bits: bit x + 8y of word z. Sets of voxels are handled as masks, 64 voxels at a time.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy
from numpy.typing import NDArray

from .columns import Array, Column

Words = NDArray[numpy.uint64]

BRICK_VOXELS = 512
OCTANTS, GROUPS = 8, 64
# Sets of a brick that may share a value: groups, octants, the brick.
SETS = GROUPS + OCTANTS + 1
PLACES = numpy.indices((8, 8, 8)).reshape(3, -1)[::-1].T.astype(numpy.int64)
"""x, y, z of each place x + 8y + 64z."""
OCTANT = ((PLACES >> 2) @ [1, 2, 4]).astype(numpy.int32)
GROUP = (8 * OCTANT + ((PLACES >> 1 & 1) @ [1, 2, 4])).astype(numpy.int32)


@dataclass(frozen=True)
class BrickVoxels:
    """The voxels of consecutive bricks, in their stored order."""

    first_brick: int
    mask: Words                     # [brick][z]
    there: NDArray[numpy.intp]      # of each voxel: 512 · brick + place, the brick counted from first_brick
    begin: int                      # the number of voxels before first_brick
    level_voxels: int               # of the whole level

    def __len__(self) -> int:
        return len(self.there)

    def bits(self, words: Words) -> NDArray[numpy.bool_]:
        """Returns the bit of each voxel in masks of the bricks."""
        return unpacked(words).reshape(-1)[self.there].view(numpy.bool_)


def unpacked(words: Words) -> NDArray[numpy.uint8]:
    """Returns the 512 bits of each mask."""
    return numpy.unpackbits(numpy.ascontiguousarray(words, "<u8").view(numpy.uint8), axis=1, bitorder="little")


def brick_voxels(mask: Column, first: Column, begin: int, end: int) -> BrickVoxels:
    """Reads which voxels of the bricks from `begin` to `end` exist."""
    words = mask.rows(begin, end).astype(numpy.uint64)
    exists = unpacked(words)
    starts = first.rows(begin, end + 1).astype(numpy.int64)
    total = int(first.rows(len(first) - 1)[0])
    if len(first) != len(mask) + 1 or not numpy.array_equal(numpy.diff(starts), exists.sum(axis=1, dtype=numpy.int64)):
        raise first.fail("does not agree with the masks of the bricks")
    return BrickVoxels(begin, words, numpy.flatnonzero(exists), int(starts[0]), total)


def values(group: dict[str, Column], name: str, voxels: BrickVoxels) -> Array:
    """Reads a channel and returns one row per voxel. Values that voxels share are repeated."""
    column = group[name]
    if name + "_share" in group:
        return shared_values(column, group[name + "_share"], group[name + "_first"], voxels)
    if len(column) == voxels.level_voxels:
        return column.rows(voxels.begin, voxels.begin + len(voxels))
    if len(column) != 1:
        raise column.fail(f"has {len(column)} rows, expected {voxels.level_voxels} or one")
    return numpy.repeat(column.rows(), len(voxels), axis=0)


class ValueLevel:
    """One level of an open shard of versions 1 to 6."""

    def __init__(self, columns: dict[str, Column]) -> None:
        self.columns = columns

    def read(self, begin: int, end: int) -> tuple[NDArray[numpy.intp], dict[str, Array]]:
        """Returns the voxels of bricks by rising 512 · brick + place, the brick counted from `begin`, and their values."""
        voxels = brick_voxels(self.columns["mask"], self.columns["first"], begin, end)
        channels = [name for name in self.columns
                    if name not in ("mask", "first") and not name.endswith(("_share", "_first"))]
        return voxels.there, {name: values(self.columns, name, voxels) for name in channels}


def shared_values(column: Column, share: Column, first: Column, voxels: BrickVoxels) -> Array:
    """Returns the values of voxels that share them in sets: a brick, octants of 4³ and groups of 2³ voxels."""
    bricks = len(voxels.mask)
    begin, end = voxels.first_brick, voxels.first_brick + bricks
    groups, octants, whole = set_masks(share.rows(begin, end))
    repeats = followers(voxels.mask, 2) & groups
    repeats = repeats & ~octants | followers(voxels.mask, 4) & octants
    repeats = repeats & ~whole | followers(voxels.mask, 8) & whole
    # Values are stored in the order of the first voxel of each set.
    leads = voxels.bits(~repeats)
    number = numpy.cumsum(leads, dtype=numpy.int64) - 1
    starts = first.rows(begin, end + 1).astype(numpy.int64)
    stored = unpacked(voxels.mask & ~repeats).sum(axis=1, dtype=numpy.int64)
    if not numpy.array_equal(numpy.diff(starts), stored):
        raise first.fail("does not agree with the sets of voxels that share values")
    key = set_numbers(voxels, octants, whole)
    number_of_set = numpy.zeros(bricks * SETS, numpy.int64)
    in_set = numpy.flatnonzero(leads & voxels.bits(groups | octants | whole))
    number_of_set[key[in_set]] = number[in_set]
    follow = numpy.flatnonzero(~leads)
    number[follow] = number_of_set[key[follow]]
    rows: Array = column.rows(int(starts[0]), int(starts[-1]))[number]
    return rows


def set_numbers(voxels: BrickVoxels, octants: Words, whole: Words) -> NDArray[numpy.int64]:
    """Returns the number of the smallest set of each voxel that is no part of a larger set with one value."""
    place = voxels.there & (BRICK_VOXELS - 1)
    number = GROUP[place]
    is_octant, is_whole = voxels.bits(octants), voxels.bits(whole)
    number[is_octant] = GROUPS + OCTANT[place[is_octant]]
    number[is_whole] = GROUPS + OCTANTS
    key: NDArray[numpy.int64] = (voxels.there >> 9) * SETS + number
    return key


def repeated(pattern: int, bits: int) -> numpy.uint64:
    """Returns the word that repeats a pattern of this many bits."""
    return numpy.uint64(sum(pattern << at for at in range(0, 64, bits)))


def with_earlier(words: Words, stride: int, edge: int) -> Words:
    """Sets each bit if an earlier bit of its block is set. A block has `edge` bits that are `stride` bits apart."""
    for step in (1, 2, 4):
        if step < edge:
            later = repeated((1 << stride * edge) - (1 << stride * step), stride * edge)
            words = words | words << numpy.uint64(stride * step) & later
    return words


def all_of_block(words: Words, stride: int, edge: int) -> Words:
    """Sets all bits of a block if one of its bits is set."""
    words = with_earlier(words, stride, edge)
    for step in (1, 2, 4):
        if step < edge:
            earlier = repeated((1 << stride * (edge - step)) - 1, stride * edge)
            words = words | words >> numpy.uint64(stride * step) & earlier
    return words


def followers(mask: Words, edge: int) -> Words:
    """Returns which places come after an existing voxel of the same cube of this edge, in the order of the voxels."""
    one, row = numpy.uint64(1), numpy.uint64(8)
    not_first = repeated((1 << edge) - 2, edge)
    not_first_row = repeated((1 << 8 * edge) - 256, 8 * edge) if edge < 8 else numpy.uint64((1 << 64) - 256)
    found = with_earlier(mask, 1, edge) << one & not_first
    rows = all_of_block(mask, 1, edge)
    found = found | with_earlier(rows, 8, edge) << row & not_first_row
    slices = all_of_block(rows, 8, edge)
    for z in range(8):
        for below in range(z - z % edge, z):
            found[:, z] |= slices[:, below]
    return found


def set_masks(share: NDArray[numpy.uint8]) -> tuple[Words, Words, Words]:
    """Returns the voxels of groups, of octants and of bricks that have one value each, as masks."""
    bits = numpy.unpackbits(share[:, :9], axis=1, bitorder="little")
    groups, octants = bits[:, :GROUPS], bits[:, GROUPS:]
    whole = numpy.where(share[:, 9:10] != 0, numpy.uint64((1 << 64) - 1), numpy.uint64(0))
    return words_of(groups.take(GROUP, axis=1)), words_of(octants.take(OCTANT, axis=1)), numpy.repeat(whole, 8, axis=1)


def words_of(bits: NDArray[numpy.uint8]) -> Words:
    """Returns the masks of 512 bits each."""
    packed = numpy.ascontiguousarray(numpy.packbits(bits, axis=1, bitorder="little"))
    return packed.view("<u8").astype(numpy.uint64)
