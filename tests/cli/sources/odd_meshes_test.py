#!/usr/bin/env python3
"""Tests OBJ, MTL, PLY and STL as other programs write them: voxels, colours and messages.

All of it is of 2026-11-25, rebuilt from public bug reports of neighbouring programs. Usage: odd_meshes_test.py GIGABAKE
SOURCE_DIR
"""
import struct
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness
from png_file import chunk

SQUARE = "v 0 0 0.25\nv 4 0 0.25\nv 4 4 0.25\nv 0 4 0.25\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
FACES = "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
BROWN, WHITE = (200, 100, 50), (255, 255, 255)
PLY = ("ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
       "element face 2\nproperty list uchar int vertex_indices\n{}end_header\n{}")


def png(colour, right=None):
    """Returns a PNG of 4 × 4 texels of one colour, or of two halves."""
    rows = (b"\0" + bytes(colour) * 2 + bytes(right or colour) * 2) * 4
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", 4, 4, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def comb(teeth):
    """Returns teeth of 0.5 m × 3 m on a bar of 1 m."""
    corners = [(0, 0), (teeth, 0)]
    for i in range(teeth, 0, -1):
        corners += [(i, 1), (i - 0.5, 1), (i - 0.5, 4), (i - 1, 4)]
    face = " ".join(str(i + 1) for i in range(len(corners)))
    return "".join(f"v {x} {y} 0.25\n" for x, y in corners) + f"f {face}\n"


