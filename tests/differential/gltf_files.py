"""Writes glTF documents and GLB files: accessors, transforms, materials and all forms of URIs."""
import base64
import json
import struct
from urllib.parse import quote

import numpy

from figures import SLOT, figure, triangulated, voxels_of
from frames import FROM_Z_UP, bounds_of, in_file
from gltf_buffers import Buffers
from gltf_materials import Materials
from gltf_more import QUANTIZATION, Quantized, add_second_node
from odd import Case

EXTENSIONS = "extensions that are not read"
UNUSED_IDS = "primitives with ids that are not used (class_from_ids of a scene .json)"
HIDDEN = "KHR_node_visibility"
INSTANCING = "EXT_mesh_gpu_instancing"


def uri_of(odd, name):
    """Returns a name as a relative URI, with more or fewer characters encoded."""
    safe = odd.choice(["/", "/", "/!$&'()*+,;=@~"])
    out = quote(name, safe=safe)
    if odd.maybe(0.2):
        out = quote(name, safe="/ !$&'()*+,;=@~éÜ日本")
    return odd.choice(["", "", "", "./"]) + out


def data_uri(odd, media_type, data):
    media = odd.choice([media_type, "application/octet-stream", media_type + ";charset=utf-8", ""])
    return f"data:{media};base64,{base64.b64encode(data).decode()}"


def matrix_of(odd):
    """Returns the JSON of a node's transform, and its matrix."""
    kind = odd.choice(["none", "none", "translation", "trs", "matrix", "mirror"])
    if kind == "none":
        return {}, numpy.eye(4)
    move = [odd.choice([0, 1.5, -20, 100, 0.1]) for _ in range(3)]
    matrix = numpy.eye(4)
    matrix[:3, 3] = move
    if kind == "translation":
        return {"translation": move}, matrix
    if kind == "matrix":
        matrix[:3, :3] = [[odd.uniform(0.6, 2) if r == c else odd.uniform(-0.2, 0.2) for c in range(3)]
                          for r in range(3)]
        return {"matrix": matrix.T.reshape(-1).tolist()}, matrix
    q = numpy.array([odd.gauss(0, 1) for _ in range(4)])
    q /= numpy.linalg.norm(q)
    scale = [odd.choice([1, 0.5, 2, 0.1, 10]) for _ in range(3)]
    if kind == "mirror":
        scale[odd.randrange(3)] *= -1
    x, y, z, w = q
    rotation = numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    matrix[:3, :3] = rotation * scale
    return {"translation": move, "rotation": q.tolist(), "scale": scale}, matrix


