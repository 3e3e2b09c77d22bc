"""Writes tilesets of 3D Tiles 1.0 and 1.1: explicit and implicit tiles, with contents of every format."""
import dataclasses
import gzip
import json
from urllib.parse import quote

import numpy

from figures import figure
from frames import FROM_Z_UP
from gltf_files import closed_glb, matrix_of
from implicit_tiles import implicit_tile
from odd import VOXEL, Case
from tile_formats import InstanceTable, archive, b3dm, cmpt

WHOLE_EARTH = ({"region": [-3.141592653589793, -1.5707963267948966, 3.141592653589793, 1.5707963267948966, -100, 9000]},
               {"box": [0, 0, 0, 7972671, 0, 0, 0, 7972671, 0, 0, 0, 7972671]}, {"sphere": [0, 0, 0, 7972671]})
BOX = {"box": [3, 3, 3, 6, 0, 0, 0, 6, 0, 0, 0, 6]}


def moved(part, matrix):
    """Returns the part in another frame. matrix: 4 × 4, in metres."""
    points = (part.points * VOXEL) @ matrix[:3, :3].T + matrix[:3, 3]
    return dataclasses.replace(part, points=points / VOXEL, kind="moved")


def affine(linear, move=(0, 0, 0)):
    out = numpy.eye(4)
    out[:3, :3], out[:3, 3] = linear, move
    return out


class TilesetWriter:
    """Writes a tileset. frame: from its frame to the scene; earth: the inverse if the frame is earth-centred."""

    def __init__(self, odd, folder, frame, earth=None):
        self.odd, self.folder, self.frame, self.earth = odd, folder, frame, earth
        self.next_folder = None
        self.case = Case("tileset", "", triangles=0)
        self.is_new = odd.maybe()
        self.gltf_up = odd.choice(["y", "y", "z", "x"])
        self.number = 0
        self.warned = {}
        self.has_coarse = False
        self.earth_depth = None if earth is None else self.odd.choice([0, 0, 1])

    def take(self, made, times=1):
        """Adds the content of a GLB to the expected result."""
        self.case.voxels.update(made.voxels)
        self.case.triangles += made.triangles * times
        self.case.skipped_points += made.skipped_points * times
        self.case.skipped_lines += made.skipped_lines * times
        self.case.colour_tolerance = max(self.case.colour_tolerance, made.colour_tolerance)
        for text, count, _ in made.warnings:
            files, sum_ = self.warned.get(text, (0, 0))
            self.warned[text] = (files + 1, sum_ + count)

    def model(self, part, matrix):
        """Returns a GLB of a part in the frame of a tile. matrix: from that frame to the scene."""
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

    def instanced(self, part, matrix, can_name):
        """Returns an i3dm with a square for each voxel of the part."""
        odd = self.odd
        axis = int(numpy.argmin(numpy.ptp(part.points, axis=0)))
        square = numpy.insert(numpy.array([[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3]]), axis, 0, axis=1)
        back = numpy.linalg.inv(matrix)
        centres = (numpy.array(part.cells) + 0.5) * VOXEL
        positions = centres @ back[:3, :3].T + back[:3, 3]
        table = InstanceTable(odd, positions, positions.mean(0) if self.earth is not None or odd.maybe() else None)
        linear = back[:3, :3]
        if odd.maybe(0.4):
            # The columns are right, up, and right × up.
            axes = numpy.linalg.qr(numpy.array([[odd.gauss(0, 1) for _ in range(3)] for _ in range(3)]))[0]
            axes[:, 2] = numpy.cross(axes[:, 0], axes[:, 1])
            table.add_axes(axes[:, 0], axes[:, 1])
            linear = axes.T @ linear
        if odd.maybe(0.4):
            scale = odd.choice([0.5, 2, 10])
            table.add_scale(scale)
            linear = linear / scale
        model = dataclasses.replace(part, points=square, polygons=[[0, 1, 2, 3]], place=None)
        glb, made = closed_glb(odd, [moved(model, affine(linear))], self.gltf_up)
        self.take(made, len(part.cells))
        if can_name and odd.maybe(0.4):
            uri = self.stored(glb, "glb")
            return table.tile(uri.rsplit("/", 1)[-1].rsplit("\\", 1)[-1].encode(), True)
        return table.tile(glb, False)

    def content(self, part, matrix, can_name=True):
        """Returns the bytes and the suffix of a content, which may name other files of its folder."""
        odd = self.odd
        self.next_folder = odd.choice(["", "", "Data/", "a b/c/"])
        can_be_instanced = part.place is None and abs(numpy.linalg.det(matrix[:3, :3]) - 1) < 0.01
        kind = odd.choice(["b3dm", "b3dm", "glb" if self.is_new else "b3dm", "i3dm", "cmpt"])
        if kind == "i3dm" and can_be_instanced:
            data = self.instanced(part, matrix, can_name)
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
        odd, folder = self.odd, self.next_folder or ""
        self.number += 1
        name = odd.file_name(f"{self.number}.{suffix}")
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
        """Returns a tile with the parts in it and below it. matrix: from the parent's frame to the scene."""
        odd = self.odd
        tile = {"boundingVolume": BOX, "geometricError": max(0, 16 - depth)}
        if depth == 0 or odd.maybe(0.3):
            tile["refine"] = odd.choice(["ADD", "ADD", "REPLACE", "Add", "replace"])
        entry, own = matrix_of(odd)
        is_moved = entry and odd.maybe(0.6)
        if not is_moved:
            own = numpy.eye(4)
        if depth == self.earth_depth:
            # The axes are east, north and up, or the earth-centred axes.
            own = (self.earth if odd.maybe(0.7) else affine(numpy.eye(3), self.earth[:3, 3])) @ own
            is_moved = True
        if is_moved:
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
        """Adds content that a bake skips, since finer content replaces it."""
        self.has_coarse = True
        part = figure(self.odd, ["grid"], 1)[0]
        glb, _ = closed_glb(self.odd, [moved(part, numpy.linalg.inv(matrix))], self.gltf_up)
        tile["content"] = self.entry(self.stored(b3dm(self.odd, glb, None), "b3dm"))

    def add_leaf(self, tile, part, matrix):
        odd = self.odd
        kind = odd.choice(["content"] * 5 + ["external", "implicit", "missing"])
        if kind == "external" and "transform" not in tile:
            external = self.document(self.tile_of([part], matrix, 2))
            self.number += 1
            name = f"external{self.number}.json"
            # URIs in the content are relative to it.
            (self.folder / name).write_bytes(self.text(external))
            tile["content"] = self.entry(name)
            return
        if kind == "implicit":
            data, suffix = self.content(part, matrix, can_name=False)
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
        case.source = odd.choice(["tileset.json", "tileset.json", "root.json", "Production_1.json"])
        if self.earth_depth == 1:
            root = {"boundingVolume": odd.choice(WHOLE_EARTH), "geometricError": 1e6, "refine": "ADD",
                    "children": [self.tile_of(parts, self.frame, 1)]}
        else:
            root = self.tile_of(parts, self.frame)
        (self.folder / case.source).write_bytes(self.text(self.document(root)))
        if odd.maybe(0.1):
            case.source = ""  # the folder is the source
        elif case.source == "tileset.json" and odd.maybe(0.2):
            case.source = odd.file_name(".3tz")
            archive(odd, self.folder, self.folder / case.source)
        case.warnings = sorted((text, count, files) for text, (files, count) in self.warned.items())
        return case


def write_tileset(odd, folder, up):
    return TilesetWriter(odd, folder, affine(FROM_Z_UP[up].T)).write()
