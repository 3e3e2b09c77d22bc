"""Reader of one level of one shard (docs/format.md, "A shard"): bricks, and constant nodes expanded to voxels."""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy
from numpy.typing import NDArray

from . import differences
from .bricks import BRICK_VOXELS, OCTANT, PLACES, ValueLevel
from .columns import Array, Column
from .errors import BAKE_AGAIN, NEWER_PROGRAM, GigabakeError, damage_of
from .scene_xml import BRICK_EDGE, SceneXml, ShardEntry

OLDEST_SHARD_VERSION, NEWEST_SHARD_VERSION = 1, 9
FIRST_VERSION_OF_DIFFERENCES = 7
FIRST_VERSION_OF_LEAVES = 8
FIRST_VERSION_OF_CLASSES = 9
BRICK, LEAF_CONSTANT = 0, 2
# Columns of /nodes that do not describe the voxels of constant nodes.
STRUCTURE = {"key", "lod", "kind", "child_mask", "first_child", "leaf_mask"}
# Bounds the memory of one step: a brick takes 512 bytes and at most 512 voxels.
MAX_BRICKS_AT_ONCE = 1 << 12
MAX_BLOCKS_AT_ONCE = 1 << 11
# Bricks between two requested ones that are read too, since a chunk holds many bricks.
MAX_GAP = 64


@dataclass(frozen=True)
class IndexBox:
    """A half-open box of a level, in voxels of the level from the shard's corner."""

    low: NDArray[numpy.int64]
    end: NDArray[numpy.int64]


@dataclass(frozen=True)
class LevelPart:
    """Some voxels of a level of a shard."""

    index: NDArray[numpy.int64]  # in voxels of the level from the shard's corner
    columns: dict[str, Array]


def gathered_bits(keys: NDArray[numpy.uint64]) -> NDArray[numpy.int64]:
    """Returns the numbers whose bits are every third bit of the keys, as gather_bits in core/octree/morton.h."""
    bits = keys & numpy.uint64(0x1249249249249249)
    for shift, mask in ((2, 0x10C30C30C30C30C3), (4, 0x100F00F00F00F00F), (8, 0x1F0000FF0000FF),
                        (16, 0x1F00000000FFFF), (32, 0x1FFFFF)):
        bits = (bits | bits >> numpy.uint64(shift)) & numpy.uint64(mask)
    return bits.astype(numpy.int64)


def from_morton(keys: NDArray[numpy.uint64]) -> NDArray[numpy.int64]:
    """Returns x, y, z of Morton keys."""
    return numpy.stack([gathered_bits(keys >> numpy.uint64(axis)) for axis in range(3)], axis=-1)


def runs_of(numbers: NDArray[numpy.int64]) -> Iterator[tuple[int, int]]:
    """Yields half-open ranges that contain the ascending numbers, without long gaps and not too long."""
    cuts = numpy.flatnonzero(numpy.diff(numbers) > MAX_GAP) + 1
    for run in numpy.split(numbers, cuts):
        if len(run):
            low, end = int(run[0]), int(run[-1]) + 1
            for begin in range(low, end, MAX_BRICKS_AT_ONCE):
                yield begin, min(end, begin + MAX_BRICKS_AT_ONCE)


