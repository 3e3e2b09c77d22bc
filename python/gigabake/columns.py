"""Reader of the columns of a shard: HDF5 datasets in chunks of deflate or LZ4 (docs/format.md, "Chunks").

HDF5 itself unpacks deflate. It has no LZ4 without a plugin, so chunks of filter 32004 are read as stored and unpacked
here, after their Fletcher-32 was compared.
"""
from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import h5py
import numpy
from numpy.typing import NDArray

from .errors import BAKE_AGAIN, DAMAGES, GigabakeError, damage_of

Array = NDArray[Any]

LZ4_FILTER = 32004
MAX_BLOCK_BYTES = 1 << 31


def fletcher32(data: bytes) -> int:
    """Returns HDF5's Fletcher-32: sums of big-endian 16-bit words modulo 65535, where 65535 is not reduced to 0."""
    words = numpy.frombuffer(data + b"\0" * (len(data) % 2), ">u2").astype(numpy.uint64)
    each = running = 0
    for start in range(0, len(words), 1 << 20):
        part = words[start:start + (1 << 20)]
        running += each * len(part) + int((part * numpy.arange(len(part), 0, -1, dtype=numpy.uint64)).sum())
        each += int(part.sum())

    def folded(total: int) -> int:
        return total % 65535 or (65535 if total else 0)
    return folded(running) << 16 | folded(each)


def unpacked_frame(frame: bytes, chunk_bytes: int) -> bytes:
    """Unpacks the LZ4 frame of HDF5's filter 32004.

    Raises ValueError if the frame is damaged, and ImportError if the package lz4 is missing.
    """
    size, block = struct.unpack_from(">QI", frame) if len(frame) >= 12 else (0, 0)
    if size != chunk_bytes or not 0 < block <= MAX_BLOCK_BYTES:
        raise ValueError("the LZ4 frame has another size than the chunk")
    parts, at, left = [], 12, chunk_bytes
    while left > 0:
        expected = min(block, left)
        stored = struct.unpack_from(">I", frame, at)[0] if len(frame) >= at + 4 else MAX_BLOCK_BYTES
        data = frame[at + 4:at + 4 + stored]
        if len(data) != stored:
            raise ValueError("the LZ4 frame ends early")
        parts.append(data if stored == expected else unpacked_block(data, expected))
        at, left = at + 4 + stored, left - expected
    if at != len(frame):
        raise ValueError("the LZ4 frame has bytes behind its last block")
    return b"".join(parts)


def unpacked_block(data: bytes, size: int) -> bytes:
    """Unpacks one LZ4 block of a known size."""
    import lz4.block  # imported on demand: scenes of --codec deflate, the default, do not need it
    try:
        block = bytes(lz4.block.decompress(data, uncompressed_size=size))
    except lz4.block.LZ4BlockError as error:
        raise ValueError(str(error)) from error
    if len(block) != size:
        raise ValueError(f"an LZ4 block has {len(block)} bytes, expected {size}")
    return block


class Column:
    """A dataset with one row per node, brick or value. Rows are read in ranges."""

    def __init__(self, file: Path, dataset: h5py.Dataset) -> None:
        self.file = file
        self.key = str(dataset.name)
        self._dataset = dataset
        with damage_of(file, self.key):
            properties = dataset.id.get_create_plist()
            self._filters = [properties.get_filter(i)[0] for i in range(properties.get_nfilters())]
            self._chunk_rows = int(dataset.chunks[0]) if dataset.chunks else 0
            self._row_shape = tuple(map(int, dataset.shape[1:]))
            self._rows = int(dataset.shape[0])
        if dataset.chunks and dataset.chunks[1:] != self._row_shape:
            raise self.fail("has chunks that are narrower than its rows")
        self._unpacked: tuple[int, Array] | None = None

    def __len__(self) -> int:
        return self._rows

    @property
    def width(self) -> int:
        """The number of elements per row."""
        return int(numpy.prod(self._row_shape, dtype=int))

    @property
    def dtype(self) -> numpy.dtype[Any]:
        """The type of an element."""
        return numpy.dtype(self._dataset.dtype)

    def fail(self, cause: str, remedy: str = BAKE_AGAIN) -> GigabakeError:
        """Returns the error of this column."""
        return GigabakeError(self.file, self.key, cause, remedy)

    def rows(self, begin: int = 0, end: int | None = None) -> Array:
        """Returns the rows from `begin` to `end`, by default all of them."""
        end = len(self) if end is None else end
        if not 0 <= begin <= end <= len(self):
            raise self.fail(f"has {len(self)} rows, but rows {begin} to {end} are referred to")
        if begin == end or LZ4_FILTER not in self._filters:
            return self._rows_of_hdf5(begin, end)
        first, last = begin // self._chunk_rows, (end - 1) // self._chunk_rows
        parts = [self._chunk(number) for number in range(first, last + 1)]
        offset = first * self._chunk_rows
        return numpy.concatenate(parts)[begin - offset:end - offset]

    def _rows_of_hdf5(self, begin: int, end: int) -> Array:
        with damage_of(self.file, self.key):
            return numpy.asarray(self._dataset[begin:end])

    def _chunk(self, number: int) -> Array:
        """Returns the rows of one LZ4 chunk. The last one is kept, since ranges often begin where one ended."""
        if self._unpacked is None or self._unpacked[0] != number:
            self._unpacked = number, self._read_chunk(number)
        return self._unpacked[1]

    def _read_chunk(self, number: int) -> Array:
        row_shape = self._row_shape
        count = self._chunk_rows * self.width
        try:
            mask, stored = self._dataset.id.read_direct_chunk((number * self._chunk_rows,) + (0,) * len(row_shape))
            data = self._unfiltered(bytes(stored), mask, count * self.dtype.itemsize)
        except ImportError as error:
            raise self.fail("is compressed with LZ4, and the Python package lz4 is missing",
                            "pip install lz4, or apt install python3-lz4") from error
        except DAMAGES as error:
            raise self.fail(f"chunk {number} cannot be read: {error}") from error
        return numpy.frombuffer(data, self.dtype, count).reshape((self._chunk_rows, *row_shape, *self.dtype.shape))

    def _unfiltered(self, data: bytes, mask: int, chunk_bytes: int) -> bytes:
        """Undoes the filters of a stored chunk. Raises ValueError if the chunk is damaged."""
        if mask != 0:
            raise ValueError("a filter was skipped")
        for filter_id in reversed(self._filters):
            if filter_id == h5py.h5z.FILTER_FLETCHER32:
                data, stored_sum = data[:-4], data[-4:]
                if struct.pack("<I", fletcher32(data)) != stored_sum:
                    raise ValueError("the checksum differs")
            elif filter_id == LZ4_FILTER:
                data = unpacked_frame(data, chunk_bytes)
            elif filter_id == h5py.h5z.FILTER_SHUFFLE:
                planes = numpy.frombuffer(data, numpy.uint8).reshape(self.dtype.itemsize, -1)
                data = planes.T.tobytes()
            else:
                raise ValueError(f"HDF5 filter {filter_id} is unknown")
        return data
