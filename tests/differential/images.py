"""Images of blocks of one colour each, in the encodings that programs write."""
import struct
import sys
import zlib
from pathlib import Path

import numpy

from osgeo import gdal

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli/support"))
from png_file import chunk  # noqa: E402

gdal.UseExceptions()
ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def filtered(odd, rows, bytes_per_pixel):
    """Returns rows of bytes, each with a random filter."""
    out, above = b"", bytes(len(rows[0]))
    for row in rows:
        kind = odd.randrange(5)
        left = bytes(bytes_per_pixel) + row[:-bytes_per_pixel] if len(row) > bytes_per_pixel else bytes(len(row))
        corner = bytes(bytes_per_pixel) + above[:-bytes_per_pixel] if len(row) > bytes_per_pixel else bytes(len(row))
        guess = {0: lambda a, b, c: 0, 1: lambda a, b, c: a, 2: lambda a, b, c: b, 3: lambda a, b, c: (a + b) // 2,
                 4: paeth}[kind]
        out += bytes([kind]) + bytes((x - guess(a, b, c)) & 255 for x, a, b, c in zip(row, left, above, corner))
        above = row
    return out


def packed_rows(values, bits):
    """Returns the bytes of each row. values: rows × columns × channels."""
    if bits == 8:
        return [row.astype("u1").tobytes() for row in values]
    if bits == 16:
        return [(row.astype(">u2") * 257).tobytes() for row in values]
    out = []
    for row in values[..., 0]:
        binary = "".join(f"{v:0{bits}b}" for v in row)
        binary += "0" * (-len(binary) % 8)
        out.append(bytes(int(binary[i:i + 8], 2) for i in range(0, len(binary), 8)))
    return out


def ancillary(odd):
    """Returns chunks that affect colours in other programs, but not in gigabake."""
    chunks = [chunk(b"gAMA", struct.pack(">I", odd.choice([45455, 100000, 55000]))),
              chunk(b"cHRM", struct.pack(">8I", 31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600)),
              chunk(b"pHYs", struct.pack(">IIB", 2835, 2835, 1)), chunk(b"tEXt", b"Software\0odd"),
              chunk(b"tIME", struct.pack(">HBBBBB", 2026, 11, 25, 1, 2, 3)),
              chunk(b"iCCP", b"x\0\0" + zlib.compress(b"no profile"))]
    return b"".join(odd.sample(chunks, odd.randint(0, 3)))


def png(odd, pixels, alpha=None):
    """Returns a PNG. pixels: rows × columns × 3. alpha: rows × columns, or None."""
    height, width = pixels.shape[:2]
    colours = sorted({tuple(p) for p in pixels.reshape(-1, 3).tolist()})
    more, bits = b"", odd.choice([8, 8, 8, 16])
    is_grey = all(r == g == b for r, g, b in colours)
    if alpha is not None and is_grey and odd.maybe():
        kind, values = 4, numpy.dstack([pixels[..., :1], alpha])
    elif alpha is not None and (len(colours) > 16 or odd.maybe()):
        kind, values = 6, numpy.dstack([pixels, alpha])
    elif is_grey and alpha is None and odd.maybe():
        kind, values = 0, pixels[..., :1]
    elif len(colours) <= 16 and (alpha is not None or odd.maybe(0.3)):
        kind, bits = 3, odd.choice([b for b in (1, 2, 4, 8) if len(colours) <= 1 << b])
        number = {c: i for i, c in enumerate(colours)}
        values = numpy.array([[[number[tuple(p)]] for p in row] for row in pixels.tolist()])
        more = chunk(b"PLTE", b"".join(bytes(c) for c in colours))
        if alpha is not None:
            more += chunk(b"tRNS", bytes([int(alpha.flat[0])] * len(colours)))
    else:
        kind, values = 2, pixels
    if kind == 2 and odd.maybe(0.2):
        kind, values = 6, numpy.dstack([pixels, numpy.full((height, width), 255)])
    interlaced = odd.maybe(0.15)
    bytes_per_pixel = max(1, values.shape[2] * bits // 8)
    passes = [values[y::dy, x::dx] for x, y, dx, dy in ADAM7] if interlaced else [values]
    data = b"".join(filtered(odd, packed_rows(p, bits), bytes_per_pixel) for p in passes if p.size)
    data = zlib.compress(data, odd.choice([0, 1, 9]))
    cut = odd.randint(1, len(data)) if odd.maybe(0.3) else len(data)
    parts = [data[:cut], data[cut:]] if cut < len(data) else [data]
    head = struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, int(interlaced))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + ancillary(odd) + more +
            b"".join(chunk(b"IDAT", p) for p in parts) + chunk(b"IEND", b""))


