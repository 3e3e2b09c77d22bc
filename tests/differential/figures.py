"""Flat shapes on planes through voxel centres; all their voxels and colours are known.

A shape has up to four parts, each in a cube of 6³ voxels. The borders of a part are 0.2 voxel away from the adjacent
voxels, so that rounding of coordinates does not change its voxels.
"""
from dataclasses import dataclass, field

import numpy

from odd import VOXEL

SLOT = 6
INSET = 0.2


@dataclass
class Part:
    points: numpy.ndarray            # n × 3, voxels, z up
    polygons: list                   # lists of indices of points
    cells: list                      # (i, j, k)
    colour: tuple
    place: numpy.ndarray = None  # n × 2; for a textured part: its points in units of the blocks of its image
    blocks: dict = field(default_factory=dict)  # cell -> (column, row) of the block with its colour
    kind: str = ""

    def metres(self):
        return self.points * VOXEL

    def triangles(self):
        return sum(len(p) - 2 for p in self.polygons)


def inset_outline(outline):
    """Moves each edge of a rectilinear, counterclockwise polygon inwards."""
    points = numpy.asarray(outline, float)
    out = []
    for i, point in enumerate(points):
        normals = []
        for a, b in ((points[i - 1], point), (point, points[(i + 1) % len(points)])):
            along = (b - a) / numpy.abs(b - a).sum()
            normals.append((-along[1], along[0]))
        move = numpy.sum(sorted(set(normals)), axis=0)
        out.append(point + INSET * move)
    return out


def columns_of(odd):
    """Returns lower and upper ends of columns, each of which overlaps the next."""
    width = odd.randint(1, SLOT)
    columns = [tuple(sorted(odd.sample(range(SLOT + 1), 2)))]
    while len(columns) < width:
        low, high = sorted(odd.sample(range(SLOT + 1), 2))
        if low < columns[-1][1] and high > columns[-1][0]:
            columns.append((low, high))
    return columns


def outline_of(columns):
    """Returns the counterclockwise outline, with extra corners where columns of equal height meet."""
    lower = [(x, low) for i, (low, _) in enumerate(columns) for x in (i, i + 1)]
    upper = [(x, high) for i, (_, high) in reversed(list(enumerate(columns))) for x in (i + 1, i)]
    outline = lower + upper
    return [p for i, p in enumerate(outline) if p != outline[i - 1]]


def with_spikes(odd, corners, maximum):
    """Adds corners on edges, repeated corners, and spikes, which have no area."""
    out = list(corners)
    for _ in range(odd.randint(0, maximum)):
        at = odd.randrange(len(out))
        a, b = numpy.array(out[at - 1]), numpy.array(out[at])
        kind = odd.choice(["spike", "repeat", "middle", "overshoot"])
        middle = a + (b - a) * odd.choice([0.25, 0.5, 0.75])
        if kind == "repeat":
            out.insert(at, tuple(b))
        elif kind == "middle":
            out.insert(at, tuple(middle))
        elif kind == "overshoot":
            # The spike goes along the edge beyond b and back.
            length = numpy.abs(b - a).sum()
            if length > 0:
                out[at + 1:at + 1] = [tuple(b + (b - a) / length * 0.75), tuple(b)]
        else:
            along = b - a
            out[at:at] = [tuple(middle), tuple(middle + numpy.array([along[1], -along[0]]) * 0.3), tuple(middle)]
    return out


def flat_part(odd, kind):
    """Returns points, polygons and cells of a part in the plane."""
    if kind in ("outline", "spiky", "columns"):
        columns = columns_of(odd)
        cells = [(i, j) for i, (low, high) in enumerate(columns) for j in range(low, high)]
        if kind == "columns":
            points, polygons = [], []
            for i, (low, high) in enumerate(columns):
                polygons.append([len(points) + k for k in range(4)])
                points += inset_outline([(i, low), (i + 1, low), (i + 1, high), (i, high)])
            return points, polygons, cells
        corners = [tuple(p) for p in inset_outline(outline_of(columns))]
        if kind == "spiky":
            corners = with_spikes(odd, corners, 4)
        start = odd.randrange(len(corners))
        corners = corners[start:] + corners[:start]
        points = list(dict.fromkeys(corners))
        number = {p: i for i, p in enumerate(points)}
        return points, [[number[c] for c in corners]], cells
    if kind == "textured":
        return grid_part(odd, SLOT, SLOT)
    return grid_part(odd, odd.randint(1, SLOT), odd.randint(1, SLOT))


