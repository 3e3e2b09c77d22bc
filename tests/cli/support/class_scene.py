"""Small sources with classes, whose surfaces are flat and aligned to voxels, so that their areas are exact; tests that
bake them."""
import json
from fractions import Fraction

import numpy

import harness

EDGE = 48  # of the scene, metres; a voxel is one metre


class ClassTest(harness.FolderTest):
    """A test that compares the classes of voxels. Its script sets PROGRAM."""
    PROGRAM = None

    @classmethod
    def scene_file(cls, name, sources, **members):
        path = cls.root / f"{name}.json"
        path.write_text(json.dumps({"gigabake": 1, "sources": sources, **members}))
        return path

    @classmethod
    def bake(cls, name, source, *options, ranks=None):
        cls.PROGRAM.succeed("bake", source, "-o", cls.root / name, "--voxel-size", 1, "--local", *(options or
                            ("--cell-voxels", 64)), "-q", ranks=ranks)
        cls.PROGRAM.succeed("verify", cls.root / name)
        return cls.PROGRAM.info(cls.root / name)

    def classes(self, name, lod=0):
        """Returns the class of each voxel of a level, in the order of the PLY."""
        file = self.root / "v.ply"
        self.PROGRAM.succeed("export", self.root / name, "--lod", lod, "-o", file)
        header, body = file.read_bytes().split(b"end_header\n", 1)
        self.assertIn(b"property ushort class\n", header)
        vertices = numpy.frombuffer(body, harness.PLY_VERTEX_WITH_CLASS)
        return {tuple(v["ijk"].tolist()): int(v["class"]) for v in vertices}

    def expect_equal(self, found, expected, message=""):
        """Compares two maps of voxels. A failure prints a few differences; assertEqual() would take minutes."""
        differing = [(at, found.get(at), expected.get(at)) for at in sorted({*found, *expected})
                     if found.get(at) != expected.get(at)]
        self.assertEqual(differing[:5], [], message)


def write_gltf(path, primitives, materials=(), members=None, instances=None, features=None):
    """Writes a GLB. A primitive has positions (y up), and optionally ids by attribute (or texture coordinates, with two
    numbers per vertex), a material, and extensions. `members` are further members of the document. `instances` are
    attributes of EXT_mesh_gpu_instancing, and `features` are the sets of EXT_instance_features."""
    binary, views, accessors, entries = b"", [], [], []

    def add(data, component, kind, **more):
        nonlocal binary
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": data.nbytes})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(data), "type": kind,
                          **more})
        binary += data.tobytes() + b"\0" * (-data.nbytes % 4)
        return len(accessors) - 1

    def add_floats(items):
        values = numpy.asarray(items, "<f4")
        return add(values, 5126, "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}")

    for primitive in primitives:
        points = numpy.asarray(primitive["points"], "<f4")
        attributes = {"POSITION": add(points, 5126, "VEC3", min=points.min(0).tolist(), max=points.max(0).tolist())}
        for name, ids in primitive.get("ids", {}).items():
            attributes[name] = add_floats(ids)
        entry = {"attributes": attributes}
        for key in ("material", "extensions"):
            if key in primitive:
                entry[key] = primitive[key]
        entries.append(entry)
    node = {"mesh": 0}
    if instances is not None:
        attributes = {name: add_floats(items) for name, items in instances.items()}
        node["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes},
                              "EXT_instance_features": {"featureIds": features}}
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [node],
                "meshes": [{"primitives": entries}], "accessors": accessors, "bufferViews": views,
                "buffers": [{"byteLength": len(binary)}],
                "extensionsUsed": ["EXT_mesh_features", *node.get("extensions", ())], **(members or {})}
    if materials:
        document["materials"] = [{"name": name} for name in materials]
    harness.write_glb_document(path, document, binary)


def tile(x, y, width, depth, height):
    """Returns two triangles of a level rectangle: x east, y north, at a height, in metres; glTF's axes."""
    a, b, c, d = ((x + dx, height, -(y + dy)) for dx, dy in ((0, 0), (width, 0), (width, depth), (0, depth)))
    return [a, b, c, a, c, d]


def mosaic(random, height, classes, step=0.25):
    """Returns rectangles that cover the scene, at one height, with ids; and the area of each id per voxel column."""
    points, ids, areas = [], [], {}
    at = 0
    while at < EDGE:
        width = int(random.integers(1, 12)) * step
        width = min(width, EDGE - at)
        row = 0.0
        while row < EDGE:
            depth = min(int(random.integers(1, 12)) * step, EDGE - row)
            number = int(random.integers(0, classes))
            points += tile(at, row, width, depth, height)
            ids += [number] * 6
            for x in range(int(at), int(numpy.ceil(at + width))):
                for y in range(int(row), int(numpy.ceil(row + depth))):
                    along = min(x + 1, at + width) - max(x, at), min(y + 1, row + depth) - max(y, row)
                    of_voxel = areas.setdefault((x, y, int(numpy.floor(height))), {})
                    of_voxel[number] = of_voxel.get(number, 0) + Fraction(along[0]) * Fraction(along[1])
            row += depth
        at += width
    return points, ids, areas


def majority(areas):
    """Returns the class with the largest area; of equal areas the lowest."""
    return min(areas, key=lambda number: (-areas[number], number))
