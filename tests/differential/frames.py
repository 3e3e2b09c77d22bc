"""Axes and origins of the frames in which files state their coordinates."""
import numpy

from odd import VOXEL

# Rotations from a z-up point to the file's axes: rows of a matrix.
FROM_Z_UP = {
    "z": numpy.eye(3),
    "y": numpy.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float),
    "x": numpy.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], float),
}
# Typical origins of surveying data: UTM, Swiss, Gauss-Krüger, a local system.
PLACES = ((500000, 5200000, 400), (2600000, 1200000, 500), (4500000, 5400000, 100), (-12000, 9000, 0), (0, 0, 0))


def in_file(part, up, place=(0, 0, 0), earth=None):
    """Returns the points of a part in metres, in a file's axes. earth: the matrix to earth-centred axes, or None."""
    if earth is not None:
        return part.points * VOXEL @ earth[:3, :3].T + earth[:3, 3]
    return (part.points * VOXEL + numpy.array(place)) @ FROM_Z_UP[up].T


def ecef_from_enu(latitude, longitude, height):
    """Returns the matrix from east, north and up at a place to earth-centred axes. Degrees and metres, WGS84."""
    lat, lon = numpy.radians([latitude, longitude])
    a, e2 = 6378137.0, 0.0066943799901413165
    n = a / numpy.sqrt(1 - e2 * numpy.sin(lat) ** 2)
    out = numpy.eye(4)
    out[:3, 0] = [-numpy.sin(lon), numpy.cos(lon), 0]
    out[:3, 1] = [-numpy.sin(lat) * numpy.cos(lon), -numpy.sin(lat) * numpy.sin(lon), numpy.cos(lat)]
    out[:3, 2] = [numpy.cos(lat) * numpy.cos(lon), numpy.cos(lat) * numpy.sin(lon), numpy.sin(lat)]
    out[:3, 3] = [(n + height) * numpy.cos(lat) * numpy.cos(lon), (n + height) * numpy.cos(lat) * numpy.sin(lon),
                  (n * (1 - e2) + height) * numpy.sin(lat)]
    return out


def linear(code):
    """Returns the linear value of an sRGB code."""
    v = code / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def bounds_of(points):
    return numpy.min(points, 0).tolist(), numpy.max(points, 0).tolist()
