"""Edits for tests: random edits of a small ground, and their effect on its voxels in whole numbers.

Shapes are rounded to 1/256 voxel once; a voxel is selected if its centre is inside.
"""
import itertools
import json
import math
from fractions import Fraction

import numpy

import harness

VOXEL_M = 0.5
SUB = 256
EDGE_M = 24.0


def write_ground(path):
    """Writes a wavy square of EDGE_M metres around the origin, with vertex colours."""
    vertices = 25
    x, y = numpy.meshgrid(*[numpy.linspace(-EDGE_M / 2, EDGE_M / 2, vertices)] * 2)
    z = 1.5 * numpy.sin(x / 3) + 1.1 * numpy.cos(y / 4)
    colours = numpy.full((vertices * vertices, 4), 255)
    colours[:, 0] = numpy.arange(vertices * vertices) % 251
    harness.write_glb(path, numpy.stack([x, z, -y], -1).reshape(-1, 3), harness.squares_of_grid(vertices), colours)


def scene_file(path, edits, place=None):
    entry = {"path": "ground.glb", "place": place or {"position_m": [0, 0, 0]}}
    path.write_text(json.dumps({"gigabake": 1, "sources": [entry], "edits": edits}))
    return path


def sub_voxels(metres):
    return math.floor(metres / VOXEL_M * SUB + 0.5)


def in_box(shape):
    low, high = ([sub_voxels(v) for v in shape[key]] for key in ("min_m", "max_m"))
    return lambda p: all(low[c] <= p[c] < high[c] for c in range(3))


def in_sphere(shape):
    centre, radius = [sub_voxels(v) for v in shape["position_m"]], sub_voxels(shape["radius_m"])
    return lambda p: sum((p[c] - centre[c]) ** 2 for c in range(3)) <= radius ** 2


def in_cylinder(shape):
    base, radius = [sub_voxels(v) for v in shape["position_m"]], sub_voxels(shape["radius_m"])
    top = sub_voxels(shape["position_m"][2] + shape["height_m"])
    return lambda p: (base[2] <= p[2] < top and sum((p[c] - base[c]) ** 2 for c in range(2)) <= radius ** 2)


def in_rings(rings, x, y):
    """Counts crossings of a ray to the east, with whole numbers."""
    inside = False
    for ring in rings:
        for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1]):
            if (ay, ax) > (by, bx):
                ax, ay, bx, by = bx, by, ax, ay
            if ay <= y < by and (bx - ax) * (y - ay) > (by - ay) * (x - ax):
                inside = not inside
    return inside


def in_prism(shape):
    rings = [[(sub_voxels(x), sub_voxels(y)) for x, y in ring] for ring in shape["rings_m"]]
    low, high = sub_voxels(shape["low_m"]), sub_voxels(shape["high_m"])
    return lambda p: low <= p[2] < high and in_rings(rings, p[0], p[1])


def in_mesh(shape):
    """Adds the windings of the triangles above a position."""
    positions = [[sub_voxels(v) for v in p] for p in shape["positions_m"]]
    triangles = [[positions[i] for i in t] for t in shape["triangles"]]

    def winding(t, p):
        turns = 0
        for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
            low, high, sign = (a, b, 1) if a[1] <= b[1] else (b, a, -1)
            if low[1] <= p[1] < high[1]:
                east_of_edge = Fraction((high[0] - low[0]) * (p[1] - low[1]), high[1] - low[1]) + low[0] > p[0]
                turns += sign * east_of_edge
        if turns == 0:
            return 0
        u, v = ([t[i][c] - t[0][c] for c in range(3)] for i in (1, 2))
        area = u[0] * v[1] - u[1] * v[0]
        x, y = p[0] - t[0][0], p[1] - t[0][1]
        z = t[0][2] + Fraction((x * v[1] - y * v[0]) * u[2] + (u[0] * y - u[1] * x) * v[2], area)
        return turns if z > p[2] else 0
    return lambda p: sum(winding(t, p) for t in triangles) != 0


SHAPES = {"box": in_box, "sphere": in_sphere, "cylinder": in_cylinder, "prism": in_prism, "mesh": in_mesh}


def bounds_m(name, shape):
    """Returns a box in metres around a shape."""
    if name == "box":
        return shape["min_m"], shape["max_m"]
    if name == "prism":
        corners = numpy.array([p for ring in shape["rings_m"] for p in ring])
        return [*corners.min(0), shape["low_m"]], [*corners.max(0), shape["high_m"]]
    if name == "mesh":
        return numpy.min(shape["positions_m"], 0), numpy.max(shape["positions_m"], 0)
    at, radius = numpy.array(shape["position_m"]), shape["radius_m"]
    return at - radius, at + max(radius, shape.get("height_m", 0))