class Shard:
    """An open shard. Its attributes are compared with scene.xml, and its size with the size that scene.xml states."""

    def __init__(self, scene: SceneXml, entry: ShardEntry) -> None:
        self.file = entry.file
        self.entry = entry
        self._expect_size(scene.file)
        with damage_of(entry.file, ""):
            self._hdf5 = h5py.File(entry.file, "r")
        try:
            self._expect_version()
            self._expect_entry(scene)
        except BaseException:
            self._hdf5.close()
            raise

    def __enter__(self) -> Shard:
        return self

    def __exit__(self, *_: object) -> None:
        self._hdf5.close()

    def _expect_size(self, scene_xml: Path) -> None:
        try:
            size = self.file.stat().st_size
        except FileNotFoundError:
            raise GigabakeError(self.file, "", f"is missing, but {scene_xml} lists it",
                                "copy it from where the scene was baked, or bake again") from None
        except OSError as error:
            raise GigabakeError(self.file, "", f"cannot be read: {error.strerror}", "check the file") from error
        if size != self.entry.bytes:
            raise GigabakeError(self.file, "", f"has {size} bytes, but {scene_xml} states {self.entry.bytes}",
                                "the file was cut or replaced: copy it again, or bake again")

    def _attribute(self, name: str) -> Any:
        with damage_of(self.file, name):
            value = self._hdf5.attrs[name]
        return value.decode("utf-8", "replace") if isinstance(value, bytes) else value

    def _expect_version(self) -> None:
        if self._attribute("format") != "gigabake-shard":
            raise GigabakeError(self.file, "format", "is no shard of gigabake", BAKE_AGAIN)
        with damage_of(self.file, "version"):
            self.version = int(self._attribute("version"))
        if not OLDEST_SHARD_VERSION <= self.version <= NEWEST_SHARD_VERSION:
            raise GigabakeError(self.file, "version", f"is {self.version}; this package reads {OLDEST_SHARD_VERSION} "
                                                      f"to {NEWEST_SHARD_VERSION}", NEWER_PROGRAM)

    def _expect_entry(self, scene: SceneXml) -> None:
        """Raises an error if the shard is another one than scene.xml lists."""
        entry = self.entry
        expected: dict[str, Any] = {
            "cell": entry.name, "lattice_min": entry.window.low, "lods": entry.lods,
            "cell_voxels": entry.window.end[0] - entry.window.low[0], "voxel_size_m": scene.voxel_size_m,
            "lattice_origin_m": scene.lattice_origin_m, "brick_edge": BRICK_EDGE,
            "channels": " ".join(scene.channels), "triangles": entry.triangles,
            "fingerprint": entry.fingerprint, "content_hash": " ".join(entry.content_hash)}
        if self.version >= 4:
            expected["first_lod"] = entry.first_lod
        if self.version >= 5:
            expected["copied_lods"] = entry.copied_lods
        for name, value in expected.items():
            if not numpy.array_equal(self._attribute(name), value):
                raise GigabakeError(self.file, name, f"differs from {scene.file}", BAKE_AGAIN)

    def _columns(self, group: str) -> dict[str, Column]:
        with damage_of(self.file, "/" + group):
            items = self._hdf5[group]
            # Not items(), which silently skips damaged datasets.
            return {name: Column(self.file, items[name]) for name in items}

    def _column(self, columns: dict[str, Column], group: str, name: str) -> Column:
        if name not in columns:
            raise GigabakeError(self.file, f"/{group}/{name}", "is missing", BAKE_AGAIN)
        return columns[name]

    def parts(self, lod: int, box: IndexBox | None) -> Iterator[LevelPart]:
        """Yields the voxels of a level of the lattice, at least those in the box."""
        with damage_of(self.file, f"/lod_{lod - self.entry.first_lod}"):
            yield from self._parts(lod - self.entry.first_lod, box)

    def _parts(self, own_lod: int, box: IndexBox | None) -> Iterator[LevelPart]:
        columns = self._columns("nodes")
        nodes = {name: self._column(columns, "nodes", name).rows()
                 for name in ("key", "lod", "kind", "value", "normal")}
        if len({len(column) for column in nodes.values()}) != 1:
            raise GigabakeError(self.file, "/nodes", "has columns of different lengths", BAKE_AGAIN)
        if self.version >= FIRST_VERSION_OF_CLASSES:
            classes = self._column(columns, "nodes", "class")
            if len(classes) != len(nodes["lod"]):
                raise classes.fail("has another length than /nodes/lod")
        leaves = self._leaves(columns, nodes) if self._has_leaves() else None
        there = (nodes["lod"] == own_lod) | ((nodes["lod"] > own_lod) & (nodes["kind"] == LEAF_CONSTANT))
        rows = numpy.flatnonzero(there)
        down = nodes["lod"][rows].astype(numpy.int64) - own_lod
        edge = BRICK_EDGE << down
        low = from_morton(nodes["key"][rows].astype(numpy.uint64)) * edge[:, None]
        is_brick = nodes["kind"][rows] == BRICK
        level = self._level(own_lod, nodes) if self.version >= FIRST_VERSION_OF_DIFFERENCES else None
        self._expect_count(own_lod, level, edge[~is_brick], nodes["value"][rows[is_brick]])
        if box is not None:
            inside = ((low < box.end) & (low + edge[:, None] > box.low)).all(axis=1)
            rows, edge, low, is_brick = rows[inside], edge[inside], low[inside], is_brick[inside]
        numbers = nodes["value"][rows[is_brick]].astype(numpy.int64)
        yield from self._brick_parts(level or ValueLevel(self._level_columns(own_lod)), numbers, low[is_brick],
                                     None if leaves is None else leaves[rows[is_brick]])
        constant = rows[~is_brick]
        looks = {name: columns[name].rows()[constant] for name in columns if name not in STRUCTURE}
        if leaves is not None:
            looks["leaf"] = leaves[constant]
        yield from self._constant_parts(own_lod, looks, edge[~is_brick], low[~is_brick], box)

    def _has_leaves(self) -> bool:
        return self.version == FIRST_VERSION_OF_LEAVES or \
            (self.version >= FIRST_VERSION_OF_CLASSES and "leaf_lod" in self._hdf5.attrs)

    def _leaves(self, columns: dict[str, Column], nodes: dict[str, Array]) -> Array:
        """Returns the octants of each node that are leaves, as bits; none of nodes that allow no leaves."""
        column = self._column(columns, "nodes", "leaf_mask")
        leaves = column.rows()
        child_mask = self._column(columns, "nodes", "child_mask").rows()
        if len(leaves) != len(nodes["lod"]) or len(child_mask) != len(leaves):
            raise column.fail("has another length than /nodes/lod")
        above = nodes["lod"].astype(numpy.int64) + self.entry.first_lod > int(self._attribute("leaf_lod"))
        if ((leaves & child_mask) != 0).any() or leaves[above | (nodes["lod"] == 0)].any():
            raise column.fail("has leaves where the shard allows none")
        return leaves

    def _level_columns(self, own_lod: int) -> dict[str, Column]:
        """Returns the columns of a level. Raises an error if one without which no voxel can be read is missing."""
        name = f"lod_{own_lod}"
        columns = self._columns(name)
        needed = ["first", "mask"]
        if self.version >= FIRST_VERSION_OF_DIFFERENCES:
            needed = ["first", "children", "rgb", "alpha",
                      *(channel for channel in ("normal", "class") if channel in self._channels())]
        for each in needed:
            self._column(columns, name, each)
        return columns

    def _channels(self) -> list[str]:
        return str(self._attribute("channels")).split()

    def _level(self, own_lod: int, nodes: dict[str, Array]) -> differences.Level:
        """Opens a level since version 7."""
        level: differences.Level | None = None
        for lod in range(self.entry.lods - 1, own_lod - 1, -1):
            level = differences.Level(self._level_columns(lod), differences.node_rows(nodes, lod), level)
        assert level is not None
        return level

    def _expect_count(self, own_lod: int, level: differences.Level | None, constant_edges: NDArray[numpy.int64],
                      numbers: Array) -> None:
        """Raises an error unless bricks are numbered in order, and the level has the voxels that scene.xml states."""
        first = self._level_columns(own_lod)["first"]
        bricks = level.bricks if level else len(first) - 1
        if bricks != len(numbers) or not numpy.array_equal(numbers, numpy.arange(len(numbers))):
            raise first.fail(f"does not agree with /nodes, which have {len(numbers)} bricks of this level")
        of_bricks = int(level.totals[differences.OF_VOXELS]) if level else int(first.rows(len(numbers))[0])
        voxels = of_bricks + int((constant_edges**3).sum())
        if voxels != self.entry.voxels[own_lod]:
            raise first.fail(f"the level has {voxels} voxels, scene.xml states {self.entry.voxels[own_lod]}")

    @staticmethod
    def _brick_parts(level: differences.Level | ValueLevel, numbers: NDArray[numpy.int64],
                     low: NDArray[numpy.int64], leaves: Array | None) -> Iterator[LevelPart]:
        """Yields the voxels of bricks with these numbers, lowest corners and masks of leaves."""
        for begin, end in runs_of(numbers):
            there, read = level.read(begin, end)
            corner = numpy.full((end - begin, 3), -1, numpy.int64)
            chosen = (numbers >= begin) & (numbers < end)
            corner[numbers[chosen] - begin] = low[chosen]
            brick = there // BRICK_VOXELS
            if leaves is not None:
                of_brick = numpy.zeros(end - begin, numpy.uint8)
                of_brick[numbers[chosen] - begin] = leaves[chosen]
                read["leaf"] = of_brick[brick] >> OCTANT[there % BRICK_VOXELS].astype(numpy.uint8) & 1
            index = corner[brick] + PLACES[there % BRICK_VOXELS]
            if len(numbers[chosen]) < end - begin:  # gaps were read too
                wanted = corner[brick, 0] >= 0
                index, read = index[wanted], {channel: rows[wanted] for channel, rows in read.items()}
            yield LevelPart(index, split_rgba(read))

    def _constant_parts(self, own_lod: int, looks: dict[str, Array], edges: NDArray[numpy.int64],
                        low: NDArray[numpy.int64], box: IndexBox | None) -> Iterator[LevelPart]:
        """Yields the voxels of constant nodes: of each block of 8³ voxels that overlaps the box."""
        group = self._hdf5[f"lod_{own_lod}"]
        rgba = looks["value"].astype("<u4").view(numpy.uint8).reshape(-1, 4)
        columns = {"rgb": rgba[:, :3], "alpha": rgba[:, 3]}
        columns.update({name: look for name, look in looks.items() if name in group})
        leaves = looks.get("leaf")
        if "facing" in columns:
            columns["facing"] = columns["facing"][:, :3]
        if "plane" in group and "facing" in looks and looks["facing"].shape[1] > 3:
            columns["plane"] = looks["facing"][:, 3]
        corner, node = blocks_of(low, edges, box)
        for begin in range(0, len(node), MAX_BLOCKS_AT_ONCE):
            some = slice(begin, begin + MAX_BLOCKS_AT_ONCE)
            index = (corner[some, None] + PLACES).reshape(-1, 3)
            part = {name: numpy.repeat(column[node[some]], BRICK_VOXELS, axis=0) for name, column in columns.items()}
            if leaves is not None:
                part["leaf"] = (leaves[node[some], None] >> OCTANT.astype(numpy.uint8) & 1).reshape(-1)
            yield LevelPart(index, part)


