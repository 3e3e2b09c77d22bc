"""Writes OBJ and MTL files as different programs spell them."""
from dataclasses import dataclass, field

import numpy

from figures import figure, voxels_of
from frames import PLACES, bounds_of, in_file, linear
from images import Image, png
from obj_reports import BRIGHT, INVISIBLE, NO_UV, add_reported
from odd import Case

WHITE, GREY = (255, 255, 255), (127, 127, 127)
NO_IMAGE = "images are missing, replaced by grey"
NO_MATERIAL = "materials that faces use and no file defines, taken as white"
NO_FILE = "material files are missing, their materials are grey"
NO_COLOUR = "faces without vertex colours, in a file that has some"
HARMLESS = ("Ka 0.2 0.2 0.2", "Ks 0 0 0", "Ke 0 0 0", "Ns 96.078", "Ni 1.45", "illum 2", "Tf 1 1 1", "Pr 0.5", "Pm 0",
            "map_Ks s.png", "refl -type sphere r.png", "# a note")


def cased(odd, word):
    return odd.choice([word, word, word, word.lower(), word.upper()])


@dataclass
class Material:
    name: bytes
    lines: list = field(default_factory=list)  # empty: no file describes the material
    image: Image = None
    image_name: str = ""
    scale: tuple = (1, 1)
    offset: tuple = (0, 0)
    is_clamped: bool = False
    alpha: int = 255  # alpha of its alpha map


