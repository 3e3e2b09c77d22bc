"""Quantized positions, meshes that several nodes share, and images that are missing."""
import numpy

from figures import SLOT
from frames import FROM_Z_UP
from odd import VOXEL

QUANTIZATION = "KHR_mesh_quantization"
KINDS = {"u1": (0, 255), "i1": (-127, 127), "u2": (0, 65535), "i2": (-32767, 32767)}


class Quantized:
    """Quantized positions: integers, with a node's transform that restores the size."""

    def __init__(self, odd, points):
        self.kind = odd.choice(["u2", "u2", "i2"])
        self.is_normalized = odd.maybe()
        low, high = KINDS[self.kind]
        self.unit = 1 / high if self.is_normalized else 1
        begin, size = points.min(0), max(numpy.ptp(points, axis=0).max(), 1e-3)
        self.scale = size / (high - low) / self.unit
        self.begin = begin - low * self.unit * self.scale

    def node(self):
        matrix = numpy.eye(4)
        matrix[:3, :3] *= self.scale
        matrix[:3, 3] = self.begin
        return {"translation": self.begin.tolist(), "scale": [self.scale] * 3}, matrix

    def accessor(self, buffers, points):
        """Adds the points, which are in the frame below the node."""
        low, high = KINDS[self.kind]
        rows = numpy.clip(numpy.round(points / self.unit), low, high)
        keys = {"normalized": True} if self.is_normalized else {}
        return buffers.accessor(rows, self.kind, "VEC3", min=rows.min(0).tolist(), max=rows.max(0).tolist(), **keys)


def add_second_node(writer, index, part, slots):
    """Shows the mesh of a node again, in a free cube of the figure. slots: the occupied cubes."""
    odd, node = writer.odd, writer.nodes[index]
    here = tuple(int(v) for v in numpy.floor(numpy.array(part.cells[0]) / SLOT))
    free = [(x, y, z) for x in range(2) for y in range(2) for z in range(2) if (x, y, z) not in slots]
    if not free or "mesh" not in node or "extensions" in node:
        return None
    there = odd.choice(free)
    slots.add(there)
    move = (numpy.array(there) - here) * SLOT
    writer.nodes.append(dict(node))
    writer.nodes.append({"translation": (move * VOXEL @ FROM_Z_UP[writer.up].T).tolist(),
                         "children": [len(writer.nodes) - 1]})
    voxels = writer.case.voxels
    for cell in part.cells:
        voxels[tuple(int(v) for v in numpy.array(cell) + move)] = voxels[tuple(cell)]
    for primitive in writer.meshes[node["mesh"]]["primitives"]:
        count = writer.buffers.accessors[primitive.get("indices", primitive["attributes"]["POSITION"])]["count"]
        writer.case.triangles += count // 3 if primitive.get("mode", 4) == 4 else count - 2
    writer.case.outside["unsupported"] = "nodes below nodes"
    return len(writer.nodes) - 1
