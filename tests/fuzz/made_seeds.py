"""Generated seeds: the smallest files that use each feature of each reader."""
import base64
import copy
import io
import json
import struct
import zipfile
import zlib

import packed_seeds as packed

PART = b"\n#%part\n"
POSITIONS = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1)
INDICES = struct.pack("<6H", 0, 2, 1, 0, 3, 2)


def text(value):
    return json.dumps(value, separators=(",", ":")).encode()


def data_uri(content, kind="application/octet-stream"):
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def png_of_rows(edge, bits, colour_type, packed_rows, interlace=0):
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    head = struct.pack(">IIBBBBB", edge, edge, bits, colour_type, 0, 0, interlace)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", packed_rows) + chunk(b"IEND", b"")


def png(edge, colour_type=6):
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[colour_type]
    rows = b"".join(b"\0" + bytes((x * 37 + y * 11 + c) & 255 for x in range(edge) for c in range(channels))
                    for y in range(edge))
    return png_of_rows(edge, 8, colour_type, zlib.compress(rows))


def square(**more):
    """Returns a glTF document of one square. Its buffer is POSITIONS + INDICES."""
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
            "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
            "buffers": [{"byteLength": 60, "uri": data_uri(POSITIONS + INDICES)}], **more}


def textured(picture, kind, extension=None):
    document = square(images=[{"uri": data_uri(picture, kind)}], samplers=[{"wrapS": 33648, "magFilter": 9728}])
    texture = {"source": 0, "sampler": 0} if extension is None else {"extensions": {extension: {"source": 0}}}
    document["textures"] = [texture]
    transform = {"offset": [0.5, 0], "rotation": 1, "scale": [2, 2]}
    document["materials"] = [{"alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": True, "pbrMetallicRoughness": {
        "baseColorFactor": [1, 0.5, 0.25, 1],
        "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": transform}}}}]
    primitive = document["meshes"][0]["primitives"][0]
    primitive["material"] = 0
    primitive["attributes"].update({"TEXCOORD_0": 2, "COLOR_0": 3})
    document["accessors"] += [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC2"},
        {"bufferView": 0, "componentType": 5121, "normalized": True, "count": 4, "type": "VEC4"}]
    if extension:
        document["extensionsRequired"] = document["extensionsUsed"] = [extension]
    return document


