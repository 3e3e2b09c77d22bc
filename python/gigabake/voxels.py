"""Voxels as arrays, and the decoding of their stored bytes."""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy
from numpy.typing import NDArray

from .columns import Array

FULL_PLANE = 3
PLANE_STEPS = 7


def octahedron_points() -> NDArray[numpy.float64]:
    """Returns for each pair of bytes u + 256 v the point with |x| + |y| + |z| = 1 (core/math/octahedral.h)."""
    byte = numpy.arange(256, dtype=numpy.uint8).view(numpy.int8) / 127.0
    x, y = numpy.meshgrid(byte, byte, indexing="ij")
    z = (1 - abs(x)) - abs(y)
    fold = z < 0
    folded_x = (1 - abs(y)) * numpy.where(x < 0, -1.0, 1.0)
    folded_y = (1 - abs(x)) * numpy.where(y < 0, -1.0, 1.0)
    points: NDArray[numpy.float64] = numpy.stack([numpy.where(fold, folded_x, x), numpy.where(fold, folded_y, y), z], -1)
    return points.transpose(1, 0, 2).reshape(-1, 3)


def octahedron_rows(octahedral: NDArray[numpy.int8]) -> NDArray[numpy.uint16]:
    """Returns the row of octahedron_points() of each normal."""
    return numpy.ascontiguousarray(octahedral).view("<u2").reshape(-1)


def lengths(points: NDArray[numpy.float64]) -> NDArray[numpy.float64]:
    """Returns the lengths of vectors, computed in the order of core/math/octahedral.h, so that no bit differs."""
    x, y, z = points.T
    result: NDArray[numpy.float64] = numpy.sqrt((x * x + y * y) + z * z)
    return result


POINTS = octahedron_points()
LENGTHS = lengths(POINTS)
UNIT_NORMALS = (POINTS / LENGTHS[:, None]).astype(numpy.float32)
MAX_COMPONENTS = abs(POINTS).max(axis=1)


@dataclass(frozen=True)
class Lattice:
    """The lattice of a level: positions are counted in voxels of level 0 from its origin."""

    lod: int
    voxel_size_m: float  # of level 0
    origin_m: NDArray[numpy.float64]

    @property
    def edge_m(self) -> float:
        """The edge of a voxel of the level."""
        return self.voxel_size_m * 2.0**self.lod

    def centres_m(self, corner: NDArray[numpy.int64]) -> NDArray[numpy.float64]:
        """Returns the centres of voxels in scene metres, rounded as `gigabake export --to ply` rounds them."""
        centre_m: NDArray[numpy.float64] = corner + 0.5 * 2.0**self.lod
        centre_m *= self.voxel_size_m
        centre_m += self.origin_m
        return centre_m


@dataclass(frozen=True)
class Voxels:
    """Voxels of one level, an array row each. All arrays have the same order.

    `columns` has the bytes as stored, by the names of docs/format.md. The other members decode them. A member is None
    if the scene or the level does not store it.
    """

    lattice: Lattice
    corner: NDArray[numpy.int64]
    """Lowest corner on the lattice: x, y, z in voxels of level 0."""
    columns: dict[str, Array]

    def __len__(self) -> int:
        return len(self.corner)

    @property
    def lod(self) -> int:
        """The level."""
        return self.lattice.lod

    @property
    def edge_m(self) -> float:
        """The edge of a voxel."""
        return self.lattice.edge_m

    @cached_property
    def index(self) -> NDArray[numpy.int64]:
        """Position on the lattice of the level: x, y, z in voxels of the level."""
        return self.corner >> self.lod if self.lod else self.corner

    @cached_property
    def centre_scene_m(self) -> NDArray[numpy.float64]:
        """Centre in the scene frame: x east, y north, z up, in metres."""
        return self.lattice.centres_m(self.corner)

    @property
    def rgb(self) -> NDArray[numpy.uint8]:
        """Colours, sRGB."""
        return self.columns["rgb"]

    @property
    def alpha(self) -> NDArray[numpy.uint8]:
        """Coverage from 1 to 255, linear."""
        return self.columns["alpha"]

    @cached_property
    def normal(self) -> NDArray[numpy.float32] | None:
        """Unit normals along the scene's axes."""
        return None if "normal" not in self.columns else UNIT_NORMALS[octahedron_rows(self.columns["normal"])]

    @property
    def is_leaf(self) -> NDArray[numpy.bool_] | None:
        """True for a voxel that describes its cube on all finer levels, which do not store it; None: no voxel does."""
        return None if "leaf" not in self.columns else self.columns["leaf"].astype(bool)

    @property
    def classes(self) -> NDArray[numpy.uint16] | None:
        """Classes; 0 for voxels of content without a class."""
        return self.columns.get("class")

    @property
    def plane_thirds(self) -> Array | None:
        """Fraction of a voxel's surface on its plane, in thirds; 0: the voxel has no plane."""
        return None if "plane" not in self.columns else self.columns["plane"] & FULL_PLANE

    @cached_property
    def plane_offset_m(self) -> NDArray[numpy.float64] | None:
        """Distance of the plane from the voxel's centre along its normal; NaN without a plane.

        The stored offset refers to a normal with |x| + |y| + |z| = 1 (core/octree/plane.h).
        """
        if "plane" not in self.columns or "normal" not in self.columns:
            return None
        plane = self.columns["plane"]
        steps = (plane >> 2 & 15).astype(numpy.float64) - 8
        offset = steps / PLANE_STEPS * (self.edge_m / 2) / LENGTHS[octahedron_rows(self.columns["normal"])]
        return numpy.where(plane & FULL_PLANE, offset, numpy.nan)

    @cached_property
    def directional_coverage(self) -> NDArray[numpy.float32] | None:
        """Coverage along x, y and z, from 0 to 1.

        A voxel whose whole surface lies on its plane stores zeros: normal and alpha then give the coverage
        (kernels/marching/surface_blend.h).
        """
        if "facing" not in self.columns:
            return None
        coverage = self.columns["facing"].astype(numpy.float32) / 255
        if "plane" in self.columns and "normal" in self.columns:
            full = numpy.flatnonzero((self.columns["plane"] & FULL_PLANE) == FULL_PLANE)
            row = octahedron_rows(self.columns["normal"][full])
            alpha = self.alpha[full, None].astype(numpy.float32) / 255
            coverage[full] = alpha * (abs(POINTS[row]) / MAX_COMPONENTS[row, None])
        return coverage

    def where(self, chosen: NDArray[Any]) -> Voxels:
        """Returns the voxels that a mask or a list of rows selects."""
        return Voxels(self.lattice, self.corner[chosen], {name: column[chosen] for name, column in self.columns.items()})


def joined(lattice: Lattice, parts: Iterable[Voxels], count: int) -> Voxels:
    """Returns the voxels of all parts. A column that only some parts have is 0 in the others.

    Raises ValueError if the parts do not have `count` voxels.
    """
    corner = numpy.empty((count, 3), numpy.int64)
    columns: dict[str, Array] = {}
    end = 0
    for part in parts:
        begin, end = end, end + len(part)
        if end > count:
            raise ValueError(f"more than {count} voxels")
        corner[begin:end] = part.corner
        for name, column in part.columns.items():
            if name not in columns:
                columns[name] = numpy.zeros((count, *column.shape[1:]), column.dtype)
            columns[name][begin:end] = column
    if end != count:
        raise ValueError(f"{end} voxels")
    return Voxels(lattice, corner, columns)