def grid_part(odd, width, height):
    """Returns a rectangle as a grid of quadrangles that share points."""
    xs = sorted({0, width, *(odd.randrange(width) for _ in range(odd.randint(0, 3)))})
    ys = sorted({0, height, *(odd.randrange(height) for _ in range(odd.randint(0, 3)))})

    def moved(values, end):
        return [v + (INSET if v == 0 else -INSET if v == end else 0) for v in values]
    points = [(x, y) for y in moved(ys, height) for x in moved(xs, width)]
    n = len(xs)
    polygons = [[r * n + c, r * n + c + 1, (r + 1) * n + c + 1, (r + 1) * n + c]
                for r in range(len(ys) - 1) for c in range(n - 1)]
    return points, polygons, [(i, j) for i in range(width) for j in range(height)]


def in_space(odd, flat, slot, colour):
    """Puts a flat part on one of three planes of a cube. slot: the position of the cube."""
    points, polygons, cells = flat
    axis, level = odd.randrange(3), odd.randrange(SLOT)
    axes = [a for a in range(3) if a != axis]
    if odd.maybe():
        axes.reverse()
    space = numpy.empty((len(points), 3))
    space[:, axes] = points
    space[:, axis] = level + 0.5
    space += numpy.array(slot) * SLOT
    out = []
    for i, j in cells:
        cell = [0, 0, 0]
        cell[axes[0]], cell[axes[1]], cell[axis] = i, j, level
        out.append(tuple(c + SLOT * s for c, s in zip(cell, slot)))
    if odd.maybe(0.3):
        polygons = [p[::-1] for p in polygons]
    return Part(space, polygons, out, colour), axes


def add_place(odd, part, axes, slot):
    """Gives a textured part its coordinates: the middle of each 3 × 3 voxels has the colour of its image block."""
    turned, flipped = odd.maybe(), (odd.maybe(), odd.maybe())
    shift = (odd.randint(-2, 3), odd.randint(-2, 3))

    def place(points):
        uv = (numpy.asarray(points, float) - numpy.array(slot) * SLOT)[:, axes] / 3
        uv = numpy.where(flipped, 2 - uv, uv)
        return (uv[:, ::-1] if turned else uv) + shift
    part.place = place(part.points)
    for cell in part.cells:
        inside = [(cell[a] - SLOT * slot[a]) % 3 == 1 for a in axes]
        column, row = numpy.floor(place([numpy.array(cell) + 0.5])[0]).astype(int)
        part.blocks[cell] = (int(column), int(row)) if all(inside) else None


def figure(odd, kinds, max_parts=4):
    """Returns parts in different cubes of the 12³ voxels from 0 on."""
    slots = odd.sample([(x, y, z) for x in range(2) for y in range(2) for z in range(2)], odd.randint(1, max_parts))
    parts = []
    for slot in slots:
        kind = odd.choice(kinds)
        part, axes = in_space(odd, flat_part(odd, kind), slot, odd.colour())
        part.kind = kind
        if kind == "textured":
            add_place(odd, part, axes, slot)
        parts.append(part)
    return parts


def triangulated(odd, part):
    """Returns the part with its quadrangles as triangles. Outlines are not for formats of triangles."""
    if any(len(p) > 4 for p in part.polygons):
        raise ValueError("only quadrangles")
    triangles = []
    for a, b, c, d in part.polygons:
        triangles += [[a, b, c], [a, c, d]] if odd.maybe() else [[b, c, d], [b, d, a]]
    part.polygons = triangles
    return part


def voxels_of(parts, colour=None, alpha=255):
    """Returns every voxel with its colour; None: the colour is not compared."""
    return {cell: (colour or part.colour, alpha) for part in parts for cell in part.cells}
