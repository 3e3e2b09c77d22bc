"""Writes elevation rasters and orthophotos through GDAL, with the expected heights and colours of places."""
import math

import numpy

from osgeo import gdal, osr

from ascii_grids import ascii_grid
from odd import Case
from raster_images import add_mask, add_ortho

# (west, south, coordinate systems) of places on Earth; the unit of a system's axes in metres, 0: degrees.
REGIONS = {
    "Alps": (8.4, 46.9, ((32632, 1), (25832, 1), (3857, 1), (2056, 1), (4326, 0), (4258, 0))),
    "California": (-121.9, 37.4, ((26910, 1), (32610, 1), (2227, 1200 / 3937), (4269, 0), (3857, 1))),
}
UNITS = {"": 1, "m": 1, "metre": 1, "Meters": 1, "METRE": 1, "dm": 0.1, "cm": 0.01, "mm": 0.001, "km": 1000,
         "US survey foot": 1200 / 3937, "international foot": 0.3048, "us-ft": 1200 / 3937}
TYPES = {"Byte": (gdal.GDT_Byte, "u1"), "Int16": (gdal.GDT_Int16, "i2"), "UInt16": (gdal.GDT_UInt16, "u2"),
         "Int32": (gdal.GDT_Int32, "i4"), "UInt32": (gdal.GDT_UInt32, "u4"), "Float32": (gdal.GDT_Float32, "f4"),
         "Float64": (gdal.GDT_Float64, "f8"), "SignedByte": (gdal.GDT_Byte, "i1")}
VOID = (slice(5, 9), slice(5, 9))
EIGHT_BITS = ("has 8-bit heights, taken as whole metres from 0 to 255; set height_scale in a scene "
              ".json to the metres of one step (1: they are metres)")
FEET = ("its coordinates are in 'US survey foot' and it does not say in which unit its heights are: taken as metres; "
        "set height_scale in a scene .json (1, or a foot: 0.3048)")
BANDS = "has 2 bands; heights are read from the first band (without a name), the others are not used"


def system(epsg):
    out = osr.SpatialReference()
    out.ImportFromEPSG(epsg)
    out.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return out


def text_of_system(odd, epsg):
    crs = system(epsg)
    return odd.choice([f"EPSG:{epsg}", crs.ExportToWkt(), crs.ExportToWkt(["FORMAT=WKT2_2019"]), f"epsg:{epsg}"])


