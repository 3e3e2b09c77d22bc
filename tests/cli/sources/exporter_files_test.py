#!/usr/bin/env python3
"""Files as exporters and tilers write them, rebuilt from public reports about other programs, give the voxels that
their format states. All of it is of 2026-11-25. Usage: exporter_files_test.py GIGABAKE SOURCE_DIR
"""
import base64
import gzip
import json
import struct
import sys
import xml.etree.ElementTree
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import harness

from mesh_files_test import ecef
from png_file import chunk

COLOUR = (200, 100, 50)
# A square of 4 m at z = 0.25 m, y up, is 64 voxels of 0.5 m.
POSITIONS = struct.pack("<12f", 0, .25, 0, 4, .25, 0, 4, .25, -4, 0, .25, -4)
INDICES = struct.pack("<6H", 0, 1, 2, 0, 2, 3)
UVS = struct.pack("<8f", 0, 1, 1, 1, 1, 0, 0, 0)


def png(*chunks, alpha=None, bits=8):
    values = COLOUR + (() if alpha is None else (alpha,))
    texel = bytes(values) if bits == 8 else b"".join(struct.pack(">H", 257 * v) for v in values)
    head = struct.pack(">IIBBBBB", 8, 8, bits, 2 if alpha is None else 6, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + b"".join(chunks) +
            chunk(b"IDAT", zlib.compress((b"\0" + texel * 8) * 8)) + chunk(b"IEND", b""))


def data_uri(media, data):
    return f"data:{media};base64,{base64.b64encode(data).decode()}"


def document(material, image=None, binary=POSITIONS + INDICES + UVS, uri=None):
    """Returns a square as glTF with one buffer: `binary`, followed by an image if `image` is bytes."""
    if isinstance(image, bytes):
        offset, binary = len(binary), binary + image + bytes(-len(image) % 4)
        images = [{"bufferView": 3, "mimeType": "image/png"}]
    else:
        offset, images = 0, [{"uri": image}] if image else []
    views = [(0, 48), (48, 12), (60, 32)] + ([(offset, len(image))] if isinstance(image, bytes) else [])
    made = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": 0}]}],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in views],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, .25, -4],
                       "max": [4, .25, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
                      {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}],
        "materials": [material], "buffers": [{"byteLength": len(binary), **({"uri": uri} if uri else {})}]}
    if images:
        made.update(images=images, textures=[{"source": 0}])
    return made, binary


