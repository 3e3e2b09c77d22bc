"""Reading PNG files: eight bits, RGB or RGBA, not interlaced."""
import struct
import zlib
from pathlib import Path

import numpy


def read_png(path):
    """height × width × channels, of a path or of bytes."""
    data = path if isinstance(path, bytes) else Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert (depth, interlaced) == (8, 0) and colour in (2, 6)
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    channels = 3 if colour == 2 else 4
    rows = numpy.frombuffer(zlib.decompress(packed), "u1").reshape(height, 1 + width * channels)
    image = numpy.zeros((height + 1, width + 1, channels), int)  # a row and a column of zeros before the first
    for y in range(height):
        line = rows[y, 1:].reshape(width, channels).astype(int)
        kind = rows[y, 0]
        if kind <= 2:  # whole rows at once: as they are, sums along the row, sums down the columns
            image[y + 1, 1:] = (line if kind == 0 else line.cumsum(0) if kind == 1 else line + image[y, 1:]) & 255
            continue
        for x in range(width):
            left, up, corner = image[y + 1, x], image[y, x + 1], image[y, x]
            image[y + 1, x + 1] = (line[x] + predicted(kind, left, up, corner)) & 255
    return image[1:, 1:]


def predicted(kind, left, up, corner):
    if kind == 3:
        return (left + up) // 2
    distance = numpy.abs(numpy.stack([up - corner, left - corner, left + up - 2 * corner]))
    nearest = distance.argmin(0)  # the first of equals, as Paeth has it
    return numpy.choose(nearest, [left, up, corner])