def shape_of(edit):
    name = next(key for key in SHAPES if key in edit)
    return name, edit[name]


def centre(voxel):
    return [SUB * v + SUB // 2 for v in voxel]


def voxels_around(low, high):
    """Returns all voxels of a box in metres, with a margin."""
    ranges = [range(math.floor(low[c] / VOXEL_M) - 2, math.floor(high[c] / VOXEL_M) + 3) for c in range(3)]
    return itertools.product(*ranges)


def octahedral(n):
    """Returns the decoded unit normal of a direction."""
    x, y, z = n
    total = abs(x) + abs(y) + abs(z)
    u, v = x / total, y / total
    if z < 0:
        u, v = (1 - abs(v)) * (-1 if u < 0 else 1), (1 - abs(u)) * (-1 if v < 0 else 1)
    u, v = math.floor(u * 127 + 0.5) / 127, math.floor(v * 127 + 0.5) / 127
    z = 1 - abs(u) - abs(v)
    if z < 0:
        u, v = (1 - abs(v)) * (-1 if u < 0 else 1), (1 - abs(u)) * (-1 if v < 0 else 1)
    return numpy.array([u, v, z]) / math.sqrt(u * u + v * v + z * z)


def surface_normal(is_selected, voxel):
    """Returns the normal of a filled voxel on the surface of its shape; None of an inner voxel."""
    outside = [o for o in itertools.product((-1, 0, 1), repeat=3)
               if not is_selected(centre([voxel[c] + o[c] for c in range(3)]))]
    if not outside:
        return None
    total = numpy.sum(outside, 0)
    return octahedral(total if total.any() else (0, 0, 1))


def apply(voxels, edits):
    """Applies edits to a dictionary of (rgba, normal) by voxel."""
    voxels = dict(voxels)
    for edit in edits:
        name, shape = shape_of(edit)
        is_selected = SHAPES[name](shape)
        if edit["type"] == "fill":
            for voxel in voxels_around(*bounds_m(name, shape)):
                if is_selected(centre(voxel)):
                    voxels[voxel] = (*edit["rgb"], 255), surface_normal(is_selected, voxel)
            continue
        for voxel in [v for v in voxels if is_selected(centre(v))]:
            if edit["type"] == "carve":
                del voxels[voxel]
            else:
                rgba, normal = voxels[voxel]
                voxels[voxel] = (*edit["rgb"], edit.get("alpha", rgba[3])), normal
    return voxels


def random_edit(rng):
    """Returns an edit whose shape is near the ground. Half of all coordinates lie on centres or borders of voxels."""
    def metres(limit):
        value = rng.uniform(-limit, limit)
        return round(value / (VOXEL_M / 2)) * (VOXEL_M / 2) if rng.random() < 0.5 else value

    def length(limit):
        return abs(metres(limit)) + VOXEL_M
    type = rng.choice(("carve", "fill", "paint"))
    x, y, z = metres(EDGE_M / 2 - 2), metres(EDGE_M / 2 - 2), metres(3)
    name = rng.choice(["box", "sphere", "cylinder", "prism"])
    if name == "box":
        shape = {"min_m": [x, y, z - 3], "max_m": [x + length(5), y + length(5), z + 3]}
    elif name == "sphere":
        shape = {"position_m": [x, y, z], "radius_m": length(3) + 1}
    elif name == "cylinder":
        shape = {"position_m": [x, y, z - 3], "radius_m": length(3), "height_m": length(3) + 3}
    else:
        count = rng.randrange(3, 8)
        turns = [2 * math.pi * (i + rng.uniform(0, 0.7)) / count for i in range(count)]
        far = [[x + (r := 3 + length(3)) * math.cos(t), y + r * math.sin(t)] for t in turns]
        rings = [far] if rng.random() < 0.5 else [
            [[x - 4, y - 4], [x + 4, y - 4], [x + 4, y + 4], [x - 4, y + 4]], [[x - 1, y - 1], [x, y + 1], [x + 1, y]]]
        shape = {"rings_m": rings, "low_m": z - 3, "high_m": z + 3}
    edit = {"type": type, name: shape}
    if type != "carve":
        edit["rgb"] = [rng.randrange(256) for _ in range(3)]
    if type == "paint" and rng.random() < 0.3:
        edit["alpha"] = rng.randrange(1, 256)
    return edit