def mapped():
    """Returns a square with vertex normals, a normal map with a transform, and tangents."""
    document = textured(png(4), "image/png")
    document["materials"][0]["normalTexture"] = {
        "index": 0, "scale": 0.5, "extensions": {"KHR_texture_transform": {"scale": [-1, 3], "texCoord": 0}}}
    document["accessors"].append({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC4"})
    document["bufferViews"].append({"buffer": 1, "byteLength": 64})
    document["buffers"].append({"byteLength": 64, "uri": data_uri(struct.pack("<16f", *[1, 0, 0, 1, 0, 0, 0, -1] * 2))})
    document["meshes"][0]["primitives"][0]["attributes"].update({"NORMAL": 0, "TANGENT": 4})
    return document


def sparse():
    document = square()
    document["accessors"][0]["sparse"] = {"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
                                          "values": {"bufferView": 0}}
    document["accessors"].append({"componentType": 5126, "count": 4, "type": "VEC3"})
    document["nodes"] = [{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1], "children": [1]},
                         {"mesh": 0, "rotation": [0, 0, 0, 1], "scale": [2, 2, 2], "translation": [1, 2, 3],
                          "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}}]
    document["meshes"][0]["primitives"] += [{"attributes": {"POSITION": 2}, "mode": m} for m in (0, 1, 5, 6)]
    return document


def draco(content):
    document = square(extensionsRequired=["KHR_draco_mesh_compression"])
    document["bufferViews"] = [{"buffer": 0, "byteLength": len(content)}]
    document["buffers"] = [{"byteLength": len(content), "uri": data_uri(content)}]
    for accessor in document["accessors"]:
        accessor.pop("bufferView")
    document["meshes"][0]["primitives"][0]["extensions"] = {
        "KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
    return document


def meshopt():
    content = packed.MESHOPT_ATTRIBUTES + packed.MESHOPT_TRIANGLES
    at = len(packed.MESHOPT_ATTRIBUTES)
    document = square(extensionsRequired=["EXT_meshopt_compression"])
    document["buffers"] = [{"byteLength": len(content), "uri": data_uri(content)}, {"byteLength": 72}]
    views = [(0, at, 12, 4, "ATTRIBUTES", 48), (at, len(content) - at, 2, 6, "TRIANGLES", 12)]
    document["bufferViews"] = [
        {"buffer": 1, "byteLength": length, "extensions": {"EXT_meshopt_compression": {
            "buffer": 0, "byteOffset": begin, "byteLength": size, "byteStride": stride, "count": count, "mode": mode}}}
        for begin, size, stride, count, mode, length in views]
    return document


def glb(document, content=b""):
    document = copy.deepcopy(document)
    if content:
        document["buffers"] = [{"byteLength": len(content)}]
    body = text(document)
    body += b" " * (-len(body) % 4)
    content += b"\0" * (-len(content) % 4)
    chunks = struct.pack("<II", len(body), 0x4E4F534A) + body
    if content:
        chunks += struct.pack("<II", len(content), 0x004E4942) + content
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def external():
    document = square()
    document["buffers"] = [{"byteLength": 60, "uri": "data.bin"}]
    return text(document) + PART + POSITIONS + INDICES


def wrapped(kind, table, binary, body, *more):
    table = text(table)
    table += b" " * (-len(table) % 8)
    head = 28 + 4 * len(more)
    lengths = struct.pack("<6I", 1, head + len(table) + len(binary) + len(body), len(table), len(binary), 0, 0)
    return kind + lengths + struct.pack(f"<{len(more)}I", *more) + table + binary + body


def b3dm():
    return wrapped(b"b3dm", {"BATCH_LENGTH": 0, "RTC_CENTER": [1, 2, 3]}, b"", glb(square(), POSITIONS + INDICES))


def i3dm():
    model = glb(square(), POSITIONS + INDICES)
    plain = {"INSTANCES_LENGTH": 2, "POSITION": {"byteOffset": 0}, "NORMAL_UP": {"byteOffset": 24},
             "NORMAL_RIGHT": {"byteOffset": 48}, "SCALE": {"byteOffset": 72}}
    columns = struct.pack("<20f", 1, 2, 3, 4, 5, 6, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 0, 2, 3)
    quantized = {"INSTANCES_LENGTH": 1, "POSITION_QUANTIZED": {"byteOffset": 0}, "EAST_NORTH_UP": True,
                 "QUANTIZED_VOLUME_OFFSET": [6378137, 0, 0], "QUANTIZED_VOLUME_SCALE": [10, 10, 10],
                 "NORMAL_UP_OCT32P": {"byteOffset": 6}, "NORMAL_RIGHT_OCT32P": {"byteOffset": 10}}
    return [wrapped(b"i3dm", plain, columns, model, 1),
            wrapped(b"i3dm", quantized, struct.pack("<7H2x", 1, 2, 3, 4, 5, 6, 7), b"model.gltf  ", 0)]


def tile(**more):
    return {"geometricError": 8, "boundingVolume": {"box": [0, 0, 0, 9, 0, 0, 0, 9, 0, 0, 0, 9]}, "refine": "REPLACE",
            "content": {"uri": "model.gltf"}, **more}


def tileset(root, **more):
    return {"asset": {"version": "1.1"}, "geometricError": 9, "root": root, **more}


def tilesets():
    earth = [0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 6378137, 0, 0, 1]
    implicit = {"subdivisionScheme": "QUADTREE", "subtreeLevels": 2, "availableLevels": 3,
                "subtrees": {"uri": "all.subtree"}}
    return [text(tileset(tile(transform=earth, children=[tile(refine="ADD", content={"uri": "nested.json"})]))),
            text(tileset(tile(implicitTiling=implicit))),
            text(tileset(tile(boundingVolume={"region": [0, 0, 0.1, 0.1, 0, 9]}, implicitTiling={
                **implicit, "subdivisionScheme": "OCTREE"}, contents=[{"uri": "model.gltf"}, {"uri": "gone.glb"}])))]


def subtrees():
    document = {"buffers": [{"byteLength": 16}], "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 16}],
                "tileAvailability": {"bitstream": 0}, "contentAvailability": [{"bitstream": 0}, {"constant": 1}],
                "childSubtreeAvailability": {"bitstream": 0}}
    # An octree's subtree of three levels has 73 tiles and 512 children.
    document["buffers"][0]["byteLength"] = document["bufferViews"][0]["byteLength"] = 64
    body = text(document)
    body += b" " * (-len(body) % 8)
    whole = b"subt" + struct.pack("<IQQ", 1, len(body), 64) + body + b"\x5a" * 64
    document["buffers"][0]["uri"] = "bits.bin"
    return [whole, text(document) + PART + b"\xa5" * 64]


def archives():
    out = []
    for method in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        file = io.BytesIO()
        with zipfile.ZipFile(file, "w", method) as archive:
            for name, content in (("tileset.json", text(tileset(tile()))), ("model.gltf", text(square()))):
                archive.writestr(zipfile.ZipInfo(name), content, method)
        out.append(file.getvalue())
    return out


def objs():
    faces = b"v 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 1e-3\nv 5e6 4e6 100\nvt 0 0\nvt 1 1 0\nvn 0 0 1\n"
    return [b"mtllib material.mtl\n" + faces + b"g one\nusemtl m\nf 1/1/1 2/2/1 3/1/1 4//1\nf -1 -2 -3\nl 1 2\np 1\n" +
            PART + b"newmtl m\nKd 1 0.5 0\nd 0.5\nmap_Kd missing.png\nnewmtl n\nTr 1\nmap_d -o 1 1 missing.png\n" +
            b"norm -bm .5 n.png\n",
            faces + b"f 1 2 3 \\\n4\n"]


def plys():
    """Returns ASCII with all face properties, strips, both byte orders, only points, and a distant point."""
    xyz = b"property float x\nproperty float y\nproperty float z\n"
    faces = b"property list uchar int vertex_indices\n"
    square_of = b"0 0 0\n1 0 0\n1 1 0\n0 1 1e-3\n"
    out = [b"ply\nformat ascii 1.0\ncomment TextureFile one.png\nobj_info x\nelement vertex 4\n" + xyz +
           b"element face 3\n" + faces + b"property list uchar float texcoord\nproperty int texnumber\nend_header\n" +
           square_of + b"4 0 1 2 3 8 0 0 1 0 1 1 0 1 0\n3 0 1 2 6 0 0 1 0 nan 1 5\n2 0 1 0 0\n" + PART + png(4),
           b"ply\nformat ascii 1.0\nelement vertex 4\n" + xyz +
           b"element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + square_of +
           b"7 0 1 2 3 -1 0 1\n", b"ply\nformat ascii 1.0\nelement vertex 2\n" + xyz + b"end_header\n1 2 3\ninf 0 0\n",
           b"ply\nformat ascii 1.0\nelement vertex 3\n" + xyz + b"element face 1\n" + faces +
           b"end_header\n4331297 567964 4633220\n4331298 567964 4633220\n4331297 567965 4633220\n3 0 1 2\n"]
    for order, name in (("<", b"little"), (">", b"big")):
        body = struct.pack(f"{order}bHHdd", 2, 1, 2, 3, 4)
        for v in range(5):
            body += struct.pack(f"{order}3d4BffH", v % 2, v // 2, 0.5, v * 50, 1, 2, 128, 0.25, 0.75, v)
        body += struct.pack(f"{order}I5hi", 5, 0, 1, 3, 4, 2, -1)
        out.append(b"ply\nformat binary_" + name + b"_endian 1.0\ncomment TextureFile one.png\nelement other 1\n"
                   b"property list char ushort a\nproperty double b\nproperty double c\nelement vertex 5\n"
                   b"property double x\nproperty double y\nproperty double z\n"
                   b"property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
                   b"property float s\nproperty float t\n"
                   b"property ushort id\nelement face 1\nproperty list uint short vertex_index\nproperty int f\n"
                   b"end_header\n" + body + PART + png(4))
    return out


def stls():
    facet = b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
    end = b"endloop\nendfacet\nendsolid\n"
    binary = struct.pack("<I12fH12fH", 2, *range(12), 0, *range(12), 7)
    return [b"solid one\n" + facet + end + b"solid two\n" + facet + b"vertex 0.5 0.25 nan\n" + end,
            b"a name".ljust(80, b"\0") + binary, b"solid of bytes".ljust(80) + binary,
            b"far".ljust(80) + struct.pack("<I12fH", 1, 0, 0, 1, 4331297, 567964, 4633220, 4331298, 567964, 4633220,
                                           4331297, 567965, 4633220, 0)]


def tiff(edge, samples):
    """Returns a TIFF: little endian, one strip of bytes, a place in EPSG:25832."""
    content = bytes((i * 7) & 63 for i in range(edge * edge * samples))
    places = struct.pack("<3d", 10, 10, 0) + struct.pack("<6d", 0, 0, 0, 500000, 5100160, 0)
    tags = [(256, 3, 1, edge), (257, 3, 1, edge), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1 if samples == 1 else 2),
            (273, 4, 1, 8), (277, 3, 1, samples), (278, 3, 1, edge), (279, 4, 1, len(content)), (284, 3, 1, 1),
            (33550, 12, 3, 8 + len(content)), (33922, 12, 6, 32 + len(content))]
    if samples == 3:
        tags[2] = (258, 3, 3, 80 + len(content))
    directory = struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", *t) for t in tags) + b"\0" * 4
    bits = struct.pack("<3H", 8, 8, 8)
    return b"II*\0" + struct.pack("<I", 88 + len(content)) + content + places + bits + b"\0\0" + directory


def rasters():
    grid = b"ncols 3\nnrows 2\nxllcorner 500000\nyllcorner 5100000\ncellsize 10\nnodata_value -9999\n"
    return [tiff(4, 1), grid + b"1 2 3\n4.5 -9999 6\n"]


def scenes():
    place = {"path": "model.gltf", "place": {"position_m": [1, 2, 3]}, "heading_deg": 30, "scale": 2}
    earth = {"path": "set.json", "place": {"lon_lat_height": [8.25, 46.5, 1200]}}
    ring = [[0, 0], [4, 0], [4, 4.5], [1, 3]]
    cut = [{"type": "outside", "rings_m": [ring, [[1, 1], [2, 1], [2, 2]]]},
           {"type": "raise", "rings_m": [ring], "by_m": 2}, {"type": "flatten", "rings_m": [ring], "height_m": -1}]
    mesh = {"positions_m": [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]],
            "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]}
    edits = [{"type": "carve", "box": {"min_m": [0, 0, 0], "max_m": [1, 2, 3]}},
             {"type": "fill", "sphere": {"position_m": [1, 2, 3], "radius_m": 2}, "rgb": [1, 2, 3]},
             {"type": "paint", "cylinder": {"position_m": [1, 2, 3], "radius_m": 2, "height_m": 4}, "rgb": [9, 8, 7],
              "alpha": 99}, {"type": "carve", "prism": {"rings_m": [ring], "low_m": -1, "high_m": 5}},
             {"type": "carve", "mesh": mesh}]
    sizes = {"voxel_size_m": 2, "voxel_size_of_material": {"": 4, "b": 1}, "voxel_size_of_node": {"": 1, "a": 8}}
    bounds = {"min_lon_lat_height": [8.25, 46.5, 1200], "max_lon_lat_height": [8.26, 46.51, 1210]}
    degrees = [{"type": "paint", "box": bounds, "rgb": [0, 0, 0]}]
    return [text({"gigabake": 1, "sources": [place]}), text({"gigabake": 1, "sources": [earth]}),
            text({"gigabake": 1, "sources": [{**place, "edits": cut}], "edits": edits}),
            text({"gigabake": 1, "sources": [earth], "edits": degrees}),
            text({"gigabake": 1, "sources": [{**place, **sizes}]})]


def geojsons():
    ring = [[8, 46], [8.5, 46.1], [8.2, 46.4], [8, 46]]
    hole = [[8.2, 46.1], [8.25, 46.1], [8.25, 46.2], [8.2, 46.1]]
    east = [[179.9, 1], [-179.9, 1], [-179.9, 2, 100], [179.9, 1]]
    line = {"type": "LineString", "coordinates": [[179, -1], [-179, 2.5, 7], [-178, 2.5]]}
    return [text({"type": "MultiPolygon", "coordinates": [[ring, hole], [east]]}),
            text({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": line}]}),
            text({"type": "GeometryCollection", "geometries": [{"type": "Polygon", "coordinates": [ring]}],
                  "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}})]


def camera_paths():
    frames = [{"time_s": 0, "eye": [0, -9, 5], "target": [0, 0, 0]},
              {"time_s": 2.5, "eye": [9, 0, 5], "target": [0, 0, 0], "fovy_deg": 60, "up": [0, 0, 1]}]
    degrees = [{"time_s": 1, "eye": [46.5, 8.25, 1300], "target": [46.51, 8.26, 1200]}]
    return [text({"keyframes": frames}), text({"coordinates": "geographic", "keyframes": degrees})]


def made():
    """Returns seeds by reader."""
    gltf = [square(), sparse(), textured(png(4), "image/png"), textured(packed.JPEG, "image/jpeg"),
            textured(packed.WEBP, "image/webp", "EXT_texture_webp"), draco(packed.DRACO_EDGEBREAKER),
            draco(packed.DRACO_SEQUENTIAL), meshopt(), mapped()]
    tiles = [b3dm(), *i3dm()]
    inner = b"".join(tiles)
    return {
        "gltf": [text(d) for d in gltf] + [glb(square(), POSITIONS + INDICES), external()],
        "tile": tiles + [b"cmpt" + struct.pack("<3I", 1, 16 + len(inner), len(tiles)) + inner],
        "tileset": tilesets(),
        "subtree": subtrees(),
        "archive": archives(),
        "scene_json": scenes(),
        "obj": objs(),
        "ply": plys(),
        "stl": stls(),
        "raster": rasters(),
        "orthophoto": [tiff(4, 3), png(4, 2), packed.JPEG],
        "geojson": geojsons(),
        "image": [png(4), png(4, 0), packed.JPEG, packed.WEBP, packed.WEBP_LOSSLESS],
        "journal": [b"gigabake"],
        "scan_cache": [b"gigabake"],
        "bake_status": [b"{}"],
        "bake_messages": [bytes([kind]) + b"\0" * 64 for kind in range(9)],
        "camera_path": camera_paths(),
        "steering": [b'{"turn":[0.1,0.2],"zoom":1,"walk":[1,0,0]}\n{"pose":[1,2,3,4,5,6],"size":[640,480]}',
                     b'{"home":true,"style":"fly","swing":[1,0],"pixel_error":2,"upload_ms":5,"pan":[1,1]}'],
        "http_head": [b"POST\nlocalhost:8080\nhttp://localhost:8080\napplication/json\n12\na=1; gigabake=0123\n"],
    }
