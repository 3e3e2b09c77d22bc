"""Positions on the WGS84 ellipsoid, computed independently of the program."""
import math

import numpy

RADIUS_M, FLATTENING = 6378137.0, 1 / 298.257223563
ECCENTRICITY_2 = FLATTENING * (2 - FLATTENING)


def earth_centred(longitude, latitude, height_m):
    lon, lat = math.radians(longitude), math.radians(latitude)
    normal = RADIUS_M / math.sqrt(1 - ECCENTRICITY_2 * math.sin(lat) ** 2)
    across = (normal + height_m) * math.cos(lat)
    return numpy.array([across * math.cos(lon), across * math.sin(lon),
                        (normal * (1 - ECCENTRICITY_2) + height_m) * math.sin(lat)])


def geodetic(points):
    """Returns longitude, latitude and height of earth-centred points near the surface, by fixed-point iteration."""
    x, y, z = points.T
    across = numpy.hypot(x, y)
    latitude = numpy.arctan2(z, across * (1 - ECCENTRICITY_2))
    for _ in range(8):
        normal = RADIUS_M / numpy.sqrt(1 - ECCENTRICITY_2 * numpy.sin(latitude) ** 2)
        latitude = numpy.arctan2(z + ECCENTRICITY_2 * normal * numpy.sin(latitude), across)
    normal = RADIUS_M / numpy.sqrt(1 - ECCENTRICITY_2 * numpy.sin(latitude) ** 2)
    height = across * numpy.cos(latitude) + z * numpy.sin(latitude) - RADIUS_M ** 2 / normal
    return numpy.stack([numpy.degrees(numpy.arctan2(y, x)), numpy.degrees(latitude), height], -1)


def frame(longitude, latitude, height_m=0):
    """Returns the rotation from east, north, up to the earth-centred frame, and the origin."""
    lon, lat = math.radians(longitude), math.radians(latitude)
    east = [-math.sin(lon), math.cos(lon), 0]
    north = [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)]
    up = [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]
    return numpy.array([east, north, up]).T, earth_centred(longitude, latitude, height_m)


def degrees_of(points, longitude, latitude, height_m=0):
    """Returns longitude, latitude and height of points in the frame of the place."""
    rotation, origin = frame(longitude, latitude, height_m)
    return geodetic(points @ rotation.T + origin)
