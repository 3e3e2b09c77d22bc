"""PNG files: reads images of eight bits, RGB or RGBA, not interlaced; writes RGB, and chunks."""
import struct
import zlib
from pathlib import Path

import numpy


def chunk(kind, data):
    """Returns a chunk with its length and checksum."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def write_png(path, pixels):
    """Writes height × width × 3 bytes as RGB, without row filters."""
    height, width, _ = pixels.shape
    rows = numpy.concatenate([numpy.zeros((height, 1), "u1"), pixels.reshape(height, -1)], 1).tobytes()
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 1)) +
                           chunk(b"IEND", b""))


def read_png(path):
    """Returns height × width × channels of a path or of bytes."""
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
    step = 3 if colour == 2 else 4
    rows = zlib.decompress(packed)
    stride = 1 + width * step
    above, pixels = bytes(stride - 1), bytearray()
    for at in range(0, height * stride, stride):
        above = unfiltered(rows[at], rows[at + 1:at + stride], above, step)
        pixels += above
    return numpy.frombuffer(pixels, "u1").reshape(height, width, step).astype(int)


def unfiltered(kind, line, above, step):
    """Returns a row of bytes, decoded from the stored row and from the row above.

    Filters 0 to 2 work on whole rows. Others loop over bytes as Python integers, ten times as fast as small arrays.
    """
    if kind == 0:
        return line
    if kind == 1:
        return (numpy.frombuffer(line, "u1").reshape(-1, step).cumsum(0) & 255).astype("u1").tobytes()
    if kind == 2:
        return (numpy.frombuffer(line, "u1") + numpy.frombuffer(above, "u1")).tobytes()  # modulo 256
    out, above = bytearray(step) + line, bytes(step) + above
    for i in range(step, len(out)):
        left, up = out[i - step], above[i]
        if kind == 3:
            predicted = left + up >> 1
        else:  # Paeth: the nearest to left + up - corner; the first wins a tie
            corner = above[i - step]
            to_left, to_up = abs(up - corner), abs(left - corner)
            to_corner = abs(left + up - 2 * corner)
            predicted = (left if to_left <= to_up and to_left <= to_corner else up if to_up <= to_corner else corner)
        out[i] = out[i] + predicted & 255
    return bytes(out[step:])
