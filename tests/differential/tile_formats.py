"""The tiles of 3D Tiles 1.0: b3dm, i3dm and cmpt, and archives of tilesets."""
import json
import struct
import zipfile

import numpy


def padded(text, start):
    text += b" " * (-(start + len(text)) % 8)
    return text


def b3dm(odd, glb, center):
    """Returns a b3dm. center: RTC_CENTER, or None."""
    table = {"BATCH_LENGTH": odd.choice([0, 0, 3])}
    if center is not None:
        table["RTC_CENTER"] = list(center)
    feature = padded(json.dumps(table).encode(), 28)
    batch = padded(json.dumps({"id": [1, 2, 3], "name": ["a", "é", ""]}).encode(), 0) if odd.maybe(0.3) else b""
    size = 28 + len(feature) + len(batch) + len(glb)
    return b"b3dm" + struct.pack("<6I", 1, size, len(feature), 0, len(batch), 0) + feature + batch + glb


def octahedral(normals):
    """Encodes unit vectors as two numbers from 0 to 65535."""
    n = normals / numpy.abs(normals).sum(1, keepdims=True)
    folded = (1 - numpy.abs(n[:, [1, 0]])) * numpy.where(n[:, :2] >= 0, 1, -1)
    xy = numpy.where(n[:, 2:] < 0, folded, n[:, :2])
    return numpy.round((xy + 1) / 2 * 65535).astype("<u2")


class InstanceTable:
    """The feature table of an i3dm."""

    def __init__(self, odd, positions, center):
        self.odd, self.count = odd, len(positions)
        self.table, self.binary = {"INSTANCES_LENGTH": self.count}, b""
        local = positions - center if center is not None else positions
        if center is not None:
            self.table["RTC_CENTER"] = list(center)
        if odd.maybe(0.3):
            low, size = local.min(0) - 1, numpy.ptp(local, axis=0) + 2
            self.add("POSITION_QUANTIZED", numpy.round((local - low) / size * 65535).astype("<u2"))
            self.table.update(QUANTIZED_VOLUME_OFFSET=low.tolist(), QUANTIZED_VOLUME_SCALE=size.tolist())
        else:
            self.add("POSITION", local.astype("<f4"))

    def add(self, name, rows):
        self.binary += bytes(-len(self.binary) % 4)
        self.table[name] = {"byteOffset": len(self.binary)}
        self.binary += rows.tobytes()

    def add_axes(self, right, up):
        """Rotates the instances: the model's x to `right`, its y to `up`."""
        right, up = (numpy.tile(v, (self.count, 1)) for v in (right, up))
        if self.odd.maybe(0.4):
            self.add("NORMAL_UP_OCT32P", octahedral(up))
            self.add("NORMAL_RIGHT_OCT32P", octahedral(right))
        else:
            self.add("NORMAL_UP", up.astype("<f4"))
            self.add("NORMAL_RIGHT", right.astype("<f4"))

    def add_scale(self, scale):
        if self.odd.maybe():
            self.add("SCALE", numpy.full(self.count, scale, "<f4"))
        else:
            self.add("SCALE_NON_UNIFORM", numpy.full((self.count, 3), scale, "<f4"))

    def tile(self, model, is_uri):
        """Returns the bytes of the i3dm. model: a GLB, or its URI."""
        model = model + b" " * (-len(model) % 8) if is_uri else model
        binary = self.binary + bytes(-len(self.binary) % 8)
        feature = padded(json.dumps(self.table).encode(), 32)
        size = 32 + len(feature) + len(binary) + len(model)
        head = struct.pack("<7I", 1, size, len(feature), len(binary), 0, 0, 0 if is_uri else 1)
        return b"i3dm" + head + feature + binary + model


def cmpt(tiles):
    size = 16 + sum(map(len, tiles))
    return b"cmpt" + struct.pack("<3I", 1, size, len(tiles)) + b"".join(tiles)


def archive(odd, folder, path):
    """Moves all files of a folder into a .3tz."""
    files = sorted(p for p in folder.rglob("*") if p.is_file())
    kind = odd.choice([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED])
    with zipfile.ZipFile(path, "w", kind) as out:
        for file in files:
            out.write(file, file.relative_to(folder).as_posix())
            file.unlink()