def gdal_bytes(driver, pixels, options):
    """Returns the bytes of an image that a GDAL driver writes."""
    memory = gdal.GetDriverByName("MEM").Create("", pixels.shape[1], pixels.shape[0], pixels.shape[2])
    for c in range(pixels.shape[2]):
        memory.GetRasterBand(c + 1).WriteArray(pixels[..., c].astype("u1"))
    name = f"/vsimem/image.{driver.lower()}"
    copy = gdal.GetDriverByName(driver).CreateCopy(name, memory, options=options)
    del copy
    file = gdal.VSIFOpenL(name, "rb")
    content = gdal.VSIFReadL(1, gdal.VSIStatL(name).size, file)
    gdal.VSIFCloseL(file)
    for one in (name, name + ".aux.xml"):
        if gdal.VSIStatL(one) is not None:
            gdal.Unlink(one)
    return bytes(content)


class Image:
    """size × size blocks of one colour each; block (column, row) counts from the lower left corner.

    alpha: of all pixels, then the image is a PNG.
    """

    def __init__(self, odd, kinds=("png", "png", "jpg", "webp"), alpha=None):
        self.blocks = odd.choice([1, 2, 2, 3, 4])
        self.suffix = "png" if alpha is not None else odd.choice(kinds)
        # A JPEG blurs colours across squares of 16 pixels.
        # Alpha tests with more than two pixels per voxel are less exact (docs/accuracy.md).
        texels = 16 if self.suffix == "jpg" else odd.randint(4, 12 if alpha is None else 6)
        self.colours = dict(zip([(c, r) for c in range(self.blocks) for r in range(self.blocks)],
                                odd.colours(self.blocks ** 2)))
        if self.blocks < 3 and odd.maybe(0.2):
            levels = odd.sample((0, 60, 120, 180, 255), self.blocks ** 2)
            self.colours = {k: (v, v, v) for k, v in zip(self.colours, levels)}
        pixels = numpy.zeros((self.blocks * texels, self.blocks * texels, 3), int)
        for (column, row), colour in self.colours.items():
            top = (self.blocks - 1 - row) * texels
            pixels[top:top + texels, column * texels:(column + 1) * texels] = colour
        if self.suffix == "webp" and gdal.GetDriverByName("WEBP") is None:
            self.suffix = "png"
        if self.suffix == "png":
            self.data = png(odd, pixels, None if alpha is None else numpy.full(pixels.shape[:2], alpha))
        elif self.suffix == "jpg":
            self.data = gdal_bytes("JPEG", pixels, ["QUALITY=98"] + (["PROGRESSIVE=YES"] if odd.maybe(0.3) else []))
        else:
            self.data = gdal_bytes("WEBP", pixels, ["LOSSLESS=YES"])
        self.tolerance = 16 if self.suffix == "jpg" else 2
        self.media_type = {"png": "image/png", "jpg": "image/jpeg", "webp": "image/webp"}[self.suffix]

    def colour(self, block, clamped=False):
        """Returns the colour of a block. Blocks beyond the image repeat it, or its border if `clamped`."""
        at = [min(max(b, 0), self.blocks - 1) if clamped else b % self.blocks for b in block]
        return self.colours[tuple(at)]

    def voxels(self, part, clamped=False, alpha=255):
        return {cell: (None if block is None else self.colour(block, clamped), alpha)
                for cell, block in part.blocks.items()}
