"""Writes tilesets of 3D Tiles 1.0 and 1.1: explicit and implicit tiles, with contents of every kind."""
import dataclasses
import gzip
import json
import struct
from urllib.parse import quote

import numpy

from figures import figure
from frames import FROM_Z_UP
from gltf_files import closed_glb, matrix_of
from implicit_tiles import implicit_tile
from odd import VOXEL, Case

BOX = {"box": [3, 3, 3, 6, 0, 0, 0, 6, 0, 0, 0, 6]}


def padded(text, start):
    text += b" " * (-(start + len(text)) % 8)
    return text


def b3dm(odd, glb, center):
    """A b3dm; center: RTC_CENTER, or None."""
    table = {"BATCH_LENGTH": odd.choice([0, 0, 3])}
    if center is not None:
        table["RTC_CENTER"] = list(center)
    feature = padded(json.dumps(table).encode(), 28)
    batch = padded(json.dumps({"id": [1, 2, 3], "name": ["a", "é", ""]}).encode(), 0) if odd.maybe(0.3) else b""
    size = 28 + len(feature) + len(batch) + len(glb)
    return b"b3dm" + struct.pack("<6I", 1, size, len(feature), 0, len(batch), 0) + feature + batch + glb


def i3dm(odd, glb, positions, center):
    """An i3dm with the model inside."""
    count = len(positions)
    local = positions - center if center is not None else positions
    table = {"INSTANCES_LENGTH": count}
    if center is not None:
        table["RTC_CENTER"] = list(center)
    if odd.maybe(0.3):
        low, size = local.min(0) - 1, numpy.ptp(local, axis=0) + 2
        steps = numpy.round((local - low) / size * 65535).astype("<u2").tobytes()
        table.update(POSITION_QUANTIZED={"byteOffset": 0}, QUANTIZED_VOLUME_OFFSET=low.tolist(),
                     QUANTIZED_VOLUME_SCALE=size.tolist())
        binary = steps
    else:
        table["POSITION"] = {"byteOffset": 0}
        binary = local.astype("<f4").tobytes()
    binary += bytes(-len(binary) % 4)
    if odd.maybe(0.3):
        table.update(NORMAL_UP={"byteOffset": len(binary)}, NORMAL_RIGHT={"byteOffset": len(binary) + 12 * count})
        binary += numpy.tile([0, 1, 0], (count, 1)).astype("<f4").tobytes()
        binary += numpy.tile([1, 0, 0], (count, 1)).astype("<f4").tobytes()
    if odd.maybe(0.3):
        table["SCALE"] = {"byteOffset": len(binary)}
        binary += numpy.ones(count, "<f4").tobytes()
    binary += bytes(-len(binary) % 8)
    feature = padded(json.dumps(table).encode(), 32)
    size = 32 + len(feature) + len(binary) + len(glb)
    return b"i3dm" + struct.pack("<7I", 1, size, len(feature), len(binary), 0, 0, 1) + feature + binary + glb


def cmpt(tiles):
    size = 16 + sum(map(len, tiles))
    return b"cmpt" + struct.pack("<3I", 1, size, len(tiles)) + b"".join(tiles)


def moved(part, matrix):
    """The part in another frame. matrix: 4 × 4, of metres."""
    points = (part.points * VOXEL) @ matrix[:3, :3].T + matrix[:3, 3]
    return dataclasses.replace(part, points=points / VOXEL, kind="moved")


def affine(linear, move=(0, 0, 0)):
    out = numpy.eye(4)
    out[:3, :3], out[:3, 3] = linear, move
    return out