def blocks_of(low: NDArray[numpy.int64], edges: NDArray[numpy.int64],
              box: IndexBox | None) -> tuple[NDArray[numpy.int64], NDArray[numpy.int64]]:
    """Returns the corners of the blocks of 8³ voxels of cubes, as far as they overlap the box, and each one's cube."""
    small = numpy.flatnonzero(edges == BRICK_EDGE)
    corners, cubes = [low[small]], [small]
    for cube in numpy.flatnonzero(edges > BRICK_EDGE):
        begin, end = low[cube], low[cube] + edges[cube]
        if box is not None:
            begin, end = numpy.maximum(begin, box.low & ~(BRICK_EDGE - 1)), numpy.minimum(end, box.end)
        counts = -(-(end - begin) // BRICK_EDGE)
        corners.append(begin + BRICK_EDGE * numpy.indices(counts).reshape(3, -1).T)
        cubes.append(numpy.full(len(corners[-1]), cube, numpy.int64))
    return numpy.concatenate(corners), numpy.concatenate(cubes)


def split_rgba(columns: dict[str, Array]) -> dict[str, Array]:
    """Splits the column rgba of version 1 into the columns that later versions have."""
    if "rgba" not in columns:
        return columns
    rgba = columns.pop("rgba")
    return {"rgb": rgba[:, :3], "alpha": rgba[:, 3], **columns}
