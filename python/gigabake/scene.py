"""Scenes, their levels, and regions of levels as arrays."""
from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy
from numpy.typing import NDArray

from .errors import GigabakeError, IncompleteWarning
from .scene_xml import Box, SceneXml, ShardEntry
from .shard import IndexBox, LevelPart, Shard
from .voxels import Lattice, Voxels, joined

BoxM = Sequence[Sequence[float]]
"""The lowest and the highest corner of a box, each x, y, z in metres of the scene frame."""


@dataclass(frozen=True)
class Level:
    """A level of a scene: voxels of one size. Level 0 has the smallest."""

    scene: Scene
    lod: int

    @property
    def edge_m(self) -> float:
        """The edge of a voxel."""
        return self.scene.voxel_size_m * 2.0**self.lod

    @property
    def voxel_count(self) -> int:
        """The number of voxels, as scene.xml states it."""
        return self.scene.xml.voxels[self.lod]

    def region(self, box: BoxM | None = None) -> Voxels:
        """Reads the voxels whose centres lie in the box, or all voxels of the level.

        The box is half-open: a centre on its lower faces is inside, one on its upper faces is outside. Boxes that
        share a face thus have no voxel in common and miss none.
        """
        self.scene.warn_if_incomplete()
        if box is not None:
            parts = list(self._parts(box))
            return joined(self.lattice, parts, sum(map(len, parts))) if parts else self._no_voxels()
        try:
            return joined(self.lattice, self._parts(None), self.voxel_count) if self.voxel_count else self._no_voxels()
        except ValueError as error:
            raise GigabakeError(self.scene.file, "Voxels", f"states {self.voxel_count} voxels of level {self.lod}, the "
                                f"shards have {error}", "bake again") from error

    def parts(self, box: BoxM | None = None) -> Iterator[Voxels]:
        """Returns the voxels of region() in pieces, for levels that are larger than memory."""
        self.scene.warn_if_incomplete()
        return self._parts(box)

    def _parts(self, box: BoxM | None) -> Iterator[Voxels]:
        bounds_m = None if box is None else _corners(box)
        lattice_box = None if bounds_m is None else self._lattice_box(bounds_m)
        for entry in self.scene.xml.owners(self.lod, lattice_box):
            shard_box = None if lattice_box is None else self._box_in(entry, lattice_box)
            with Shard(self.scene.xml, entry) as shard:
                for part in shard.parts(self.lod, shard_box):
                    voxels = self._voxels(entry, part)
                    if bounds_m is not None:
                        centre_m = voxels.centre_scene_m
                        voxels = voxels.where(((centre_m >= bounds_m[0]) & (centre_m < bounds_m[1])).all(axis=1))
                    if len(voxels):
                        yield voxels

    @property
    def lattice(self) -> Lattice:
        """The positions of the level's voxels."""
        return Lattice(self.lod, self.scene.voxel_size_m, self.scene.lattice_origin_m)

    def _voxels(self, entry: ShardEntry, part: LevelPart) -> Voxels:
        corner = part.index << self.lod
        corner += numpy.array(entry.window.low, numpy.int64)
        return Voxels(self.lattice, corner, part.columns)

    def _lattice_box(self, bounds_m: NDArray[numpy.float64]) -> Box:
        """Returns a box of the lattice that contains all voxels whose centres lie in the bounds."""
        origin_m, size_m = self.scene.lattice_origin_m, self.scene.voxel_size_m
        far = float(1 << 60)
        low = numpy.clip(numpy.floor((bounds_m[0] - origin_m) / size_m) - 2.0**self.lod, -far, far)
        end = numpy.clip(numpy.ceil((bounds_m[1] - origin_m) / size_m) + 2.0**self.lod, -far, far)
        (x, y, z), (end_x, end_y, end_z) = low.astype(int).tolist(), end.astype(int).tolist()
        return Box((x, y, z), (end_x, end_y, end_z))

    def _box_in(self, entry: ShardEntry, box: Box) -> IndexBox:
        """Returns the box in voxels of the level from the shard's corner, rounded outwards."""
        corner = numpy.array(entry.window.low, numpy.int64)
        return IndexBox(numpy.array(box.low, numpy.int64) - corner >> self.lod,
                        (numpy.array(box.end, numpy.int64) - corner >> self.lod) + 1)

    def _no_voxels(self) -> Voxels:
        columns: dict[str, NDArray[Any]] = {"rgb": numpy.zeros((0, 3), numpy.uint8), "alpha": numpy.zeros(0, numpy.uint8)}
        if "normal" in self.scene.channels:
            columns["normal"] = numpy.zeros((0, 2), numpy.int8)
        return Voxels(self.lattice, numpy.zeros((0, 3), numpy.int64), columns)


class Scene:
    """A scene that a bake wrote. Files are read when regions are requested; none stays open."""

    def __init__(self, path: Path | str) -> None:
        path = Path(path)
        self.xml = SceneXml(path / "scene.xml" if path.is_dir() else path)
        self.file = self.xml.file
        self.voxel_size_m = self.xml.voxel_size_m
        self.channels = self.xml.channels
        self.parameters = self.xml.parameters
        self.origin = self.xml.origin
        """Latitude and longitude in degrees, and height in metres (WGS84) of the scene frame; None: a local scene."""
        self.losses = self.xml.listing.losses
        """Name and reason of each cell or input that the bake could not deliver; a complete bake has none."""

    @cached_property
    def lattice_origin_m(self) -> NDArray[numpy.float64]:
        """The corner of voxel (0, 0, 0) in the scene frame."""
        return numpy.array(self.xml.lattice_origin_m)

    @property
    def level_count(self) -> int:
        """The number of levels, with the levels of overviews."""
        return self.xml.levels()

    @property
    def box_m(self) -> NDArray[numpy.float64] | None:
        """The lowest and the highest corner of all surfaces, or of the cells if the scene does not state the former."""
        box = self.xml.bounds or self.xml.window
        return None if box is None else self.lattice_origin_m + numpy.array([box.low, box.end]) * self.voxel_size_m

    def level(self, lod: int) -> Level:
        """Returns a level. Its shards are cells, or overviews above the coarsest level of the cells."""
        if not 0 <= lod < self.level_count:
            raise GigabakeError(self.file, f"level {lod}", "does not exist",
                                f"expected a level from 0 to {self.level_count - 1}")
        return Level(self, lod)

    def warn_if_incomplete(self) -> None:
        """Warns if the bake lost cells or inputs."""
        if self.losses:
            name, reason = self.losses[0]
            warnings.warn(f"{self.file}: {len(self.losses)} cells or inputs are missing, the first is {name}: {reason}",
                          IncompleteWarning, stacklevel=3)


def _corners(box: BoxM) -> NDArray[numpy.float64]:
    bounds = numpy.asarray(box, numpy.float64)
    if bounds.shape != (2, 3) or numpy.isnan(bounds).any():
        raise ValueError(f"expected a box ((x, y, z), (x, y, z)) in metres, not {box!r}")
    return bounds


def open(path: Path | str) -> Scene:  # pylint: disable=redefined-builtin
    """Opens the scene of a folder, or of its scene.xml. Reads no shard."""
    return Scene(path)