class TilesetWriter:
    def __init__(self, odd, folder, up):
        self.odd, self.folder, self.up = odd, folder, up
        self.case = Case("tileset", "", triangles=0)
        self.is_new = odd.maybe()
        self.gltf_up = odd.choice(["y", "y", "z", "x"])
        self.number = 0
        self.warned = {}
        self.has_coarse = False

    def take(self, made, times=1):
        """Adds what a GLB shows to the expected result."""
        self.case.voxels.update(made.voxels)
        self.case.triangles += made.triangles * times
        self.case.skipped_points += made.skipped_points * times
        self.case.skipped_lines += made.skipped_lines * times
        self.case.colour_tolerance = max(self.case.colour_tolerance, made.colour_tolerance)
        for text, count, _ in made.warnings:
            files, sum_ = self.warned.get(text, (0, 0))
            self.warned[text] = (files + 1, sum_ + count)

    def model(self, part, matrix):
        """A GLB of a part as the tile with this transform from its frame to the scene shows it."""
        local = moved(part, numpy.linalg.inv(matrix))
        return closed_glb(self.odd, [local], self.gltf_up)

    def batched(self, part, matrix):
        center = None
        if self.odd.maybe(0.4):
            center = [self.odd.choice([0, 10.5, -1000]) for _ in range(3)]
            matrix = matrix @ affine(numpy.eye(3), center)
        glb, made = self.model(part, matrix)
        self.take(made)
        return b3dm(self.odd, glb, center)

    def instanced(self, part, matrix):
        """A square for each voxel of the part."""
        axis = int(numpy.argmin(numpy.ptp(part.points, axis=0)))
        square = numpy.insert(numpy.array([[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3]]), axis, 0, axis=1)
        back = numpy.linalg.inv(matrix)
        model = dataclasses.replace(part, points=square, polygons=[[0, 1, 2, 3]], place=None)
        glb, made = closed_glb(self.odd, [moved(model, affine(back[:3, :3]))], self.gltf_up)
        self.take(made, len(part.cells))
        centres = (numpy.array(part.cells) + 0.5) * VOXEL
        positions = centres @ back[:3, :3].T + back[:3, 3]
        return i3dm(self.odd, glb, positions, positions.mean(0) if self.odd.maybe() else None)

    def content(self, part, matrix):
        """The bytes and the suffix of a content."""
        odd = self.odd
        can_be_instanced = part.place is None and abs(numpy.linalg.det(matrix[:3, :3]) - 1) < 0.01
        kind = odd.choice(["b3dm", "b3dm", "glb" if self.is_new else "b3dm", "i3dm", "cmpt"])
        if kind == "i3dm" and can_be_instanced:
            data = self.instanced(part, matrix)
        elif kind == "glb":
            data, made = self.model(part, matrix)
            self.take(made)
        elif kind == "cmpt":
            data = cmpt([self.batched(part, matrix)] + ([cmpt([])] if odd.maybe(0.2) else []))
        else:
            kind, data = "b3dm", self.batched(part, matrix)
        return (gzip.compress(data, mtime=0) if odd.maybe(0.1) else data), kind

    def stored(self, data, suffix):
        """Stores a file and returns its URI."""
        odd = self.odd
        self.number += 1
        name = odd.file_name(f"{self.number}.{suffix}")
        folder = odd.choice(["", "", "Data/", "a b/c/"])
        path = self.folder / folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        uri = quote(folder + name, safe=odd.choice(["/", "/!$&'()*+,;=@~"]))
        if odd.maybe(0.1):
            uri = uri.replace("/", "\\")
        return odd.choice(["", "", "./"]) + uri

    def entry(self, uri):
        return {self.odd.choice(["uri", "uri", "url"]) if not self.is_new else "uri": uri}

    def tile_of(self, parts, matrix, depth=0):
        """A tile with the parts in it and below it. matrix: from the parent's frame to the scene."""
        odd = self.odd
        tile = {"boundingVolume": BOX, "geometricError": max(0, 16 - depth)}
        if depth == 0 or odd.maybe(0.3):
            tile["refine"] = odd.choice(["ADD", "ADD", "REPLACE", "Add", "replace"])
        entry, own = matrix_of(odd)
        if entry and odd.maybe(0.6):
            tile["transform"] = own.T.reshape(-1).tolist()
            matrix = matrix @ own
        if len(parts) == 1:
            self.add_leaf(tile, parts[0], matrix)
            return tile
        if tile.get("refine", "").upper() == "REPLACE" and odd.maybe(0.7):
            self.add_coarse(tile, matrix)
        if self.is_new and odd.maybe(0.2) and tile.get("refine", "").upper() != "REPLACE":
            tile["contents"] = [self.entry(self.stored(*self.content(p, matrix))) for p in parts]
            return tile
        tile["children"] = [self.tile_of([p], matrix, depth + 1) for p in parts]
        return tile

    def add_coarse(self, tile, matrix):
        """Content that is not baked, since finer content replaces it."""
        self.has_coarse = True
        part = figure(self.odd, ["grid"], 1)[0]
        glb, _ = closed_glb(self.odd, [moved(part, numpy.linalg.inv(matrix))], self.gltf_up)
        tile["content"] = self.entry(self.stored(b3dm(self.odd, glb, None), "b3dm"))

    def add_leaf(self, tile, part, matrix):
        odd = self.odd
        kind = odd.choice(["content"] * 5 + ["external", "implicit", "missing"])
        if kind == "external" and "transform" not in tile:
            external = self.document(self.tile_of([part], matrix, 1))
            self.number += 1
            name = f"external{self.number}.json"
            # Its URIs are relative to it.
            (self.folder / name).write_bytes(self.text(external))
            tile["content"] = self.entry(name)
            return
        if kind == "implicit":
            data, suffix = self.content(part, matrix)
            tile.update(implicit_tile(odd, self.folder, self.number, data, suffix, self.is_new))
            self.number += 1
            return
        if kind == "missing" and self.case.voxels and not self.has_coarse:
            tile["content"] = self.entry(odd.choice(["gone.b3dm", "", "http://localhost/a.b3dm", "../above.glb"]))
            self.case.losses.append("")
            return
        tile["content"] = self.entry(self.stored(*self.content(part, matrix)))

    def document(self, root):
        odd = self.odd
        asset = {"version": odd.choice(["1.1", "1.1.0"] if self.is_new else ["1.0", "1.0", "0.0", "1.0.0"])}
        if self.gltf_up != "y" or odd.maybe(0.2):
            asset["gltfUpAxis"] = self.gltf_up.upper()
        out = {"asset": asset, "geometricError": odd.choice([0, 100, 1e6]), "root": root}
        if self.has_implicit(root) and not self.is_new:
            out["extensionsUsed"] = out["extensionsRequired"] = ["3DTILES_implicit_tiling"]
        if odd.maybe(0.2):
            out["extras"] = {"a": 1}
            out["properties"] = {"h": {"minimum": 0, "maximum": 1}}
        return out

    def has_implicit(self, tile):
        return "implicit" in json.dumps(tile)

    def text(self, document):
        text = json.dumps(document, indent=self.odd.choice([None, None, 2]), ensure_ascii=self.odd.maybe()).encode()
        return gzip.compress(text, mtime=0) if self.odd.maybe(0.05) else text

    def write(self):
        odd, case = self.odd, self.case
        parts = figure(odd, ["columns", "grid", "grid", "textured"])
        frame = affine(FROM_Z_UP[self.up].T)
        case.source = odd.choice(["tileset.json", "tileset.json", "root.json", "Production_1.json"])
        root = self.tile_of(parts, frame)
        (self.folder / case.source).write_bytes(self.text(self.document(root)))
        case.warnings = sorted((text, count, files) for text, (files, count) in self.warned.items())
        return case


def write_tileset(odd, folder, up):
    return TilesetWriter(odd, folder, up).write()
