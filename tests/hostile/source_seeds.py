"""Small complete scenes of every format that a bake reads, from which mutants are made."""
import io
import json
import struct
import zipfile
from dataclasses import dataclass, field

import made_seeds as made
import packed_seeds as packed


@dataclass
class Seed:
    """A folder. `documents` has JSON values that are written with the mutant; `wrap` converts the text to a file."""
    name: str
    main: str  # the file that the program opens
    files: dict = field(default_factory=dict)      # name: bytes
    documents: dict = field(default_factory=dict)  # name: (value, wrap)
    voxel_size: float = 0.5


def glb_of(binary=made.POSITIONS + made.INDICES):
    return lambda text: glb_around(text, binary)


def glb_around(text, binary):
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def in_chunk():
    """Returns a square whose buffer is the binary chunk."""
    document = made.square()
    document["buffers"] = [{"byteLength": len(made.POSITIONS + made.INDICES)}]
    return document


def external_picture(name, content, kind):
    document = made.textured(content, kind)
    document["images"] = [{"uri": name}]
    return document


def tile_files(kind, *more):
    """Returns a tile of 3D Tiles 1.0 around a GLB. Its feature table is the document."""
    model = glb_of()(made.text(in_chunk()))

    def wrap(binary):
        def around(text):
            text += b" " * (-len(text) % 8)
            head = 28 + 4 * len(more)
            whole = head + len(text) + len(binary) + len(model)
            return (kind + struct.pack("<6I", 1, whole, len(text), len(binary), 0, 0) +
                    struct.pack(f"<{len(more)}I", *more) + text + binary + model)
        return around
    return wrap


def tileset_around(uri, **more):
    return made.tileset(made.tile(content={"uri": uri}, **more))


def gltf_seeds():
    pictures = {"p.png": (made.png(8), "image/png"), "p.jpg": (packed.JPEG, "image/jpeg"),
                "p.webp": (packed.WEBP, "image/webp")}
    yield Seed("glb", "a.glb", documents={"a.glb": (in_chunk(), glb_of())})
    yield Seed("gltf and bin", "a.gltf", {"data.bin": made.POSITIONS + made.INDICES},
               {"a.gltf": ({**made.square(), "buffers": [{"byteLength": 60, "uri": "data.bin"}]}, bytes)})
    yield Seed("sparse and instanced", "a.gltf", documents={"a.gltf": (made.sparse(), bytes)})
    yield Seed("draco", "a.gltf", documents={"a.gltf": (made.draco(packed.DRACO_EDGEBREAKER), bytes)})
    yield Seed("meshopt", "a.gltf", documents={"a.gltf": (made.meshopt(), bytes)})
    for name, (content, kind) in pictures.items():
        yield Seed(name, "a.gltf", {name: content}, {"a.gltf": (external_picture(name, content, kind), bytes)})


def tile_seeds():
    columns = struct.pack("<20f", 1, 2, 3, 4, 5, 6, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 0, 2, 3)
    instances = {"INSTANCES_LENGTH": 2, "POSITION": {"byteOffset": 0}, "NORMAL_UP": {"byteOffset": 24},
                 "NORMAL_RIGHT": {"byteOffset": 48}, "SCALE": {"byteOffset": 72}}
    points = {"POINTS_LENGTH": 2, "POSITION": {"byteOffset": 0}}
    yield Seed("b3dm", "a.b3dm", documents={"a.b3dm": ({"BATCH_LENGTH": 0, "RTC_CENTER": [1, 2, 3]},
                                                      tile_files(b"b3dm")(b""))})
    yield Seed("i3dm", "a.i3dm", documents={"a.i3dm": (instances, tile_files(b"i3dm", 1)(columns))})
    yield Seed("pnts", "t.json", documents={"a.pnts": (points, tile_files(b"pnts")(columns)),
                                            "t.json": (tileset_around("a.pnts"), bytes)})
    inner = b"".join([made.b3dm(), made.i3dm()[0]])
    yield Seed("cmpt", "a.cmpt", {"a.cmpt": b"cmpt" + struct.pack("<3I", 1, 16 + len(inner), 2) + inner})