class ObjWriter:
    def __init__(self, odd, folder, up, earth=None):
        self.odd, self.folder, self.up, self.earth = odd, folder, up, earth
        self.case = Case("obj", "")
        self.place = odd.choice(PLACES) if earth is None and odd.maybe(0.25) else (0, 0, 0)
        self.case.place = self.place
        self.lines, self.materials, self.warned = [], [], {}
        self.vertices = self.uvs = self.faces = 0
        self.exact = self.place != (0, 0, 0) or earth is not None
        self.has_mtl = odd.maybe(0.8)
        self.is_mtl_missing = self.has_mtl and odd.maybe(0.06)
        self.has_colours, self.is_coloured = odd.beyond(0.3), False
        self.named = []
        self.slashes = odd.choice(["", "//"])
        self.points = []

    def warn(self, text, count=1):
        self.warned[text] = self.warned.get(text, 0) + count

    def line(self, *words):
        """Adds a line of words with odd spaces."""
        gap = self.odd.choice(["  ", "\t", " \t"]) if self.odd.beyond(0.5) else " "
        text = gap.join(w if isinstance(w, str) else w.decode("latin-1") for w in words)
        self.lines.append(("  " if self.odd.beyond(0.05) else "") + text + (" " if self.odd.beyond(0.05) else ""))

    def material_name(self):
        odd = self.odd
        name = odd.choice([odd.word(), odd.word() + " " + odd.word(), f"{odd.word()}.{odd.randrange(100):03}",
                           "Märchen",
                           f"mat:{odd.word()}", "1", "-" + odd.word(), "名", f"a#{odd.word()}"]).encode()
        if odd.maybe(0.05):
            name += b"\xe9\xff"
        known = {m.name for m in self.materials}
        return name if name not in known else name + odd.word().encode()

    def new_material(self, kind, colour):
        """Returns a material and the colour that it gives to faces."""
        odd, m = self.odd, Material(self.material_name())
        self.materials.append(m)
        if kind == "undescribed":
            if not self.is_mtl_missing:
                self.warn(NO_MATERIAL)
            return m, WHITE
        if kind == "one number":
            level = odd.choice([0, 1, round(linear(188), 6)])
            m.lines.append(f"{cased(odd, 'Kd')} {odd.number(level)}")
            code = {0: 0, 1: 255}.get(level, 188)
            return m, (code, code, code)
        values = [round(linear(c), 7) for c in colour]
        if kind == "Kd" and odd.maybe(0.04):
            values, colour = [odd.choice([255, 1.5, 0]) for _ in range(2)] + [200], None
            colour = tuple(255 if v > 0 else 0 for v in values)
            if not self.is_mtl_missing:
                self.warn(BRIGHT)
        m.lines.append(f"{cased(odd, 'Kd')} {' '.join(odd.number(v) for v in values)}")
        return m, colour

    def add_map(self, m):
        """Describes an image, which may be missing."""
        odd = self.odd
        m.image = Image(odd)
        m.image_name = odd.file_name("." + m.image.suffix)
        is_deep = odd.maybe(0.2)
        target = self.folder / "tex" / m.image_name if is_deep else self.folder / m.image_name
        target.parent.mkdir(exist_ok=True)
        target.write_bytes(m.image.data)
        name = f"tex/{m.image_name}" if is_deep else m.image_name
        if odd.maybe(0.2):
            name = name.replace("/", "\\")
        if not is_deep and odd.maybe(0.15):
            name = odd.choice(["C:\\Users\\me\\textures\\", "/home/me/", "D:/work/", "..\\..\\", "./", ".\\"]) + name
        options = []
        if odd.maybe(0.3):
            m.scale = odd.choice([(2, 2), (0.5, 2), (1, 1), (4, 0.25)])
            options.append(f"-s {m.scale[0]} {m.scale[1]}" + odd.choice(["", " 1"]))
        if odd.maybe(0.2):
            m.offset = odd.choice([(0.5, 0), (0.25, 0.75), (-1, 2)])
            options.append(f"-o {m.offset[0]} {m.offset[1]}" + odd.choice(["", " 0"]))
        if odd.maybe(0.2):
            m.is_clamped = odd.maybe()
            options.append("-clamp " + ("on" if m.is_clamped else "off"))
        options += odd.sample(["-blendu on", "-blendv off", "-bm 1", "-mm 0 1", "-texres 512", "-imfchan l", "-cc off",
                               "-boost 1.5"], odd.randint(0, 2))
        odd.shuffle(options)
        if odd.maybe(0.15):
            name = f'"{name}"'
        m.lines.append(" ".join([cased(odd, "map_Kd"), *options, name]))
        m.alpha = 255
        if odd.maybe(0.15):
            m.alpha, m.alpha_name = odd.choice([0x40, 0xc0]), f"alpha {len(self.materials)}.png"
            pixels = numpy.full((8, 8, 3), m.alpha)
            (self.folder / m.alpha_name).write_bytes(png(odd, pixels))
            m.lines.append(" ".join([cased(odd, odd.choice(["map_d", "map_opacity"])), *options, m.alpha_name]))

    def alpha_lines(self, m):
        """Adds the opacity in one of its spellings. Returns the alpha of voxels."""
        odd = self.odd
        kind = odd.choice(["none"] * 6 + ["opaque", "Tr 0", "Tr 1", "half", "Tr half", "both"])
        lines, alpha = {"none": ([], 255), "opaque": (["d 1.0"], 255), "Tr 0": (["Tr 0"], 255),
                        "Tr 1": (["Tr 1.0"], 255), "half": (["d 0.5"], 128), "Tr half": (["Tr 0.75"], 64),
                        "both": (["Tr 0.25", "d 0.75"], 191)}[kind]
        m.lines += odd.sample(lines, len(lines))
        return alpha

    def add_part(self, part):
        odd, case = self.odd, self.case
        if part.place is not None:
            return self.add_textured(part)
        if self.has_mtl and not self.is_mtl_missing and odd.beyond(0.05):
            return self.add_without_uv(part)
        colours = self.has_colours and odd.maybe(0.7)
        self.is_coloured |= colours
        if colours or not self.has_mtl or odd.maybe(0.1):
            expected, m = part.colour if colours else WHITE, None
            alpha = 255
        else:
            kind = odd.choice(["Kd", "Kd", "Kd", "one number", "undescribed"])
            m, expected = self.new_material(kind, part.colour)
            alpha = self.alpha_lines(m) if m.lines else 255
            if self.is_mtl_missing:
                expected, alpha = GREY, 255
            elif m.lines and alpha == 255 and case.voxels and odd.maybe(0.05):
                m.lines.append("d 0")
                self.warn(INVISIBLE)
                alpha = 0
        if alpha > 0:
            case.voxels.update(voxels_of([part], expected, alpha))
        if self.has_colours and not colours:
            self.warn(NO_COLOUR, len(part.polygons))
        self.write_part(part, m, colours=part.colour if colours else None)

    def add_textured(self, part):
        """Adds a part with texture coordinates. The image or the MTL file may be missing."""
        odd, case = self.odd, self.case
        m, _ = self.new_material("next to a map", part.colour)
        if odd.maybe(0.3):
            m.lines.clear()  # only the map remains
        self.add_map(m)
        alpha = self.alpha_lines(m) if m.alpha == 255 else m.alpha
        odd.shuffle(m.lines)
        if self.is_mtl_missing or not self.has_mtl:
            voxels = voxels_of([part], GREY if self.is_mtl_missing else WHITE)
            if not self.has_mtl:
                self.warn(NO_MATERIAL)
        elif odd.maybe(0.08):
            for path in (self.folder / m.image_name, self.folder / "tex" / m.image_name):
                path.unlink(missing_ok=True)
            self.warn(NO_IMAGE)
            voxels = voxels_of([part], GREY, alpha)
        else:
            case.colour_tolerance = max(case.colour_tolerance, m.image.tolerance)
            voxels = m.image.voxels(part, m.is_clamped, alpha)
        case.voxels.update(voxels)
        if self.has_colours:
            self.warn(NO_COLOUR, len(part.polygons))
        self.write_part(part, m)

    def add_without_uv(self, part):
        """Adds a part whose material has an image, but whose faces have no texture coordinates: Kd gives the colour."""
        odd, case = self.odd, self.case
        m, colour = self.new_material("next to a map", part.colour)
        if odd.maybe(0.3):
            m.lines.clear()
            colour = WHITE
        self.add_map(m)
        m.lines = [line for line in m.lines if "alpha " not in line]
        odd.shuffle(m.lines)
        self.warn(NO_UV, len(part.polygons))
        if self.has_colours:
            self.warn(NO_COLOUR, len(part.polygons))
        case.voxels.update(voxels_of([part], colour))
        self.write_part(part, m)

    def unused_vertices(self):
        for _ in range(self.odd.randint(1, 2)):
            far = self.odd.choice([("0", "0", "0"), ("1e9", "1e9", "-1e9"), ("1", "2", "3"), ("1e30", "0", "0")])
            self.line("v", *far)
            self.vertices += 1

    def write_part(self, part, m, colours=None):
        odd = self.odd
        points = in_file(part, self.up, self.place, self.earth)
        self.points.append(points)
        if odd.beyond(0.15):
            self.unused_vertices()
        first, first_uv = self.vertices + 1, self.uvs + 1
        weight = ["1.0"] if odd.beyond(0.25) else []
        more = weight + ([odd.number(c / 255) for c in colours] if colours else [])
        for point in points:
            self.line("v", *(odd.number(c, self.exact) for c in point), *more)
        self.vertices += len(points)
        if part.place is not None:
            for uv in part.place:
                uv = (uv / m.image.blocks - numpy.array(m.offset)) / numpy.array(m.scale)
                self.line("vt", *(odd.number(c) for c in uv), *(["0"] if odd.beyond(0.3) else []))
            self.uvs += len(points)
        if not self.points[1:] or odd.maybe(0.3):
            self.line("vn", "0", "0", "1")
        if odd.maybe(0.2):
            self.line(odd.choice(["g", "o"]), odd.choice(["", "a b", "default", "Ünder"]))
        if odd.maybe(0.2):
            self.line("s", odd.choice(["off", "1", "0"]))
        self.use(m)
        polygons = list(part.polygons)
        odd.shuffle(polygons)
        for polygon in polygons:
            self.face(polygon, first, first_uv if part.place is not None else None)

    def use(self, m):
        if m is not None:
            self.lines.append("usemtl " + m.name.decode("latin-1"))
            self.named.append(m)
        elif self.named:
            # A material stays in use until the next `usemtl`. A material without any description would cause a warning.
            self.lines.append("usemtl")

    def face(self, polygon, first, first_uv):
        odd = self.odd
        negative, slashes = odd.maybe(0.25), odd.choice(["", "", "//", "/"]) if odd.beyond(0.7) else self.slashes
        corners = []
        for at in polygon:
            v = at - (self.vertices + 1 - first) if negative else first + at
            t = ""
            if first_uv is not None:
                t = at - (self.uvs + 1 - first_uv) if negative else first_uv + at
            corner = f"{v}/{t}" if first_uv is not None else str(v)
            if slashes == "//":
                corner += "/1" if first_uv is not None else "//1"
            elif slashes == "/" and first_uv is None:
                corner += odd.choice(["/", "//"])
            corners.append(corner)
        if len(corners) > 3 and odd.beyond(0.1):
            at = odd.randint(1, len(corners) - 1)
            self.lines.append(" ".join(["f", *corners[:at], "\\"]))
            self.lines.append(" ".join(corners[at:]))
        else:
            self.line("fo" if odd.beyond(0.1) else "f", *corners)
        if odd.beyond(0.1):
            self.lines[-1] += " # face"
        self.faces += 1
        self.case.triangles = (self.case.triangles or 0) + len(polygon) - 2

    def text(self, lines):
        """Returns the bytes of a text file in one of the encodings and line ends."""
        odd = self.odd
        end = "\r" if odd.beyond(0.2) else odd.choice(["\n", "\n", "\r\n"])
        out = end.join(lines) + (end if odd.maybe(0.9) else "")
        mark = b"\xef\xbb\xbf" if odd.beyond(0.1) else b""
        self.case.notes.append(f"line end {end!r}, mark {bool(mark)}")
        return mark + out.encode("latin-1")

    def mtl_lines(self, materials):
        odd, lines = self.odd, ["# materials of a test", ""] if self.odd.is_plain or self.odd.maybe() else []
        odd.shuffle(materials)
        for m in materials:
            lines.append("newmtl " + m.name.decode("latin-1"))
            body = [line if isinstance(line, str) else line.decode("latin-1") for line in m.lines]
            for more in odd.sample(HARMLESS, odd.randint(0, 4)):
                body.insert(odd.randint(0, len(body)), more)
            indent = odd.choice(["", "", "\t", "  "])
            lines += [indent + line.encode().decode("latin-1") for line in body]
            if odd.maybe():
                lines.append("")
        return lines

    def write_mtl(self):
        """Writes the materials and returns the lines that name their file."""
        odd = self.odd
        if not self.has_mtl:
            return []
        name = odd.word() + ".mtl" if self.is_mtl_missing else odd.file_name(".mtl")
        materials = [m for m in self.materials if m.lines]
        if self.is_mtl_missing:
            self.warn(NO_FILE)
        elif len(materials) > 1 and odd.beyond(0.3):
            return self.write_two_mtl(materials)
        else:
            (self.folder / name).write_bytes(self.text(self.mtl_lines(materials)))
        spelling = name.encode().decode("latin-1")
        lines = [odd.choice(["", "", "./", ".\\"]) + spelling]
        return ["mtllib " + line for line in lines] + (["mtllib"] if odd.maybe(0.05) else [])

    def write_two_mtl(self, materials):
        """Writes materials to two files. One or two lines name them."""
        odd, names = self.odd, [f"{self.odd.word()}{i}.mtl" for i in (1, 2)]
        for i, name in enumerate(names):
            (self.folder / name).write_bytes(self.text(self.mtl_lines(materials[i::2])))
        return ["mtllib " + " ".join(names)] if odd.maybe() else ["mtllib " + name for name in names]

    def points_and_lines(self):
        case = self.case
        if self.odd.beyond(0.1):
            self.lines.append("p 1 -1")
            case.skipped_points += 2
        if self.odd.beyond(0.1):
            self.lines.append("l 1 2 3 1")
            case.skipped_lines += 3

    def write(self):
        odd, case = self.odd, self.case
        parts = figure(odd, ["outline", "spiky", "columns", "grid", "textured"])
        for part in parts:
            self.add_part(part)
        if not self.is_coloured:
            self.warned.pop(NO_COLOUR, None)
        self.points_and_lines()
        if odd.beyond(0.4):
            add_reported(self)
        has_head = odd.is_plain or odd.maybe()
        head = ["# written by a test, and long enough for assimp"] if has_head else []
        body = self.lines
        if odd.maybe(0.2):
            at = odd.randint(0, len(body))
            while at > 0 and body[at - 1].endswith("\\"):
                at -= 1
            body.insert(at, odd.choice(["", "#", "# é".encode().decode("latin-1"), "   "]))
        names = self.write_mtl()
        # Materials are known for any position of mtllib.
        lines = head + (body + names if odd.maybe(0.1) else names + body)
        case.source = odd.file_name(odd.choice([".obj", ".obj", ".OBJ"]))
        (self.folder / case.source).write_bytes(self.text(lines))
        case.warnings = sorted((text, count, 1) for text, count in self.warned.items())
        low, high = bounds_of(numpy.concatenate(self.points))
        case.outside = {"faces": self.faces, "bounds": (low, high)}
        return case


def write_obj(odd, folder, up):
    return ObjWriter(odd, folder, up).write()
