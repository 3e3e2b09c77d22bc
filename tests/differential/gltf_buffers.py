"""Accessors, buffer views and buffers of a glTF document, laid out in different ways."""
import numpy

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


class Buffers:
    def __init__(self, odd):
        self.odd = odd
        self.data = [bytearray(4) for _ in range(odd.choice([1, 1, 1, 2]))]
        self.views, self.accessors = [], []

    def view(self, content, **keys):
        """Appends bytes to a buffer, aligned by four. Returns the index of the view."""
        at = self.odd.randrange(len(self.data))
        buffer = self.data[at]
        buffer += bytes(-len(buffer) % 4) + bytes(4 * self.odd.choice([0, 0, 0, 1, 5]))
        self.views.append({"buffer": at, "byteOffset": len(buffer), "byteLength": len(content), **keys})
        buffer += content
        return len(self.views) - 1

    def accessor(self, values, kind, shape, **keys):
        """Adds an accessor. values: rows × components. `kind`: the numpy format of a component."""
        odd = self.odd
        values = numpy.asarray(values).reshape(len(values), -1)
        rows = values.astype("<" + kind)
        width = rows.dtype.itemsize * rows.shape[1]
        # Rows of vertex attributes begin at multiples of four bytes.
        gap = -width % 4 + (4 * odd.choice([0, 1, 3]) if odd.maybe(0.2) else 0)
        before = 4 * odd.choice([0, 2]) if gap else 0
        entry = {"componentType": COMPONENTS[kind], "count": len(rows), "type": shape, **keys}
        if before:
            entry["byteOffset"] = before
        if gap:
            content = b"".join(row.tobytes() + b"\xcd" * gap for row in rows)
            entry["bufferView"] = self.view(bytes(before) + content, byteStride=width + gap)
        else:
            entry["bufferView"] = self.view(rows.tobytes())
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def plain(self, values, shape):
        return self.accessor(values, "f4", shape)

    def sparse(self, values):
        """Adds positions as a sparse accessor: some or all positions replace others."""
        odd = self.odd
        rows = numpy.asarray(values, "<f4")
        chosen = sorted(odd.sample(range(len(rows)), odd.randint(1, len(rows))))
        entry = {"componentType": 5126, "count": len(rows), "type": "VEC3"}
        if len(chosen) < len(rows) or odd.maybe():
            base = rows.copy()
            base[chosen] = 77
            entry["bufferView"] = self.view(base.tobytes())
        kind = odd.choice(["u1", "u2", "u4"])
        entry["sparse"] = {
            "count": len(chosen),
            "indices": {"bufferView": self.view(numpy.array(chosen, "<" + kind).tobytes()),
                        "componentType": COMPONENTS[kind]},
            "values": {"bufferView": self.view(rows[chosen].tobytes())}}
        self.accessors.append({**entry, "min": rows.min(0).tolist(), "max": rows.max(0).tolist()})
        return len(self.accessors) - 1

    def positions(self, points):
        rows = numpy.asarray(points, "<f4")
        if self.odd.maybe(0.15):
            return self.sparse(rows)
        return self.accessor(rows, "f4", "VEC3", min=rows.min(0).tolist(), max=rows.max(0).tolist())

    def indices(self, numbers, vertices):
        kinds = [k for k, maximum in (("u1", 255), ("u2", 65535), ("u4", 1 << 32)) if vertices <= maximum]
        kind = self.odd.choice(kinds)
        entry = {"bufferView": self.view(numpy.array(numbers, "<" + kind).tobytes()), "componentType": COMPONENTS[kind],
                 "count": len(numbers), "type": "SCALAR"}
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def take_first(self):
        return bytes(self.data[0])

    def lists(self):
        return {"bufferViews": self.views, "accessors": self.accessors}
