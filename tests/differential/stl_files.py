"""Writes STL files, ASCII and binary."""
import struct

import numpy

from figures import figure, triangulated, voxels_of
from frames import bounds_of, in_file
from odd import Case

WHITE = (255, 255, 255)
ATTRIBUTES = "triangles with attributes such as colours, which are not used"
HEADER_COLOUR = "a colour in the header, which is not used"
FEWER = "the header states fewer triangles than the file holds, all of which are taken"
MORE = "the header states more triangles than the file holds"
TRAILING = "bytes follow the triangles that the header states, and are not read"
# A float at 100 km has a spacing of 1/128 m.
PLACES = ((0, 0, 0), (0, 0, 0), (1000, -2000, 50), (-12000, 9000, 0), (100000, 60000, 500))


class StlWriter:
    def __init__(self, odd, folder, up):
        self.odd, self.folder = odd, folder
        self.case = Case("stl", "", place=odd.choice(PLACES))
        parts = figure(odd, ["columns", "grid", "outline"])
        self.is_text = odd.maybe()
        if not self.is_text or not odd.beyond(0.3):
            parts = [triangulated(odd, p) for p in parts if p.kind != "outline"] or [
                triangulated(odd, p) for p in figure(odd, ["grid"])]
        self.facets = [in_file(p, up, self.case.place)[polygon] for p in parts for polygon in p.polygons]
        odd.shuffle(self.facets)
        self.case.voxels = voxels_of(parts, WHITE)
        self.case.triangles = sum(p.triangles() for p in parts)
        low, high = bounds_of(numpy.concatenate(self.facets))
        self.case.outside = {"faces": len(self.facets), "bounds": (low, high)}

    def normal(self, facet):
        return self.odd.choice([numpy.zeros(3), numpy.array([0, 0, 1.0]), numpy.array([numpy.nan] * 3)])

    def cased(self, text):
        return text.upper() if self.is_upper else text

    def text(self):
        """Returns the text of one or more solids. Names may be missing."""
        odd = self.odd
        self.is_upper = odd.beyond(0.15)
        indent = odd.choice(["", " ", "  ", "\t"])
        solids = odd.randint(1, min(3, len(self.facets)))
        lines = []
        for s in range(solids):
            name = odd.choice(["", "", " " + odd.word(), " a b", " facet", " Ü"])
            lines.append(self.cased("solid") + name)
            for facet in self.facets[s::solids]:
                lines.append(indent + self.cased("facet normal ") + odd.choice(["0 0 0", "0 0 1", "-0.0 1e-7 1"]))
                lines.append(2 * indent + self.cased("outer loop"))
                lines += [3 * indent + self.cased("vertex ") + " ".join(odd.number(c) for c in p) for p in facet]
                lines += [2 * indent + self.cased("endloop"), indent + self.cased("endfacet")]
            lines.append(self.cased(odd.choice(["endsolid", "endsolid", "endsolid", "end solid"])) +
                         odd.choice(["", name]))
            if odd.maybe(0.2):
                lines.append("")
        end = "\r" if odd.beyond(0.2) else odd.choice(["\n", "\n", "\r\n"])
        content = end.join(lines) + (end if odd.maybe(0.9) else "")
        self.case.notes.append(f"text, {solids} solids, line end {end!r}")
        return (b"\xef\xbb\xbf" if odd.beyond(0.1) else b"") + content.encode()

    def binary(self):
        """Returns a binary STL. Its count and the bytes after the facets vary as in other programs."""
        odd, case, count = self.odd, self.case, len(self.facets)
        head = odd.choice([b"", b"solid made by a test", b"binary STL", b"\xff" * 80, b"COLOR=\xff\0\0\xff", b" " * 80])
        said, after, attribute = count, b"", 0
        kind = odd.choice(["zero", "fewer", "more", "trailing", "attributes"]) if odd.beyond(0.5) else "right"
        if kind == "zero":
            said = 0
        if kind == "fewer":
            said = max(count - 1, 0)
        if kind in ("zero", "fewer"):
            case.warnings = [(FEWER, 1, 1)]
        if kind == "more":
            said = count + odd.randint(1, 1000)
            case.losses = [MORE]
        if kind == "trailing":
            after = odd.randbytes(odd.randint(1, 49))
            case.warnings = [(TRAILING, 1, 1)]
        if kind == "attributes":
            attribute = odd.randint(1, 65535)
            case.warnings = [(ATTRIBUTES, count, 1)]
        if head.startswith(b"COLOR="):
            case.warnings = [*case.warnings, (HEADER_COLOUR, 1, 1)]
        case.notes.append(f"binary, {kind}, header {head[:12]!r}")
        content = head[:80].ljust(80, odd.choice([b"\0", b" "])) + struct.pack("<I", said)
        for facet in self.facets:
            content += struct.pack("<12fH", *self.normal(facet), *numpy.ravel(facet), attribute)
        return content + after

    def write(self):
        self.case.source = self.odd.file_name(self.odd.choice([".stl", ".stl", ".STL"]))
        (self.folder / self.case.source).write_bytes(self.text() if self.is_text else self.binary())
        return self.case


def write_stl(odd, folder, up):
    return StlWriter(odd, folder, up).write()