TEXTURED = {"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0}}}


def linear(code):
    v = code / 255
    return v / 12.92 if v <= .04045 else ((v + .055) / 1.055) ** 2.4


FACTOR = {"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [*map(linear, COLOUR), 1]}}


def write_glb(path, material, image=None, **changes):
    made, binary = document(material, image)
    made.update(changes)
    harness.write_glb_document(path, made, binary)
    return path


def write_b3dm(path, material, table=None, image=None, **changes):
    write_glb(path, material, image, **changes)
    model = path.read_bytes()
    text = json.dumps({"BATCH_LENGTH": 0, **(table or {})}).encode()
    text += b" " * (-(28 + len(text)) % 8)
    path.write_bytes(b"b3dm" + struct.pack("<6I", 1, 28 + len(text) + len(model), len(text), 0, 0, 0) + text + model)
    return path


def tileset(*uris, volume=None, **root):
    children = [{"boundingVolume": {"sphere": [0, 0, 0, 50]}, "geometricError": 0, "content": {"uri": uri}}
                for uri in uris]
    return {"asset": {"version": "1.0"}, "geometricError": 100,
            "root": {"boundingVolume": volume or {"sphere": [0, 0, 0, 50]}, "geometricError": 10, "refine": "ADD",
                     "children": children, **root}}


PLACE = (47.37, 8.54, 430)


def earth_transform(place):
    """Returns the column-major matrix of a tile with its origin at a place and the axes east, north and up."""
    centre, axes = ecef(*place)
    return [v for axis in axes for v in (*axis, 0)] + [*centre, 1]


class ExporterFiles(harness.FolderTest):
    def bake(self, source, *arguments, status=0):
        """Bakes and exports `source`. Returns the exported voxels and the output of the bake."""
        out, ply = self.root / "out", self.root / "out.ply"
        result = PROGRAM.run("bake", source, "-o", out, "--voxel-size", 0.5, *arguments)
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        exported = PROGRAM.run("export", out, "-o", ply, "--lod", 0)
        self.assertIn(exported.returncode, (0, status), exported.stderr)
        return harness.read_ply(ply), result.stdout + result.stderr

    def bake_in_a_row(self, paths, status=0):
        """Bakes all files at once, each 10 m behind the previous one. Returns the voxels per file, and the text."""
        scene = self.root / "row.json"
        scene.write_text(json.dumps({"gigabake": 1, "sources": [
            {"path": str(p.relative_to(self.root)), "place": {"position_m": [10 * i, 0, 0]}}
            for i, p in enumerate(paths)]}))
        voxels, text = self.bake(scene, status=status)
        place = voxels["ijk"][:, 0] // 20
        return [voxels[place == i] for i in range(len(paths))], text

    def expect_square(self, voxels, name, colour=COLOUR, alpha=255):
        self.assertEqual(len(voxels), 64, name)
        self.assertEqual({tuple(v) for v in voxels["rgba"].tolist()}, {(*colour, alpha)}, name)

    def write_variants(self):
        gamma, linear_gamma = struct.pack(">I", 45455), struct.pack(">I", 100000)
        primaries = struct.pack(">8I", 31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600)
        images = {
            "plain": png(), "gamma": png(chunk(b"gAMA", linear_gamma)), "srgb_gamma": png(chunk(b"gAMA", gamma)),
            "primaries": png(chunk(b"gAMA", linear_gamma), chunk(b"cHRM", primaries)), "sixteen": png(bits=16),
            "sixteen_srgb": png(chunk(b"sRGB", b"\0"), bits=16),
            "bad_profile": png(chunk(b"iCCP", b"x\0\0" + zlib.compress(b"no profile")))}
        for name, image in images.items():
            yield write_glb(self.root / f"{name}.glb", TEXTURED, image)
        yield write_glb(self.root / "emissive.glb", {
            "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0},
            "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}}, png())
        yield write_glb(self.root / "emissive_factor.glb", {
            "emissiveFactor": list(map(linear, COLOUR)), "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}})
        yield write_glb(self.root / "clamp.glb", TEXTURED, png(), samplers=[{"wrapS": 10496, "wrapT": 33069}],
                        textures=[{"source": 0, "sampler": 0}])
        yield write_glb(self.root / "hidden.glb", FACTOR, extensionsUsed=["KHR_node_visibility"],
                        scenes=[{"nodes": [0, 1]}],
                        nodes=[{"mesh": 0, "translation": [0, 2, 0],
                                "extensions": {"KHR_node_visibility": {"visible": False}}}, {"mesh": 0}])
        technique = {"technique": 0, "values": {"u_diffuse": {"index": 0, "texCoord": 0}}}
        yield write_glb(self.root / "technique.glb", {"extensions": {"KHR_techniques_webgl": technique}}, png(),
                        extensionsUsed=["KHR_techniques_webgl"])
        (self.root / "Textures").mkdir(exist_ok=True)
        (self.root / "Textures/t.png").write_bytes(png())
        yield write_glb(self.root / "backslash.glb", TEXTURED, "Textures\\t.png")
        media = {"jpg": data_uri("image/jpg", png()), "webp_type": data_uri("image/webp;x=y", png()),
                 "none": data_uri("", png())}
        for name, uri in media.items():
            made, binary = document(TEXTURED, uri, uri="B")
            made["buffers"][0]["uri"] = data_uri("application/octet-stream;charset=utf-8", binary)
            path = self.root / f"{name}.gltf"
            path.write_text(json.dumps(made))
            yield path

    def test_spellings_and_materials_of_exporters(self):
        paths = list(self.write_variants())
        row, text = self.bake_in_a_row(paths)
        for path, voxels in zip(paths, row):
            self.expect_square(voxels, path.name)
        self.assertIn("clamp.glb: wrap modes that glTF does not define, read as clamp to edge: 2, e.g. "
                      "samplers[0].wrapS 10496", text)

    def test_an_image_that_cannot_be_used_costs_itself(self):
        paths = [write_glb(self.root / "lost.glb", TEXTURED, "Textures\\T.PNG"),
                 write_glb(self.root / "cut.glb", TEXTURED, png()[:-30]),
                 write_glb(self.root / "whole.glb", TEXTURED, png())]
        row, text = self.bake_in_a_row(paths, status=3)
        self.expect_square(row[0], "lost", (127, 127, 127))
        self.expect_square(row[1], "cut", (127, 127, 127))
        self.expect_square(row[2], "whole")
        self.assertIn("no such file: ", text)
        self.assertIn("Textures/T.PNG", text)
        self.assertIn("the image is cut short", text)

    def test_the_place_is_that_of_the_content(self):
        centre = ecef(*PLACE)[0]
        write_b3dm(self.root / "a.b3dm", FACTOR)
        globe = {"region": [-3.141592653589793, -1.5707963267948966, 3.141592653589793, 1.5707963267948966, 0, 100]}
        made = tileset("a.b3dm", volume=globe)
        made["root"]["children"][0]["transform"] = earth_transform(PLACE)
        (self.root / "globe.json").write_text(json.dumps(made))
        _, axes = ecef(*PLACE)
        # The same square by RTC_CENTER, with vertices in earth-centred axes, y up.
        corners = [(x * e + y * n + .25 * u) for x, y in ((0, 0), (4, 0), (4, 4), (0, 4)) for e, n, u in zip(*axes)]
        rows = [corners[i:i + 3] for i in range(0, 12, 3)]
        harness.write_glb(self.root / "rtc.b3dm", [(x, z, -y) for x, y, z in rows], [0, 1, 2, 0, 2, 3],
                          material=FACTOR)
        model, table = (self.root / "rtc.b3dm").read_bytes(), json.dumps({"RTC_CENTER": centre}).encode()
        table += b" " * (-(28 + len(table)) % 8)
        (self.root / "rtc.b3dm").write_bytes(b"b3dm" + struct.pack("<6I", 1, 28 + len(table) + len(model), len(table),
                                                                  0, 0, 0) + table + model)
        ball = {"box": [0, 0, 0, 7972671, 0, 0, 0, 7972671, 0, 0, 0, 7972671]}
        (self.root / "ball.json").write_text(json.dumps(tileset("rtc.b3dm", volume=ball)))
        for name in ("globe.json", "ball.json"):
            for origin in ([], ["--origin", ",".join(map(str, PLACE))]):
                voxels, _ = self.bake(self.root / name, *origin)
                self.expect_square(voxels, name)
                self.assertLess(abs(voxels["p"]).max(), 4.1, name)
                self.assertEqual(len(set(voxels["ijk"][:, 2].tolist())), 1, name)
                shown = json.loads(PROGRAM.run("info", self.root / "out", "--json").stdout)["origin"]
                self.assertAlmostEqual(shown["latitude_deg"], PLACE[0], 3)
                self.assertAlmostEqual(shown["longitude_deg"], PLACE[1], 3)

    # Regression of 2026-11-25: images with a constant alpha between the cutoff and 1 were absent.
    def test_an_alpha_test_passes_all_of_an_image_from_the_cutoff_on(self):
        paths = [write_glb(self.root / f"{alpha}.glb", {**TEXTURED, "alphaMode": "MASK", "alphaCutoff": 128 / 255},
                           png(alpha=alpha)) for alpha in (127, 128, 129, 192, 254, 255)]
        row, _ = self.bake_in_a_row(paths)
        self.assertEqual(len(row[0]), 0)
        for path, voxels in zip(paths[1:], row[1:]):
            self.expect_square(voxels, path.name)

    # Regression of 2026-11-25: both were read as local coordinates, 6,378 km off, without a message.
    def test_packed_content_and_content_at_the_equator_have_their_place(self):
        globe = {"region": [-3.141592653589793, -1.5707963267948966, 3.141592653589793, 1.5707963267948966, 0, 100]}
        for name, place, work in (("packed", PLACE, gzip.compress), ("equator", (0, 180, 0), bytes)):
            path = write_b3dm(self.root / f"{name}.b3dm", FACTOR)
            path.write_bytes(work(path.read_bytes()))
            made = tileset(path.name, volume=globe)
            made["root"]["children"][0]["transform"] = earth_transform(place)
            (self.root / f"{name}.json").write_text(json.dumps(made))
            voxels, _ = self.bake(self.root / f"{name}.json", "--origin", ",".join(map(str, place)))
            self.expect_square(voxels, name)
            self.assertLess(abs(voxels["p"]).max(), 4.1, name)

    def test_uris_of_a_tileset_cost_their_own_tiles(self):
        write_b3dm(self.root / "a.b3dm", FACTOR)
        (self.root / "Data").mkdir(exist_ok=True)
        write_b3dm(self.root / "Data/b.b3dm", FACTOR)
        made = tileset("a.b3dm", "", "http://localhost/p.b3dm", "Data\\b.b3dm")
        made["asset"]["version"], made["root"]["refine"] = "1.0.0", "Add"
        made["root"]["children"][3]["transform"] = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 6, 0, 0, 1]
        (self.root / "uris.json").write_text(json.dumps(made))
        voxels, text = self.bake(self.root / "uris.json", status=3)
        self.assertEqual(len(voxels), 128)
        self.assertIn("root.children[1].content.uri", text)
        self.assertIn("root.children[2].content.uri", text)

    def test_a_folder_is_its_tileset_by_any_name(self):
        folder = self.root / "Production"
        (folder / "Data").mkdir(parents=True)
        write_b3dm(folder / "Data/L10.b3dm", TEXTURED, image=png())
        write_b3dm(folder / "Data/L20.b3dm", FACTOR)
        made = tileset("Data/L20.b3dm", refine="REPLACE", content={"uri": "Data/L10.b3dm"},
                       transform=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 0, 0, 1])
        (folder / "Production_1.json").write_text(json.dumps(made))
        voxels, _ = self.bake(folder)
        self.expect_square(voxels, "folder")
        self.assertEqual((voxels["p"][:, 0].min(), voxels["p"][:, 0].max()), (100.25, 103.75))

    def test_a_texture_or_sampler_that_is_not_there_costs_one_image(self):
        grey, base = (127, 127, 127), {"pbrMetallicRoughness": {"baseColorTexture": {}}}
        cases = (({"textures": [{"source": 7}]}, TEXTURED, grey), ({"textures": []}, TEXTURED, grey), ({}, base, grey),
                 ({"textures": [{"source": 0, "sampler": 7}]}, TEXTURED, COLOUR),
                 ({"textures": [{"source": "0"}]}, TEXTURED, grey))
        paths = [write_glb(self.root / f"none{i}.glb", material, png(), **changes)
                 for i, (changes, material, _) in enumerate(cases)]
        row, text = self.bake_in_a_row(paths, status=3)
        for path, voxels, case in zip(paths, row, cases):
            self.expect_square(voxels, path.name, case[2])
            self.assertIn(path.name, text)

    def test_numbers_of_samplers_and_techniques_without_another_colour(self):
        technique = {"technique": 0, "values": {"u_diffuse": {"index": 0}}}
        samplers = [{"wrapS": 33071.0, "wrapT": "repeat", "magFilter": -1}]
        paths = [write_glb(self.root / "float.glb", TEXTURED, png(), samplers=samplers,
                           textures=[{"source": 0, "sampler": 0}]),
                 write_glb(self.root / "metallic.glb", {"pbrMetallicRoughness": {"metallicFactor": 0},
                                                        "extensions": {"KHR_techniques_webgl": technique}}, png())]
        row, text = self.bake_in_a_row(paths)
        for path, voxels in zip(paths, row):
            self.expect_square(voxels, path.name)
        self.assertIn("float.glb: wrap modes that glTF does not define, read as repeat: 1, e.g. samplers[0].wrapT",
                      text)

    def test_an_entry_that_is_no_tile_costs_itself(self):
        write_b3dm(self.root / "a.b3dm", FACTOR)
        made = tileset("a.b3dm")
        made["root"]["children"][:0] = [None, 7]
        (self.root / "null.json").write_text(json.dumps(made))
        voxels, text = self.bake(self.root / "null.json", status=3)
        self.expect_square(voxels, "null")
        self.assertIn("root.children: expected tiles, which are JSON objects", text)

    def test_a_folder_whose_tileset_cannot_be_read_is_not_its_tiles(self):
        folder = self.root / "unreadable"
        folder.mkdir()
        write_b3dm(folder / "coarse.b3dm", FACTOR)
        write_b3dm(folder / "fine.b3dm", FACTOR)
        text = json.dumps(tileset("fine.b3dm", content={"uri": "coarse.b3dm"}))
        for content, words in (("\ufeff" + text, "byte order mark"), (text.replace("10,", "NaN,"), "NaN is not a JSON"),
                               (text[:-1], "expected '}'")):
            (folder / "Scene.json").write_text(content)
            result = PROGRAM.run("bake", folder, "-o", self.root / "out", "--voxel-size", 0.5)
            self.assertEqual(result.returncode, 1, result)
            self.assertIn("Scene.json", result.stderr)
            self.assertIn(words, result.stderr)

    def test_paths_of_a_scene_are_plain(self):
        (self.root / "sub").mkdir(exist_ok=True)
        names = ["100%.glb", "a%20b.glb", "c d#1?.glb", "sub/%41.glb"]
        for name in names:
            write_glb(self.root / name, FACTOR)
        for path in (*names, "sub\\%41.glb"):
            scene = self.root / "plain.json"
            scene.write_text(json.dumps({"gigabake": 1, "sources": [{"path": path}]}))
            self.expect_square(self.bake(scene)[0], path)
        scene.write_text(json.dumps({"gigabake": 1, "sources": [{"path": "c%20d%231%3F.glb"}]}))
        result = PROGRAM.run("plan", scene, "--voxel-size", 0.5)
        self.assertEqual(result.returncode, 1)
        self.assertIn("c%20d%231%3F.glb", result.stderr)

    def test_names_of_any_bytes_leave_every_output_well_formed(self):
        name = "n\u0001\u001b\ufffe\uffff\ud800<&\"'>]]>\u2028\U0001f600"
        write_b3dm(self.root / "a.b3dm", FACTOR)
        made = tileset("a.b3dm", "gone_NAME.b3dm")
        text = json.dumps(made).replace("NAME", json.dumps(name.replace("\ud800", ""))[1:-1])
        source = self.root.joinpath("names").absolute()
        source.mkdir()
        (self.root / "a.b3dm").rename(source / "a.b3dm")
        file = str(source).encode() + b"/t\xff\xfe\x01\xed\xa0\x80.json"
        with open(file, "w") as out:
            out.write(text)
        report, metrics, out = self.root / "report.json", self.root / "metrics.txt", self.root / "names_out"
        result = PROGRAM.run("bake", file.decode(errors="surrogateescape"), "-o", out, "--voxel-size", 0.5, "--report",
                             report, "--metrics", metrics, errors="replace")
        self.assertEqual(result.returncode, 3, result.stderr)
        xml.etree.ElementTree.parse(out / "scene.xml")
        json.loads(report.read_bytes().decode("utf-8"))
        metrics.read_bytes().decode("utf-8")
        for command in (["info", out], ["verify", out], ["status", out], ["diff", out, out]):
            json.loads(PROGRAM.run(*command, "--json").stdout)
        tiles = self.root / "exported"
        self.assertEqual(PROGRAM.run("export", out, "--to", "3dtiles", "-o", tiles).returncode, 3)
        for path in tiles.rglob("*.json"):
            json.loads(path.read_bytes().decode("utf-8"))

    def test_a_damaged_name_costs_no_source(self):
        """Tests names in Latin-1 and unpaired surrogates in materials, meshes, ids, URIs and groups."""
        names = [b"\\ud800", b"x\\uDC00", b"Stra\xdfe", b"\xed\xa0\x80", b"\\u0001\\ufffe]]>&<"]
        for number, name in enumerate(names):
            made, binary = document(FACTOR, uri="B")
            made["buffers"][0]["uri"] = data_uri("", binary)
            for key in ("materials", "meshes", "nodes", "scenes"):
                made[key][0]["name"] = "NAME"
            made["extensionsUsed"] = ["X_NAME"]
            folder = self.root / f"damaged{number}"
            folder.mkdir()
            (folder / "a.gltf").write_bytes(json.dumps(made).encode().replace(b"NAME", name))
            tiles = json.dumps(tileset("a.gltf", "gone_NAME.glb")).encode().replace(b"NAME", name)
            (folder / "t.json").write_bytes(tiles)
            self.expect_outputs(folder / "t.json")
        obj = self.root / "damaged.obj"
        name = b"\x01\xff\xed\xa0\x80<&]]>"
        obj.write_bytes(b"mtllib %s.mtl\ng %s\no %s\nv 0 .25 0\nv 4 .25 0\nv 4 .25 -4\nv 0 .25 -4\nusemtl %s\n"
                        b"f 1 2 3 4\nf 1 2 9\n%s\n" % ((name,) * 5))
        self.expect_outputs(obj)

    def expect_outputs(self, source):
        """Bakes a source of 64 voxels with a missing input, and checks that all documents are well-formed."""
        report = source.parent / "report.json"
        result = PROGRAM.run("bake", source, "-o", self.root / "out", "--voxel-size", 0.5, "--report", report,
                             errors="replace")  # a message may contain any bytes
        self.assertEqual(result.returncode, 3, result)
        self.assertEqual(PROGRAM.info(self.root / "out")["lods"][0]["voxels"], 64, source)
        json.loads(report.read_bytes().decode("utf-8"))
        xml.etree.ElementTree.parse(self.root / "out/scene.xml")
        plan = PROGRAM.run("plan", source, "--voxel-size", 0.5, "--no-measure", "--json", errors="replace")
        self.assertIn("gone" if source.suffix == ".json" else "corner", str(json.loads(plan.stdout)["losses"]))


if __name__ == "__main__":
    PROGRAM = harness.Gigabake(sys.argv[1])
    harness.main(argv=sys.argv[:1])
