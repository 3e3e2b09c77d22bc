"""GDAL's readers of rasters and vectors, rasters for tests, and coordinate systems. Tests that import this module are
skipped without GDAL."""
import sys

import numpy

try:
    from osgeo import gdal, ogr, osr
except ImportError:
    print("skipped: expected python3-gdal to be installed")
    sys.exit(77)

gdal.UseExceptions()
ogr.UseExceptions()
osr.UseExceptions()


def coordinate_system(text):
    """Returns the system of a code, WKT or PROJ text. Its first axis is the easting or the longitude."""
    system = osr.SpatialReference()
    system.SetFromUserInput(text)
    system.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return system


def write_raster(path, values, left, top, pixel, epsg=32611, nodata=None, kind=gdal.GDT_Float32):
    """Writes rows × columns, or bands × rows × columns; the first row is the northernmost."""
    values = numpy.asarray(values)
    bands = values if values.ndim == 3 else values[None]
    options = ["TILED=YES", "BLOCKXSIZE=64", "BLOCKYSIZE=64"]
    raster = gdal.GetDriverByName("GTiff").Create(str(path), bands.shape[2], bands.shape[1], len(bands), kind, options)
    raster.SetGeoTransform([left, pixel, 0, top, 0, -pixel])
    if epsg is not None:
        crs = osr.SpatialReference()
        crs.ImportFromEPSG(epsg)
        raster.SetProjection(crs.ExportToWkt())
    for i, band in enumerate(bands, 1):
        raster.GetRasterBand(i).WriteArray(band)
        if nodata is not None:
            raster.GetRasterBand(i).SetNoDataValue(nodata)
    raster.FlushCache()