class RasterWriter:
    def __init__(self, odd, folder, region):
        self.odd, self.folder = odd, folder
        self.case = Case("raster", "", triangles=None)
        self.entry, self.places = {}, []
        west, south, systems = REGIONS[region[0]]
        self.epsg, self.unit_of_axes = odd.choice(systems)
        to_file = osr.CoordinateTransformation(system(4326), system(self.epsg))
        self.to_earth = osr.CoordinateTransformation(system(self.epsg), system(4326))
        column, row = region[1] % 8, region[1] // 8
        self.left, self.top, _ = to_file.TransformPoint(west + 0.004 * column, south + 0.003 * row)
        self.warned = []
        # Tiles of 16 pixels allow several tiles per raster.
        self.size = odd.choice([14, 14, 14, 37])
        if odd.maybe(0.3):
            self.entry["tile_cells"] = 16

    def choose_grid(self):
        """Chooses the positions of pixels: north or south up, rotated, in degrees, metres or feet."""
        odd = self.odd
        pixel = odd.uniform(1.5, 2.5)
        if self.unit_of_axes == 0:
            width, height = pixel / 75000, pixel / 111000
        else:
            width = height = pixel / self.unit_of_axes
        angle = odd.choice([0, 0, 0, 0, math.pi / 2, 0.3]) if self.kind == "tif" and self.unit_of_axes else 0
        flip = -1 if angle or self.kind in ("asc", "vrt") or odd.maybe(0.9) else 1
        if self.kind == "asc":
            height = width
        cos, sin = math.cos(angle), math.sin(angle)
        self.grid = [self.left, cos * width, sin * height, self.top, sin * width, flip * cos * height]

    def place(self, column, row):
        """Returns the coordinates of a point. The centre of pixel (0, 0) is at 0.5, 0.5."""
        g = self.grid
        return g[0] + g[1] * column + g[2] * row, g[3] + g[4] * column + g[5] * row

    def lon_lat(self, column, row):
        lon, lat, _ = self.to_earth.TransformPoint(*self.place(column, row))
        return lon, lat

    def choose_values(self):
        """Chooses numbers of the file, and the heights that they represent."""
        odd = self.odd
        self.type = odd.choice(["Float32"] * 4 + ["Int16", "Int16", "UInt16", "Int32", "UInt32", "Float64", "Byte",
                                                  "SignedByte"])
        if self.kind == "asc":
            self.type = odd.choice(["Float32", "Int32"])
        if self.kind == "vrt" and self.type == "SignedByte":
            self.type = "Int16"  # in a VRT, GDAL before 3.7 omits that bytes are signed
        self.unit = odd.choice(list(UNITS) + [""] * 8) if self.kind != "asc" else ""
        has_scale = self.kind != "asc" and odd.maybe(0.3)
        small = self.type in ("Byte", "SignedByte")
        self.scale = odd.choice([0.1, 0.01, 0.5, 2]) if has_scale else 1
        self.offset = odd.choice([0, 100, -50, 1000.5]) if has_scale else 0
        if small:
            self.scale, self.offset, self.unit = (1, 0, "") if odd.maybe() else (0.5, 500, "m")
        if self.type in ("Int16", "UInt16") and UNITS[self.unit] < 0.1:
            self.unit = ""
        if self.unit == "km" and (has_scale or "Float" not in self.type):
            self.unit = "m"
        metres = UNITS[self.unit]
        if odd.maybe(0.15) and not small:
            self.entry["height_scale"] = metres = odd.choice([1, 0.3048, 0.1, 2])
        self.geoid = odd.choice([None, None, None, 0, 47.25, -30])
        if self.geoid is not None:
            self.entry["geoid_offset_m"] = self.geoid
        rows, columns = numpy.mgrid[0:self.size, 0:self.size]
        low = odd.uniform(100, 2000)
        if has_scale:
            low = (low * self.scale + self.offset) * metres
        low = 20 if small else low
        wanted = low + odd.uniform(-0.2, 0.2) * columns + odd.uniform(-0.2, 0.2) * rows
        raw = (wanted / metres - self.offset) / self.scale if not small else wanted
        if "Float" not in self.type:
            raw = numpy.round(raw)
        if self.type in ("Int16", "SignedByte", "UInt16", "Byte", "UInt32"):
            limits = numpy.iinfo(TYPES[self.type][1])
            raw = numpy.clip(raw, max(limits.min, 1 if limits.min == 0 else limits.min), limits.max - 3)
        self.raw = raw.astype(TYPES[self.type][1])
        if "Float" not in self.type:
            self.case.tolerance += 0.6 * abs(metres * self.scale)
        self.height = (self.raw.astype(float) * self.scale + self.offset) * metres + (self.geoid or 0)
        self.case.notes.append(f"{self.kind}, {self.type}, unit {self.unit!r}, scale {self.scale}, offset "
                               f"{self.offset}, EPSG:{self.epsg}, {self.entry}")

    def choose_void(self):
        """Chooses the way in which the file marks pixels without a value."""
        odd = self.odd
        kinds = ["none", "none", "tag", "tag", "scene", "mask", "outer mask", "alpha"]
        if self.kind == "tif" and self.type in ("Float32", "Float64", "Int16", "Int32"):
            kinds.append("undeclared")
        if "Float" in self.type:
            kinds += ["nan", "rounded"]
        if self.kind == "asc":
            kinds = ["none", "tag"]
        self.void = odd.choice(kinds)
        if self.void == "none":
            return
        limits = {"u1": 255, "i1": -128, "i2": -32768, "u2": 65535, "i4": -2147483648, "u4": 4294967295}
        name = TYPES[self.type][1]
        value = odd.choice([-9999, 0, -3.4028234663852886e38]) if name[0] == "f" else odd.choice([limits[name], 0])
        self.nodata = value
        if self.void in ("mask", "outer mask", "alpha"):
            value = 0
        if self.void == "nan":
            value = math.nan
        if self.void == "rounded":
            value, self.nodata = -3.4028234663852886e38, -3.40282e38
        if self.void == "undeclared":
            value = -9999 if "Int" in self.type else odd.choice([-9999, 1e20])
            if value == -9999 and (self.scale, self.offset) != (1, 0):
                self.void = "none"
                return
            self.entry["nodata"] = odd.choice([value, [value], [value, -5555]])
        if self.void == "scene":
            self.entry["nodata"] = value
        with numpy.errstate(over="ignore"):
            self.raw[VOID] = value
        self.height[VOID] = math.nan
        self.case.notes.append(f"void: {self.void} {value}")

    def options(self):
        odd = self.odd
        out = []
        if odd.maybe():
            out += ["TILED=YES", f"BLOCKXSIZE={odd.choice([16, 32])}", f"BLOCKYSIZE={odd.choice([16, 48])}"]
        elif odd.maybe():
            out.append(f"BLOCKYSIZE={odd.randint(1, self.size)}")
        is_big_endian = odd.maybe(0.2)
        compression = odd.choice(["NONE", "LZW", "DEFLATE", "PACKBITS", "ZSTD"])
        out.append("COMPRESS=" + compression)
        if compression in ("LZW", "DEFLATE", "ZSTD"):
            can_be_3 = "Float" in self.type and not is_big_endian
            out.append("PREDICTOR=" + odd.choice(["1", "2"] + ["3"] * can_be_3))
        out += odd.sample(["BIGTIFF=YES", "INTERLEAVE=BAND", "GEOTIFF_VERSION=1.1"], odd.randint(0, 3))
        if is_big_endian:
            out.append("ENDIANNESS=BIG")  # libtiff writes it incorrectly with the predictor of floats
        if odd.maybe(0.15) and self.type != "SignedByte" and self.kind == "tif" and not self.is_point:
            out += ["PROFILE=BASELINE", "TFW=YES"]  # other metadata goes into .aux.xml
        if self.type == "SignedByte":
            out.append("PIXELTYPE=SIGNEDBYTE")
        return out

    def create(self, path, values, grid, options):
        """Writes a GeoTIFF with the choices of this file. Returns the open file."""
        odd = self.odd
        bands = 2 if self.void == "alpha" or self.has_more else 1
        raster = gdal.GetDriverByName("GTiff").Create(str(path), values.shape[1], values.shape[0], bands,
                                                      TYPES[self.type][0], options)
        if self.is_point:
            raster.SetMetadataItem("AREA_OR_POINT", "Point")
        raster.SetGeoTransform(grid)
        if not self.crs_in_scene:
            raster.SetProjection(system(self.epsg).ExportToWkt())
        band = raster.GetRasterBand(1)
        band.WriteArray(values.view("u1") if self.type == "SignedByte" else values)
        if self.void in ("tag", "rounded") or (self.void == "nan" and odd.maybe()):
            band.SetNoDataValue(math.nan if self.void == "nan" else float(self.nodata))
        if (self.scale, self.offset) != (1, 0):
            band.SetScale(self.scale)
            band.SetOffset(self.offset)
        if self.unit:
            band.SetUnitType(self.unit)
        return raster

    def write_tiff(self, path, values, grid):
        odd = self.odd
        raster = self.create(path, values, grid, self.options())
        valid = ~numpy.isnan(self.height)
        if self.void == "alpha":
            raster.GetRasterBand(2).WriteArray(valid.astype("u1") * 255)
            raster.GetRasterBand(2).SetColorInterpretation(gdal.GCI_AlphaBand)
        if odd.maybe(0.1):
            raster.BuildOverviews("NEAREST", [2])
        raster = None
        if self.void in ("mask", "outer mask"):
            add_mask(path, valid, self.void == "mask")

    def write_ascii(self, path):
        if self.odd.maybe(0.6):
            nodata = float(self.nodata) if self.void == "tag" else None
            text = ascii_grid(self.odd, self.raw, self.grid[0], self.grid[3], self.grid[1], nodata)
            path.write_bytes(text.encode())
            if not self.crs_in_scene:
                crs = system(self.epsg)
                crs.MorphToESRI()
                path.with_suffix(".prj").write_text(crs.ExportToWkt())
            return
        memory = gdal.GetDriverByName("MEM").Create("", self.size, self.size, 1, TYPES[self.type][0])
        memory.SetGeoTransform(self.grid)
        if not self.crs_in_scene:
            memory.SetProjection(system(self.epsg).ExportToWkt())
        memory.GetRasterBand(1).WriteArray(self.raw)
        if self.void == "tag":
            memory.GetRasterBand(1).SetNoDataValue(float(self.nodata))
        copy = gdal.GetDriverByName("AAIGrid").CreateCopy(str(path), memory)
        del copy

    def write_tiles(self):
        """Writes two adjacent rasters that share no column, as a folder or a VRT. Returns the name of the source."""
        odd = self.odd
        folder = self.folder / "tiles"
        folder.mkdir()
        cut = odd.randint(3, self.size - 3)
        names = []
        for name, part in (("w.tif", slice(0, cut)), ("e.tif", slice(cut, self.size))):
            values = numpy.ascontiguousarray(self.raw[:, part])
            grid = list(self.grid)
            grid[0], grid[3] = self.place(part.start, 0)
            raster = self.create(folder / name, values, grid, self.options())
            raster = None
            names.append(str(folder / name))
        if self.kind == "folder":
            return "tiles"
        vrt = gdal.BuildVRT(str(self.folder / "mosaic.vrt"), names)
        del vrt
        return "mosaic.vrt"

    def write(self):
        odd, case = self.odd, self.case
        self.kind = odd.choice(["tif"] * 6 + ["asc", "folder", "vrt"])
        self.choose_grid()
        self.choose_values()
        self.choose_void()
        self.crs_in_scene = odd.maybe(0.2)
        self.is_point = odd.maybe(0.15) and self.kind == "tif"
        self.has_more = odd.maybe(0.07) and self.kind == "tif" and self.void not in ("alpha", "mask", "outer mask")
        if self.kind in ("folder", "vrt"):
            if self.void not in ("none", "tag", "scene"):
                self.undo_void()
            self.crs_in_scene = self.crs_in_scene and self.kind == "folder"
            name = self.write_tiles()
        else:
            name = odd.file_name(".asc" if self.kind == "asc" else odd.choice([".tif", ".tif", ".TIF", ".tiff"]))
            if self.kind == "asc":
                self.write_ascii(self.folder / name)
            else:
                self.write_tiff(self.folder / name, self.raw, self.grid)
        if self.crs_in_scene:
            self.entry["crs"] = text_of_system(odd, self.epsg)
        case.source = name
        self.expect_warnings()
        self.add_places()
        if odd.maybe(0.5):
            add_ortho(self)
        case.entry, case.places = self.entry, self.places
        case.warnings = sorted(set(self.warned))
        return case

    def undo_void(self):
        """Fills the holes again: other tests have masks of tiles and of mosaics."""
        values = self.raw[:, [4]]
        self.raw[VOID], self.height[VOID] = values[VOID[0]], self.height[:, [4]][VOID[0]]
        self.void = "none"

    def expect_warnings(self):
        files = 2 if self.kind == "folder" else 1
        if self.type == "Byte" and self.scale == 1 and "height_scale" not in self.entry:
            self.warned.append((EIGHT_BITS, files, files))
        if self.unit_of_axes not in (0, 1) and self.unit == "" and "height_scale" not in self.entry:
            self.warned.append((FEET, files, files))
        if self.has_more:
            self.warned.append((BANDS, files, files))

    def add_places(self):
        """Adds the centres of inner pixels, and the middle of the hole."""
        # AREA_OR_POINT=Point causes no shift: GDAL writes and reads the same geotransform.
        end = self.size - 3
        pixels = ((2, 2), (2, end), (end, 2), (end, end), (6, 2), (7, 11))
        if self.kind != "folder":
            self.case.outside = {
                "corners": [self.place(0, 0), self.place(self.size, self.size)],
                "values": [(*self.place(c + 0.5, r + 0.5), float(self.raw[r, c])) for c, r in pixels]}
        for column, row in pixels:
            self.places.append((*self.lon_lat(column + 0.5, row + 0.5), self.height[row, column], None))
        if self.void != "none":
            self.places.append((*self.lon_lat(7, 7), None, None))


def write_raster(odd, folder, region):
    return RasterWriter(odd, folder, region).write()