class GltfWriter:
    """Writes a glTF. `is_closed`: everything is in one GLB, as required for a tile."""

    def __init__(self, odd, folder, up, parts=None, is_closed=False):
        self.odd, self.folder, self.up, self.is_closed = odd, folder, up, is_closed
        self.case = Case("gltf", "", triangles=0)
        self.parts = parts
        self.is_glb = is_closed or odd.maybe()
        self.buffers = Buffers(odd)
        self.materials = Materials(odd, self)
        self.document = {"asset": {"version": "2.0"}}
        self.nodes, self.meshes, self.warned = [], [], {}
        self.used = set()
        self.quantized = None
        self.required = set()

    def warn(self, text, count=1):
        self.warned[text] = self.warned.get(text, 0) + count

    def store(self, media_type, data, suffix):
        """Stores data in a file or in a URI. Returns the URI."""
        odd = self.odd
        if self.is_closed or odd.maybe():
            return data_uri(odd, media_type, data)
        if odd.is_plain:
            name = odd.word() + suffix
        else:
            name = odd.choice(["", "", "sub dir/"]) + odd.file_name(suffix)
        (self.folder / name).parent.mkdir(exist_ok=True)
        (self.folder / name).write_bytes(data)
        return uri_of(odd, name)

    def primitive(self, part, indices, mode, transform):
        """Returns a primitive of a part. transform: from the mesh to the file."""
        odd = self.odd
        points = in_file(part, self.up)
        back = numpy.linalg.inv(transform)
        local = points @ back[:3, :3].T + back[:3, 3]
        used = numpy.unique(numpy.ravel(indices))
        self.case.triangles += len(indices) if mode == 4 else len(indices) - 2
        if self.quantized:
            attributes = {"POSITION": self.quantized.accessor(self.buffers, local)}
        else:
            attributes = {"POSITION": self.buffers.positions(local)}
        material, expected = self.materials.material(part, attributes)
        out = {"attributes": attributes}
        if material is not None:
            out["material"] = material
        if mode != 4 or odd.maybe(0.1):
            out["mode"] = mode
        flat = numpy.ravel(indices)
        if len(used) == len(flat) == len(points) and (flat == numpy.arange(len(flat))).all() and odd.maybe():
            pass  # without indices
        else:
            out["indices"] = self.buffers.indices(flat, len(points))
        if odd.maybe(0.2):
            out["attributes"]["NORMAL"] = self.buffers.plain(numpy.tile([0.0, 0, 1], (len(points), 1)), "VEC3")
        if odd.maybe(0.1):
            out["attributes"]["_BATCHID"] = self.buffers.plain(numpy.zeros((len(points), 1)), "SCALAR")
            self.warn(UNUSED_IDS)
        self.case.voxels.update(expected)
        return out

    def primitives(self, part, transform):
        """Returns the part as one primitive of triangles, or as one strip or fan per quadrangle."""
        odd = self.odd
        mode = odd.choice([4, 4, 4, 5, 6]) if part.place is None else 4
        if mode == 4:
            if odd.maybe(0.2):
                self.separate_corners(part)
            triangulated(odd, part)
            return [self.primitive(part, part.polygons, 4, transform)]
        if len(part.polygons) > 6:
            triangulated(odd, part)
            return [self.primitive(part, part.polygons, 4, transform)]
        order = {5: [0, 1, 3, 2], 6: [0, 1, 2, 3]}[mode]
        state = self.materials.save(part)
        out = []
        for polygon in part.polygons:
            self.materials.restore(state)
            out.append(self.primitive(part, [polygon[i] for i in order], mode, transform))
        return out

    @staticmethod
    def separate_corners(part):
        """Gives every polygon separate points."""
        numbers = [i for p in part.polygons for i in p]
        part.points = part.points[numbers]
        part.place = part.place[numbers] if part.place is not None else None
        at = iter(range(len(numbers)))
        part.polygons = [[next(at) for _ in p] for p in part.polygons]

    def add_part(self, part):
        """Adds a mesh of the part below one or two nodes. Returns the index of the upper node."""
        odd = self.odd
        outer, outer_matrix = matrix_of(odd)
        inner, inner_matrix = matrix_of(odd) if odd.beyond(0.3) else (None, numpy.eye(4))
        if part.kind == "columns" and odd.maybe(0.15) and inner is None:
            return self.add_instances(part, outer, outer_matrix)
        if inner is None and odd.beyond(0.15):
            back = numpy.linalg.inv(outer_matrix)
            self.quantized = Quantized(odd, in_file(part, self.up) @ back[:3, :3].T + back[:3, 3])
            inner, inner_matrix = self.quantized.node()
            self.use(QUANTIZATION, True)
        self.meshes.append({"primitives": self.primitives(part, outer_matrix @ inner_matrix)})
        self.quantized = None
        mesh = len(self.meshes) - 1
        if odd.maybe(0.2):
            self.meshes[-1]["name"] = odd.choice(["", "a/b", "名\u2028", "\u0001"])
        if inner is None:
            self.nodes.append({"mesh": mesh, **outer})
        else:
            self.nodes += [{"mesh": mesh, **inner}, {**outer, "children": [len(self.nodes)]}]
        return len(self.nodes) - 1

    def add_instances(self, part, outer, outer_matrix):
        """Adds one square, and an instance of it for each voxel of the part."""
        odd = self.odd
        axis = int(numpy.argmin(numpy.ptp(part.points, axis=0)))
        square = numpy.array([[a, b] for a, b in ((-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3))])
        local = numpy.insert(square, axis, 0, axis=1) * 0.5 @ FROM_Z_UP[self.up].T
        centres = (numpy.array(part.cells) + 0.5) * 0.5 @ FROM_Z_UP[self.up].T
        back = numpy.linalg.inv(outer_matrix)
        # The node's rotation comes last, so that instances only move in the node's axes.
        local = local @ back[:3, :3].T
        moves = centres @ back[:3, :3].T + back[:3, 3]
        attributes = {"TRANSLATION": self.buffers.plain(moves, "VEC3")}
        if odd.maybe():
            attributes["SCALE"] = self.buffers.plain(numpy.full((len(moves), 3), 2.0), "VEC3")
            local = local / 2
        if odd.maybe():
            attributes["ROTATION"] = self.buffers.plain(numpy.tile([0.0, 0, 0, 1], (len(moves), 1)), "VEC4")
        vertex = {"POSITION": self.buffers.positions(local)}
        indices = self.buffers.indices([0, 1, 2, 0, 2, 3], 4)
        self.meshes.append({"primitives": [{"attributes": vertex, "indices": indices}]})
        self.case.triangles += 2 * len(moves)
        self.case.voxels.update(voxels_of([part], (255, 255, 255)))
        self.use(INSTANCING, is_required=odd.maybe())
        self.case.outside["unsupported"] = "instances"
        self.nodes.append({"mesh": len(self.meshes) - 1, **outer,
                           "extensions": {INSTANCING: {"attributes": attributes}}})
        return len(self.nodes) - 1

    def use(self, extension, is_required=False):
        self.used.add(extension)
        if is_required:
            self.required.add(extension)

    def add_others(self, roots):
        """Adds nodes, scenes and primitives that a bake must ignore."""
        odd = self.odd
        if odd.maybe(0.15):
            self.nodes.append({"mesh": 0, "translation": [0, 3, 0]})  # in no scene, or in an unused scene
            self.document["scenes"].append({"nodes": [len(self.nodes) - 1]})
            self.document["scene"] = 0
        if odd.maybe(0.1):
            self.nodes.append({"mesh": 0, "translation": [0, 3, 0], "extensions": {HIDDEN: {"visible": False}}})
            roots.append(len(self.nodes) - 1)
            self.use(HIDDEN)
            self.case.outside["unsupported"] = "visibility"
        if odd.maybe(0.1):
            self.document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
            self.nodes.append({"camera": 0, "translation": [0, 1, 9]})
            roots.append(len(self.nodes) - 1)
        if odd.maybe(0.1):
            mode, count = odd.choice([(0, 3), (1, 1), (2, 3), (3, 2)])  # points, lines, loop, strip
            extra = self.buffers.positions(numpy.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])[:2 if mode == 1 else 3])
            self.meshes.append({"primitives": [{"attributes": {"POSITION": extra}, "mode": mode}]})
            self.nodes.append({"mesh": len(self.meshes) - 1})
            roots.append(len(self.nodes) - 1)
            self.case.skipped_points, self.case.skipped_lines = (count, 0) if mode == 0 else (0, count)
            self.case.outside["unsupported"] = "points and lines"
        if odd.maybe(0.1):
            self.use("VENDOR_unknown")
            self.warn(EXTENSIONS)
        if odd.maybe(0.1):
            self.use("KHR_lights_punctual")
            self.document["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}

    def add_all(self):
        odd = self.odd
        if self.parts is None:
            self.parts = figure(odd, ["columns", "grid", "grid", "textured"])
        low, high = bounds_of(numpy.concatenate([in_file(p, self.up) for p in self.parts]))
        self.case.outside.update(bounds=(low, high))
        roots = [self.add_part(part) for part in self.parts]
        slots = {tuple(int(v) // SLOT for v in p.cells[0]) for p in self.parts}
        if not self.is_closed and odd.beyond(0.15):
            second = add_second_node(self, roots[0], self.parts[0], slots)
            roots += [second] if second is not None else []
        self.document["scenes"] = [{"nodes": roots}]
        if odd.maybe(0.8):
            self.document["scene"] = 0
        self.add_others(roots)
        self.document.update(nodes=self.nodes, meshes=self.meshes, **self.materials.lists(), **self.buffers.lists())
        if self.used:
            self.document["extensionsUsed"] = sorted(self.used | self.required)
        if self.required:
            self.document["extensionsRequired"] = sorted(self.required)
        if odd.maybe(0.3):
            self.document["asset"].update(generator="a test", extras={"a": [None, True, {"b": 1e300}]})

    def text(self):
        odd = self.odd
        items = list(self.document.items())
        odd.shuffle(items)
        return json.dumps(dict(items), indent=odd.choice([None, None, 1, 4]), ensure_ascii=odd.maybe()).encode()

    def glb(self):
        """Returns the bytes of a GLB, possibly with a chunk of an unknown format."""
        binary = self.buffers.take_first()
        text = self.text()
        text += b" " * (-len(text) % 4)
        binary += b"\0" * (-len(binary) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
        if self.odd.maybe(0.1):
            chunks += struct.pack("<II", 4, 0x12345678) + b"abcd"
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks

    def finish(self):
        """Lists the buffers in the document. The first buffer of a GLB has no URI."""
        entries = []
        for i, data in enumerate(self.buffers.data):
            entry = {"byteLength": len(data)}
            if i > 0 or not self.is_glb:
                entry["uri"] = self.store("application/gltf-buffer", bytes(data), ".bin")
            entries.append(entry)
        self.document["buffers"] = entries
        self.case.warnings = sorted((text, count, 1) for text, count in self.warned.items())

    def write(self):
        self.add_all()
        self.finish()
        self.case.source = self.odd.file_name(".glb" if self.is_glb else ".gltf")
        (self.folder / self.case.source).write_bytes(self.glb() if self.is_glb else self.text())
        return self.case


def write_gltf(odd, folder, up):
    return GltfWriter(odd, folder, up).write()


def closed_glb(odd, parts, up):
    """Returns the bytes of a GLB without other files, its voxels and its warnings."""
    writer = GltfWriter(odd, None, up, parts, is_closed=True)
    writer.add_all()
    writer.finish()
    return writer.glb(), writer.case
