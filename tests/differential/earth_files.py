"""Writes sources with earth-centred coordinates: tilesets, and OBJ and PLY, which do not name their system."""
import numpy

from frames import ecef_from_enu
from obj_files import ObjWriter
from odd import BLOCK, VOXEL
from ply_files import PlyWriter
from tileset_files import TilesetWriter, affine


def write_earth(odd, folder, place):
    """Writes a source. place: the scene's origin (degrees and metres), and the figure's x in blocks."""
    origin, slot = place
    earth = ecef_from_enu(*origin) @ affine(numpy.eye(3), (slot * BLOCK * VOXEL, 0, 0))
    kind = odd.choice(["tileset", "tileset", "obj", "ply"])
    # Coordinates of vertices near the equator could also be projected coordinates.
    if kind == "tileset" or abs(origin[0]) < 1:
        case = TilesetWriter(odd, folder, numpy.linalg.inv(earth), earth).write()
    else:
        case = {"obj": ObjWriter, "ply": PlyWriter}[kind](odd, folder, "z", earth).write()
    case.kind, case.place, case.slot = "earth", None, slot
    return case