def tileset_seeds():
    glb = {"model.gltf": made.text(made.square()), "a.glb": glb_of()(made.text(in_chunk()))}
    nested = made.tileset(made.tile(children=[made.tile(refine="ADD", content={"uri": "a.glb"}),
                                              made.tile(content={"uri": "inner.json"})]))
    yield Seed("tileset", "t.json", glb, {"t.json": (nested, bytes), "inner.json": (tileset_around("a.glb"), bytes)})
    whole, _ = made.subtrees()
    implicit = {"subdivisionScheme": "OCTREE", "subtreeLevels": 3, "availableLevels": 4,
                "subtrees": {"uri": "all.subtree"}}
    yield Seed("implicit", "t.json", {**glb, "all.subtree": whole},
               {"t.json": (tileset_around("a.glb", implicitTiling=implicit), bytes)})
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as entries:
        entries.writestr(zipfile.ZipInfo("tileset.json"), made.text(made.tileset(made.tile())))
        entries.writestr(zipfile.ZipInfo("model.gltf"), made.text(made.square()))
    yield Seed("3tz", "a.3tz", {"a.3tz": archive.getvalue()})


def mesh_file_seeds():
    plys = made.plys()
    for name, content in {"ply in ascii": plys[0], "ply, little endian": plys[4], "ply, big endian": plys[5]}.items():
        mesh, picture = content.split(made.PART)
        yield Seed(name, "a.ply", {"a.ply": mesh, "one.png": picture})
    for name, content in {"stl in ascii": made.stls()[0], "binary stl": made.stls()[1]}.items():
        yield Seed(name, "a.stl", {"a.stl": content})


def other_seeds():
    obj, mtl = made.objs()[0].split(made.PART)
    near, found = obj.replace(b"5e6 4e6 100", b"5 4 1"), mtl.replace(b"gone", b"p")
    yield Seed("obj", "a.obj", {"a.obj": near, "material.mtl": found, "p.png": made.png(4)})
    place = {"path": "a.glb", "place": {"position_m": [1, 2, 3]}, "heading_deg": 30, "scale": 2}
    yield Seed("scene", "s.json", {"a.glb": glb_of()(made.text(in_chunk()))},
               {"s.json": ({"gigabake": 1, "sources": [place]}, bytes)})
    dem, grid = made.rasters()
    yield Seed("geotiff", "d.tif", {"d.tif": dem})
    keys = {"crs": "EPSG:25832", "tile_cells": 16, "height_scale": 1, "geoid_offset_m": 2}
    yield Seed("grid and photo", "s.json", {"d.asc": grid, "o.tif": made.tiff(4, 3)},
               {"s.json": ({"gigabake": 1, "sources": [{"dem": "d.asc", "ortho": "o.tif", **keys}]}, bytes)})
    world = b"10\n0\n0\n-10\n500000\n5100160\n"
    yield Seed("image as raster", "s.json", {"d.png": made.png(8, 0), "d.wld": world, "d.pgw": world},
               {"s.json": ({"gigabake": 1, "sources": [{"dem": "d.png", **keys}]}, bytes)})
    yield Seed("hgt", "s.json", {"N46E008.hgt": b"\0\x10" * (1201 * 1201)},
               {"s.json": ({"gigabake": 1, "sources": [{"dem": "N46E008.hgt", "tile_cells": 2048}]}, bytes)}, 5000)


def all_seeds():
    return [*gltf_seeds(), *tile_seeds(), *tileset_seeds(), *other_seeds(), *mesh_file_seeds()]


class TooLong(Exception):
    """An error: a document that was inserted into itself, or multiplied too often."""


def text_of(value, maximum=4_000_000):
    """Returns JSON with lists of pairs as objects, so that a member may occur twice."""
    parts, room = [], [maximum]

    def write(text):
        room[0] -= len(text)
        if room[0] < 0:
            raise TooLong
        parts.append(text)

    def visit(item):
        if isinstance(item, Members):
            for i, (key, inner) in enumerate(item.pairs):
                write(("," if i else "{") + json.dumps(key) + ":")
                visit(inner)
            write("}" if item.pairs else "{}")
        elif isinstance(item, list):
            for i, inner in enumerate(item):
                write("," if i else "[")
                visit(inner)
            write("]" if item else "[]")
        else:
            write(item.text if isinstance(item, Raw) else json.dumps(item))

    visit(value)
    return "".join(parts)


class Members:
    def __init__(self, pairs):
        self.pairs = pairs


class Raw:
    """Text that is written unchanged, not as JSON."""

    def __init__(self, text):
        self.text = text


def members_of(value):
    if isinstance(value, dict):
        return Members([[k, members_of(v)] for k, v in value.items()])
    return [members_of(v) for v in value] if isinstance(value, list) else value