class OddMeshes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "t.png").write_bytes(png(BROWN))
        self.count = 0

    def bake(self, name, content, status=0):
        """Returns the number of voxels of each colour, and the warnings."""
        self.count += 1
        source, out = self.root / name, self.root / f"out{self.count}"
        source.write_bytes(content if isinstance(content, bytes) else content.encode())
        result = PROGRAM.run("bake", source, "-o", out, "--voxel-size", 0.5, "--up", "z", "-q")
        self.assertEqual(result.returncode, status, result.stderr)
        if status == 1:
            return result.stderr
        colours = {}
        self.assertEqual(PROGRAM.run("export", out, "-o", self.root / "v.ply").returncode, status)
        for voxel in harness.read_ply(self.root / "v.ply")["rgba"]:
            colour = tuple(int(c) for c in voxel[:3])
            colours[colour] = colours.get(colour, 0) + 1
        return colours, result.stderr

    def material(self, text, faces=FACES):
        (self.root / "m.mtl").write_text("newmtl a\n" + text)
        return self.bake("a.obj", "mtllib m.mtl\n" + SQUARE + "usemtl a\n" + faces)

    def test_spellings_of_obj_and_mtl(self):
        for text in ("map_Kd t.png\nTr 1\n", "map_kd t.png\n", "map_Kd C:\\Users\\me\\t.png\n",
                     "Kd 0 0 0\nmap_Kd -clamp on t.png\n"):
            self.assertEqual(self.material(text), ({BROWN: 64}, ""), text)
        (self.root / "m.mtl").write_text("newmtl a\nmap_Kd t.png\n")
        text = "\ufeffmtllib m.mtl\nmtllib\n" + SQUARE + "usemtl a\n" + FACES.replace("\n", " # note\n")
        for line_end in ("\n", "\r", "\r\n"):
            self.assertEqual(self.bake("a.obj", text.replace("\n", line_end)), ({BROWN: 64}, ""))
        self.assertEqual(self.bake("a.obj", comb(128))[0], {WHITE: 1280})

    def test_comments_signs_and_options_of_mtl(self):
        (self.root / "t # c.png").write_bytes(png((255, 0, 0)))
        for text, colour in (("map_Kd t.png # wood\n", BROWN), ("map_Kd t # c.png\n", (255, 0, 0)),
                             ("MAP_KD -s +2 +2 +1 -o +.5 0 t.png\n", BROWN),
                             ("map_Kd -imfchan m -bm 1 -texres 512 -blendu on t.png\n", BROWN),
                             ("map_Kd \\\\server\\share\\t.png\n", BROWN), ("Kd .5\n", (188, 188, 188)),
                             ("kd +1 0. 0e0\n", (255, 0, 0)), ("Kd 1 0 0\nTr 1.0\nillum 2\n", (255, 0, 0))):
            self.assertEqual(self.material(text), ({colour: 64}, ""), text)
        (self.root / "m.mtl").write_text("newmtl a # oak\nKd 1 0 0\n")
        for use in ("usemtl a\n", "usemtl a # oak\n", "usemtl a # of the roof\n"):
            result = self.bake("a.obj", "mtllib m.mtl # all\n" + SQUARE + use + FACES)
            self.assertEqual(result, ({(255, 0, 0): 64}, ""), use)

    def test_maps_are_scaled_moved_and_clamped(self):
        (self.root / "two.png").write_bytes(png((255, 0, 0), (0, 0, 255)))
        for options, expected in (("", "RRRRBBBB"), ("-s 2 2 1", "RRBBRRBB"), ("-o 0.5 0 0", "BBBBRRRR"),
                                  ("-s 2 1 -clamp on", "RRBBBBBB"), ("-s 2 -clamp off", "RRBBRRBB")):
            self.material(f"map_Kd {options} two.png\n")
            voxels = harness.read_ply(self.root / "v.ply")
            row = voxels[voxels["ijk"][:, 1] == 3]
            row = row[row["ijk"][:, 0].argsort()]["rgba"]
            self.assertEqual("".join("R" if v[0] > v[2] else "B" for v in row), expected, options)

    def test_numbers_without_a_meaning_are_reported(self):
        for text, colour, words in (("Kd nan 0 0\n", (0, 0, 0), "below 0 or not a number"),
                                    ("Kd 1 -2 0\n", (255, 0, 0), "below 0 or not a number"),
                                    ("d 50\n", WHITE, "opacities (d, Tr) outside 0 to 1"),
                                    ("Tr -1\n", WHITE, "opacities (d, Tr) outside 0 to 1")):
            colours, warnings = self.material(text)
            self.assertEqual(colours, {colour: 64}, text)
            self.assertIn(words, warnings)
        (self.root / "m.mtl").write_text("newmtl a\nTr 0.99999\n")
        text = self.bake("a.obj", "mtllib m.mtl\n" + SQUARE + "usemtl a\n" + FACES, status=1)
        self.assertIn("material 'a' of a.obj has alpha 0", text)

    def test_faces_of_obj_in_other_spellings(self):
        for face in ("f 1/ 2// 3 4//1#x\nvn 0 0 1\n", "f 1 1 2 4 2 3 3 4 1\n", "fo -4 \\\n +2 -2 \\\n 4\n"):
            self.assertEqual(self.bake("a.obj", SQUARE + face), ({WHITE: 64}, ""), face)

    def test_what_is_not_used_is_reported(self):
        colours, warnings = self.material("map_Kd gone.png\n")
        self.assertEqual(sum(colours.values()), 64)
        self.assertIn("images are missing, replaced by grey: 1, e.g. 'gone.png'", warnings)
        self.assertIn("colours (Kd) above 1", self.material("Kd 255 0 0\n")[1])
        colours, warnings = self.bake("a.obj", SQUARE.replace("0.25\n", "0.25 200 100 50\n") + FACES)
        self.assertEqual(colours, {WHITE: 64})
        self.assertIn("vertex colours outside 0 to 1", warnings)
        colours, warnings = self.bake("a.obj", SQUARE + FACES + "f 1 2 9\nf 1 2\n", status=3)
        self.assertEqual(colours, {WHITE: 64})
        self.assertIn("a corner refers to no vertex: 1 of 4, e.g. line 11", warnings)

    def test_a_missing_material_file_describes_only_the_materials_that_faces_name(self):
        grey = (127, 127, 127)
        for faces, colour in ((FACES, WHITE), ("usemtl a\n" + FACES, grey), ("usemtl\n" + FACES, WHITE)):
            colours, warnings = self.bake("a.obj", "mtllib gone.mtl\n" + SQUARE + faces)
            self.assertEqual(colours, {colour: 64}, faces)
            self.assertIn("material files are missing", warnings)

    def test_a_face_uses_what_it_has(self):
        (self.root / "m.mtl").write_text("newmtl a\nmap_Kd t.png\n")
        more = "".join(f"v {x} {y} 0.25\n" for x, y in ((6, 0), (10, 0), (10, 4), (6, 4)))
        text = "mtllib m.mtl\n" + SQUARE + more + "usemtl a\n" + FACES + "f 5 6 7\nf 5 7 8\n"
        colours, warnings = self.bake("a.obj", text)
        self.assertEqual(colours, {BROWN: 64, WHITE: 64})
        self.assertIn("faces without texture coordinates, of materials with an image: 2 of 4", warnings)

    def test_ply_and_stl(self):
        corners = "0 0 .25\n4 0 .25\n4 4 .25\n0 4 .25\n"
        rgba = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
        faces = "3 0 1 2 200 100 50 0\n3 0 2 3 200 100 50 0\n"
        colours, warnings = self.bake("a.ply", PLY.format(rgba, corners + faces))
        self.assertEqual(colours, {BROWN: 64})
        self.assertIn("alpha is 0 everywhere", warnings)
        corner = [(0, 0, .25), (4, 0, .25), (4, 4, .25), (0, 4, .25)]
        facets = b"".join(struct.pack("<12fH", 0, 0, 0, *corner[0], *corner[i], *corner[i + 1], 0) for i in (1, 2))
        colours, warnings = self.bake("a.stl", bytes(80) + struct.pack("<I", 1) + facets)
        self.assertEqual(colours, {WHITE: 64})
        self.assertIn("the header states fewer triangles than the file holds", warnings)

    def test_more_ply_and_stl(self):
        corners = ["0 0 .25", "4 0 .25", "4 4 .25", "0 4 .25"]
        faces = "3 0 1 2\n3 0 2 3\n"
        rgb = "".join(f"property float {c}\n" for c in ("RED", "Green", "blue"))
        text = PLY.format(rgb, "\n".join(corners) + "\n3 0 1 2 1 0 0\n3 0 2 3 1 0 0\n")
        self.assertEqual(self.bake("a.ply", text), ({(255, 0, 0): 64}, ""))
        placed = PLY.format("", "\n".join(f"{c} .5 .5" for c in corners) + "\n" + faces)
        placed = placed.replace("property double z\n", "property double z\nproperty float S\nproperty float T\n")
        for key in ("TEXTUREFILE", "texturefile", "TextureFile"):
            named = placed.replace("element vertex", f"comment {key} D:\\scan\\t.png\nelement vertex")
            self.assertEqual(self.bake("a.ply", named), ({BROWN: 64}, ""), key)
        plain = PLY.format("", "\n".join(corners) + "\n" + faces)
        for more, count in (("\n \n", 0), ("3 0 1 2\n", 8), ("note", 4)):
            colours, warnings = self.bake("a.ply", plain + more)
            self.assertEqual(colours, {WHITE: 64}, more)
            self.assertEqual(f"and are not read: 1, e.g. {count} bytes" in warnings, count > 0, warnings)
        six = plain.replace("vertex 4", "vertex 6").replace(faces, "nan nan nan\n1e9 1e9 1e9\n" + faces)
        self.assertEqual(self.bake("a.ply", six), ({WHITE: 64}, ""))

    def test_colours_and_counts_of_stl_are_reported(self):
        corner = [(0, 0, .25), (4, 0, .25), (4, 4, .25), (0, 4, .25)]
        facets = b"".join(struct.pack("<12fH", 0, 0, 0, *corner[0], *corner[i], *corner[i + 1], 0) for i in (1, 2))
        for count, status, words in ((0, 0, "fewer triangles"), (7, 3, "more triangles"), (2 ** 32 - 1, 3, "0x")):
            colours, warnings = self.bake("a.stl", bytes(80) + struct.pack("<I", count) + facets, status=status)
            self.assertEqual(colours, {WHITE: 64})
            self.assertIn(words.replace("0x", "4294967295 and 2"), warnings)
        header = b"COLOR=\xc8\x64\x32\xff".ljust(80)
        colours, warnings = self.bake("a.stl", header + struct.pack("<I", 2) + facets)
        self.assertEqual(colours, {WHITE: 64})
        self.assertIn("a colour in the header, which is not used", warnings)
        loops = "".join("facet normal 0 0 1\nouter loop\n" + "".join("vertex {} {} {}\n".format(*c) for c in loop) +
                        "endloop\nendfacet\n" for loop in (corner[:3], [corner[0], *corner[2:]]))
        text = "solid a\ncolor 1 0 0\n" + loops + "end solid a\n"
        self.assertIn("colours of facets, which are not used", self.bake("a.stl", text)[1])
        for other in ("\ufeff" + text.upper(), "\n" + text.replace("\n", "\r\t")):
            self.assertEqual(self.bake("a.stl", other)[0], {WHITE: 64}, other)

    def test_one_far_vertex_moves_nothing(self):
        corners = ((500000, 5200000), (500004, 5200000), (500004, 5200004), (500000, 5200004))
        utm = "".join(f"v {x} {y} 0.25\n" for x, y in corners) + "vt 0 0\n" * 4
        for far in ("", "v 0 0 0\n", "v 1e9 1e9 1e9\n"):
            self.assertEqual(self.bake("a.obj", utm + far + FACES), ({WHITE: 64}, ""), far)

    def test_an_empty_result_names_its_cause(self):
        for text, words in ((SQUARE, "no triangles"), (SQUARE + "f 1 2 9\n", "refers to no vertex")):
            self.assertIn(words, self.bake("a.obj", text, status=1))
        (self.root / "m.mtl").write_text("newmtl a\nd 0\n")
        self.assertIn("material 'a'", self.bake("a.obj", "mtllib m.mtl\n" + SQUARE + "usemtl a\n" + FACES, status=1))
        result = PROGRAM.run("plan", self.root / "a.obj", "--voxel-size", 0.5)
        self.assertEqual(result.returncode, 1, result)
        self.assertIn("nothing is visible, so a bake would fail", result.stderr)
        self.assertIn("material 'a'", result.stderr)
        self.assertEqual(result.stdout, "")
        (self.root / "b.obj").write_text(SQUARE + FACES)  # one visible source is enough
        (self.root / "two.json").write_text('{"gigabake": 1, "sources": [{"path": "a.obj", "place": {"position_m": '
                                            '[0, 0, 0]}}, {"path": "b.obj", "place": {"position_m": [9, 0, 0]}}]}')
        result = PROGRAM.run("plan", self.root / "two.json", "--voxel-size", 0.5)
        self.assertEqual(result.returncode, 0, result)


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    unittest.main(argv=sys.argv[:1])
