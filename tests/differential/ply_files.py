"""Writes PLY files: ASCII and both binaries, with the elements and properties that scanners and editors write."""
import struct

import numpy

from figures import figure, triangulated, voxels_of
from frames import PLACES, bounds_of, in_file
from images import Image
from odd import Case

WHITE, GREY = (255, 255, 255), (127, 127, 127)
TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
NEW_NAMES = {"char": "int8", "uchar": "uint8", "short": "int16", "ushort": "uint16", "int": "int32", "uint": "uint32",
             "float": "float32", "double": "float64"}
NO_UV = "images without texture coordinates"
NO_IMAGE = "texture coordinates without an image"
MISSING = "images are missing: ignored"
UNUSED = "properties that are not used"
ELEMENTS = "elements that are not read"
LOST = "faces left out, since a corner refers to no vertex"
NO_TEXNUMBER = "faces whose texnumber refers to no image"
ALPHA = "alpha is 0 everywhere, taken as opaque"
BOTH = "colours of faces are not used, since vertices have some"
NO_DIRECTION = "vertex normals without a direction, replaced by the normals of the triangles"
# Properties that do not describe a surface's shape or colour.
PLAIN = ("nx", "ny", "nz", "confidence", "intensity", "quality", "curvature", "radius", "flags")


class PlyWriter:
    def __init__(self, odd, folder, up, earth=None):
        self.odd, self.folder, self.up, self.earth = odd, folder, up, earth
        self.case = Case("ply", "")
        self.format = odd.choice(["ascii", "binary_little_endian", "binary_big_endian"])
        self.case.place = odd.choice(PLACES) if earth is None and odd.maybe(0.25) else (0, 0, 0)
        self.warned = {}
        self.image = None
        self.vertex, self.face = [], []  # columns: (name, type or list types, values)

    def warn(self, text, count=1):
        self.warned[text] = self.warned.get(text, 0) + count

    def name_of_type(self, name):
        return NEW_NAMES[name] if self.odd.maybe(0.3) else name

    def colour_columns(self, colours, alpha):
        """Returns the columns of one colour per row: bytes, 16 bits or floats."""
        odd = self.odd
        kind = odd.choice(["uchar", "uchar", "uchar", "float", "ushort", "double"])
        scale = {"uchar": 1, "ushort": 257, "float": 1 / 255, "double": 1 / 255}[kind]
        prefix = odd.choice(["", "", "", "diffuse_"])
        columns = [(prefix + name, kind, [c[i] * scale for c in colours])
                   for i, name in enumerate(("red", "green", "blue"))]
        if alpha is not None:
            columns.append((prefix + "alpha", kind, [a * scale for a in alpha]))
        return columns

    def alpha_of(self, count):
        """Returns the alpha of all rows, and the resulting alpha of voxels."""
        kind = self.odd.choice(["none", "none", "opaque", "zero", "half"])
        if kind == "none":
            return None, 255
        if kind == "zero":
            self.warn(ALPHA)
        value = {"opaque": 255, "zero": 0, "half": 128}[kind]
        return [value] * count, 255 if kind == "zero" else value

    def add_colours(self, parts):
        """Adds colours to vertices, to faces, to both, or to none. Sets the voxels."""
        odd, case = self.odd, self.case
        kind = odd.choice(["vertex", "vertex", "face", "both", "none"])
        alpha, seen = None, 255
        if kind in ("vertex", "both"):
            of_vertices = [p.colour for p in parts for _ in p.points]
            alpha, seen = self.alpha_of(len(of_vertices))
            self.vertex += self.colour_columns(of_vertices, alpha)
        if kind in ("face", "both"):
            of_faces = [p.colour for p in parts for _ in p.polygons]
            if kind == "both":
                self.warn(BOTH)
                of_faces = [tuple(255 - c for c in colour) for colour in of_faces]
            else:
                alpha, seen = self.alpha_of(len(of_faces))
            self.face += self.colour_columns(of_faces, alpha if kind == "face" else None)
        case.voxels.update(voxels_of(parts, WHITE if kind == "none" else None, seen))
        if odd.beyond(0.05):
            uv = [(p.points[:, :2] / 12).tolist() for p in parts]
            self.vertex += [(name, "float", [v[i] for one in uv for v in one]) for i, name in enumerate("st")]
            self.warn(NO_IMAGE)
        elif odd.beyond(0.05):
            image = Image(odd, ("png",))
            self.add_image(image, True)
            self.warn(NO_UV)
        case.notes.append(f"colours: {kind}, alpha {seen}")

    def add_image(self, image, is_there):
        """Writes an image, and the comment that names it."""
        odd = self.odd
        name = odd.file_name("." + image.suffix)
        self.comments.append(f"{odd.choice(['TextureFile', 'TextureFile', 'texturefile', 'TEXTUREFILE'])} {name}")
        if is_there:
            (self.folder / name).write_bytes(image.data)
        else:
            self.warn(MISSING)

    def add_textures(self, parts):
        """Adds an image for each part. The faces state the number of their image."""
        odd, case = self.odd, self.case
        lists, numbers = [], []
        for number, part in enumerate(parts):
            image, is_there = Image(odd, ("png", "jpg")), odd.maybe(0.9)
            self.add_image(image, is_there)
            uv = part.place / image.blocks
            lists += [uv[polygon].reshape(-1).tolist() for polygon in part.polygons]
            numbers += [number] * len(part.polygons)
            case.voxels.update(image.voxels(part) if is_there else voxels_of([part], GREY))
            case.colour_tolerance = max(case.colour_tolerance, image.tolerance)
        self.face.append(("texcoord", (odd.choice(["uchar", "int"]), odd.choice(["float", "double"])), lists))
        self.face.append(("texnumber", odd.choice(["int", "uchar"]), numbers))

    def add_texture(self, parts):
        """Adds texture coordinates to vertices, or to the corners of faces."""
        odd, case = self.odd, self.case
        self.image = Image(odd, ("png", "jpg"))
        is_there = odd.maybe(0.9)
        self.add_image(self.image, is_there)
        uv = [p.place / self.image.blocks for p in parts]
        if odd.maybe():
            names = odd.choice([("u", "v"), ("s", "t"), ("texture_u", "texture_v"), ("S", "T")])
            values = numpy.concatenate(uv)
            kind = odd.choice(["float", "double"])
            self.vertex += [(names[i], kind, values[:, i].tolist()) for i in range(2)]
        else:
            lists = [one[polygon].reshape(-1).tolist() for one, p in zip(uv, parts) for polygon in p.polygons]
            self.face.append(("texcoord", (odd.choice(["uchar", "int"]), odd.choice(["float", "double"])), lists))
            if odd.maybe():
                self.face.append(("texnumber", odd.choice(["int", "uchar"]), [0] * len(lists)))
        for part in parts:
            case.voxels.update(self.image.voxels(part) if is_there else voxels_of([part], GREY))
        case.colour_tolerance = self.image.tolerance

    def positions(self, parts):
        points = numpy.concatenate([in_file(p, self.up, self.case.place, self.earth) for p in parts])
        is_large = self.case.place != (0, 0, 0) or self.earth is not None
        kind = "double" if is_large else self.odd.choice(["float", "float", "double"])
        low, high = bounds_of(points)
        self.case.outside = {"faces": sum(len(p.polygons) for p in parts), "bounds": (low, high)}
        if self.format == "ascii" and self.odd.maybe(0.3):
            kind = "double" if is_large else "float"
        return [(name, kind, points[:, i].tolist()) for i, name in enumerate("xyz")]

    def add_plain(self, columns, count, maximum):
        """Adds properties without expected warnings, and possibly a property that must be reported."""
        odd = self.odd
        names = odd.sample(PLAIN, odd.randint(0, maximum))
        if columns is self.vertex and {"nx", "ny", "nz"} <= set(names) and count:
            self.warn(NO_DIRECTION, count)  # all three are 0
        for name in names:
            columns.insert(odd.randint(0, len(columns)), (name, odd.choice(["float", "uchar", "double"]), [0] * count))
        if odd.maybe(0.1):
            columns.append((odd.choice(["label", "scalar_Value", "material_id"]), "int", list(range(count))))
            self.warn(UNUSED)

    def polygons(self, parts):
        first, lists = 0, []
        for part in parts:
            lists += [[first + i for i in polygon] for polygon in part.polygons]
            first += len(part.points)
        return lists

    def add_reported_faces(self, lists, count):
        """Adds faces of one or two corners, without area, or with a corner that is no vertex.

        Callers must not combine them with other columns.
        """
        odd, case = self.odd, self.case
        for kind in odd.sample(["one", "two", "flat", "lost", "none"], odd.randint(1, 2)):
            lists.append({"one": [0], "two": [0, 1], "flat": [0, 0, 1], "lost": [0, 1, count + 5], "none": []}[kind])
            case.skipped_points += kind == "one"
            case.skipped_lines += kind == "two"
            case.triangles += kind == "flat"
            if kind == "lost":
                case.losses.append(LOST)

    def strips(self, parts):
        """Returns the quadrangles as one list of strips. A negative number ends each strip."""
        out, first = [], 0
        for part in parts:
            for polygon in part.polygons:
                out += [first + polygon[i] for i in (0, 1, 3, 2)] + [-1]
            first += len(part.points)
        return [("tristrips", 1, [("vertex_indices", ("int", "int"), [out[:-1] if self.odd.maybe() else out])])]

    def elements(self, parts):
        """Returns (name, number of rows, columns) of each element."""
        odd = self.odd
        lists = self.polygons(parts)
        count = sum(len(p.points) for p in parts)
        self.case.triangles = sum(p.triangles() for p in parts)
        self.vertex = (self.positions(parts) + self.vertex if odd.maybe(0.8) else self.vertex + self.positions(parts))
        self.add_plain(self.vertex, count, 3)
        if all(len(p) == 4 for p in lists) and not self.face and odd.beyond(0.5):
            self.case.notes.append("strips")
            return [("vertex", len(self.vertex[0][2]), self.vertex), *self.strips(parts)]
        if not self.face and odd.beyond(0.3):
            self.add_reported_faces(lists, count)
        maximum = max(map(len, lists))
        kind = (odd.choice(["uchar", "uchar", "int", "uint", "ushort", "short"]) if maximum < 256 else "int",
                odd.choice(["int", "int", "uint", "short", "ushort"]))
        self.face.insert(odd.randint(0, len(self.face)), (odd.choice(["vertex_indices", "vertex_index"]), kind, lists))
        self.add_plain(self.face, len(lists), 1)
        if odd.beyond(0.15):
            self.add_unused(count)
        out = [("vertex", len(self.vertex[0][2]), self.vertex), ("face", len(lists), self.face)]
        if odd.beyond(0.1):
            out.reverse()
        if odd.maybe(0.15):
            self.warn(ELEMENTS)
            out.insert(odd.randint(0, 2), ("edge", 2, [("vertex1", "int", [0, 1]), ("vertex2", "int", [1, 2])]))
        if odd.maybe(0.1):
            out.insert(odd.randint(0, len(out)), ("camera", 0, [("view_px", "float", [])]))
        return out

    def add_unused(self, count):
        """Adds distant vertices that no face uses."""
        far = self.odd.choice([0, 1e6, 1e9])
        for i, (name, kind, values) in enumerate(self.vertex):
            self.vertex[i] = (name, kind, values + [far if name in "xyz" else 0])

    def header(self, elements):
        odd = self.odd
        lines = ["ply", f"format {self.format} 1.0"]
        comments = [f"comment {c}" for c in self.comments] + odd.sample(
            ["comment", "comment made by a test", "obj_info a scan", "comment TextureFileless"], odd.randint(0, 2))
        if odd.maybe(0.8):
            lines += comments
            comments = []
        for name, count, columns in elements:
            lines.append(f"element {name if not odd.beyond(0.05) else name.capitalize()} {count}")
            for column, kind, _ in columns:
                column = column if not odd.beyond(0.05) else column.upper()
                if isinstance(kind, tuple):
                    lines.append(f"property list {self.name_of_type(kind[0])} {self.name_of_type(kind[1])} {column}")
                else:
                    lines.append(f"property {self.name_of_type(kind)} {column}")
        lines += comments + ["end_header"]
        if odd.beyond(0.1):
            lines = [line.replace(" ", odd.choice(["  ", "\t"])) if line[:7] != "comment" else line for line in lines]
        return [line + (" " if odd.beyond(0.03) and line[:7] != "comment" else "") for line in lines]

    def spelt(self, kind, value):
        if kind in ("float", "double"):
            return self.odd.number(value, kind == "double" and abs(value) > 1e4)
        return str(round(value))

    def row_text(self, columns, row):
        words = []
        for _, kind, values in columns:
            if isinstance(kind, tuple):
                words += [str(len(values[row])), *(self.spelt(kind[1], v) for v in values[row])]
            else:
                words.append(self.spelt(kind, values[row]))
        return self.odd.choice([" ", " ", " ", "  ", "\t"]).join(words) + self.odd.choice(["", "", " "])

    def row_bytes(self, columns, row):
        order = "<" if "little" in self.format else ">"
        out = b""

        def packed(kind, values):
            values = values if kind in ("float", "double") else [round(v) for v in values]
            return struct.pack(f"{order}{len(values)}{TYPES[kind]}", *values)
        for _, kind, values in columns:
            if isinstance(kind, tuple):
                out += packed(kind[0], [len(values[row])]) + packed(kind[1], values[row])
            else:
                out += packed(kind, [values[row]])
        return out

    def write(self):
        odd, case = self.odd, self.case
        self.comments = []
        if odd.maybe(0.3):
            parts = figure(odd, ["textured"])
            (self.add_textures if odd.maybe(0.4) else self.add_texture)(parts)
        else:
            parts = figure(odd, ["outline", "spiky", "columns", "grid"])
            if odd.maybe(0.3):
                parts = [triangulated(odd, p) for p in parts if p.kind in ("columns", "grid")] or parts
            self.add_colours(parts)
        elements = self.elements(parts)
        end = odd.choice(["\r\n", "\r"]) if odd.beyond(0.4) else "\n"
        content = "".join(line + end for line in self.header(elements)).encode()
        for _, count, columns in elements:
            for row in range(count):
                content += ((self.row_text(columns, row) + end).encode() if self.format == "ascii" else
                            self.row_bytes(columns, row))
        if self.format == "ascii" and odd.maybe(0.1):
            content = content.rstrip()
        if odd.beyond(0.05):
            content = b"\xef\xbb\xbf" + content
        case.source = odd.file_name(odd.choice([".ply", ".ply", ".PLY"]))
        case.notes.append(f"{self.format}, line end {end!r}")
        (self.folder / case.source).write_bytes(content)
        case.warnings = sorted((text, count, 1) for text, count in self.warned.items())
        return case


def write_ply(odd, folder, up):
    return PlyWriter(odd, folder, up).write()
