"""Reading OpenEXR files as gigabake writes them: one part of lines, ZIP, channels of halves and floats."""
import struct
import zlib
from pathlib import Path

import numpy

LINES_A_CHUNK = 16
SAMPLE = {1: numpy.dtype("<f2"), 2: numpy.dtype("<f4")}


def read_exr(path):
    """Returns arrays of height × width by the names of their channels."""
    data = Path(path).read_bytes()
    assert struct.unpack_from("<II", data) == (20000630, 2)
    attributes, at = attributes_of(data)
    assert attributes["compression"] == b"\3"
    channels = channels_of(attributes["channels"])
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    assert (left, top) == (0, 0)
    width, height = right + 1, bottom + 1
    image = {name: numpy.zeros((height, width), dtype) for name, dtype in channels}
    for (offset,) in struct.iter_unpack("<Q", data[at:at + 8 * -(-height // LINES_A_CHUNK)]):
        first, size = struct.unpack_from("<iI", data, offset)
        lines = min(LINES_A_CHUNK, height - first)
        raw = unpacked(data[offset + 8:offset + 8 + size], lines * width * sum(d.itemsize for _, d in channels))
        for y in range(first, first + lines):
            for name, dtype in channels:
                image[name][y] = numpy.frombuffer(raw[:width * dtype.itemsize], dtype)
                raw = raw[width * dtype.itemsize:]
    return image


def attributes_of(data):
    """Returns the attributes by name, and the offset of the byte after them."""
    found, at = {}, 8
    while data[at]:
        name, kind = data[at:].split(b"\0", 2)[:2]
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<I", data, at)
        found[name.decode()] = data[at + 4:at + 4 + size]
        at += 4 + size
    return found, at + 1


def channels_of(listed):
    channels = []
    while listed[0]:
        name, rest = listed.split(b"\0", 1)
        channels.append((name.decode(), SAMPLE[struct.unpack_from("<I", rest)[0]]))
        listed = rest[16:]
    return channels


def unpacked(packed, size):
    """Undoes the prediction of bytes and their split into even and odd ones."""
    if len(packed) == size:
        return packed
    values = numpy.frombuffer(zlib.decompress(packed), "u1").astype(int)
    values[1:] -= 128
    values = (values.cumsum() & 255).astype("u1")
    raw = numpy.zeros(size, "u1")
    raw[::2], raw[1::2] = values[:(size + 1) // 2], values[(size + 1) // 2:]
    return raw.tobytes()
