"""Writes orthophotos: four squares of one colour each over a raster, with bands as in real files."""
import numpy

from osgeo import gdal, osr

EDGE = 40  # pixels
COLOURS = ("red", "green", "blue")
INTERPRETATIONS = {"red": gdal.GCI_RedBand, "green": gdal.GCI_GreenBand, "blue": gdal.GCI_BlueBand,
                   "alpha": gdal.GCI_AlphaBand, "other": gdal.GCI_Undefined, "grey": gdal.GCI_GrayIndex}
GREY = (127, 127, 127)


def add_mask(path, valid, is_internal):
    """Gives a GeoTIFF a mask, inside or as a .msk file."""
    gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES" if is_internal else "NO")
    try:
        raster = gdal.Open(str(path), gdal.GA_Update if is_internal else gdal.GA_ReadOnly)
        raster.CreateMaskBand(gdal.GMF_PER_DATASET)
        raster.GetRasterBand(1).GetMaskBand().WriteArray(valid.astype("u1") * 255)
        raster = None
    finally:
        gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", None)


def squares(colours):
    """Returns rows × columns × 3."""
    out = numpy.zeros((EDGE, EDGE, 3), int)
    half = EDGE // 2
    for (column, row), colour in colours.items():
        out[row * half:(row + 1) * half, column * half:(column + 1) * half] = colour
    return out


def bands_of(odd, kind):
    """Returns the interpretation of each band."""
    return {"rgb": ["red", "green", "blue"], "bgr": ["blue", "green", "red"],
            "infrared": ["red", "green", "blue", "other"], "infrared first": ["other", "red", "green", "blue"],
            "alpha": ["red", "green", "blue", "alpha"], "alpha first": ["alpha", "red", "green", "blue"],
            "sixteen": ["red", "green", "blue"], "grey": ["grey"], "grey alpha": ["grey", "alpha"],
            "twelve": ["red", "green", "blue"], "jpeg": ["red", "green", "blue"],
            "white is 0": ["grey"],
            "palette": ["palette"], "nodata": ["red", "green", "blue"], "mask": ["red", "green", "blue"]}[kind]


def create(odd, path, kind, names):
    type_ = gdal.GDT_UInt16 if kind in ("sixteen", "twelve") else gdal.GDT_Byte
    options = odd.sample(["TILED=YES", "INTERLEAVE=BAND", "BIGTIFF=YES"], odd.randint(0, 2))
    if kind == "jpeg":
        options = [o for o in options if "BAND" not in o] + odd.choice([["PHOTOMETRIC=YCBCR"], []])
        options += ["COMPRESS=JPEG", "JPEG_QUALITY=98"]
    else:
        options.append("COMPRESS=" + odd.choice(["NONE", "LZW", "DEFLATE"]))
    if kind == "twelve":
        options.append("NBITS=12")
    if kind == "white is 0":
        options.append("PHOTOMETRIC=MINISWHITE")
    if len(names) > 3:
        options.append("ALPHA=NO")
    if names[:3] == ["red", "green", "blue"] and kind != "jpeg" and odd.maybe():
        options.append("PHOTOMETRIC=RGB")
    return gdal.GetDriverByName("GTiff").Create(str(path), EDGE, EDGE, len(names), type_, options)


def fill(raster, kind, names, pixels, transparent):
    """Writes the bands; `transparent`: rows × columns."""
    for number, name in enumerate(names, 1):
        band = raster.GetRasterBand(number)
        if name == "palette":
            colours = sorted({tuple(p) for p in pixels.reshape(-1, 3).tolist()})
            table = gdal.ColorTable()
            for i, colour in enumerate(colours):
                table.SetColorEntry(i, (*colour, 255))
            band.SetColorTable(table)
            band.SetColorInterpretation(gdal.GCI_PaletteIndex)
            values = numpy.array([[colours.index(tuple(p)) for p in row] for row in pixels.tolist()])
        else:
            if kind not in ("jpeg", "white is 0"):
                band.SetColorInterpretation(INTERPRETATIONS[name])
            values = {"alpha": numpy.where(transparent, 0, 255), "other": numpy.full((EDGE, EDGE), 77),
                      "grey": pixels[..., 0]}.get(name)
            if values is None:
                values = pixels[..., COLOURS.index(name)]
        if kind == "white is 0":
            values = 255 - values
        scale = {"sixteen": 257, "twelve": 4095 / 255}.get(kind)
        band.WriteArray(numpy.round(values * scale).astype("u2") if scale else values.astype("u1"))


def placed(writer, raster, odd):
    """Gives the image the raster's extent plus a fifth, in the raster's system. Returns the centres of the squares."""
    size = writer.raw.shape[0]
    begin, width = -0.1 * size, 1.2 * size / EDGE
    g = writer.grid
    x, y = writer.place(begin, begin)
    raster.SetGeoTransform([x, g[1] * width, g[2] * width, y, g[4] * width, g[5] * width])
    crs = osr.SpatialReference()
    crs.ImportFromEPSG(writer.epsg)
    if odd.maybe(0.2):
        writer.entry["ortho_crs"] = f"EPSG:{writer.epsg}"
    else:
        raster.SetProjection(crs.ExportToWkt())
    quarter = size * 0.3
    return {(c, r): (size / 2 + (2 * c - 1) * quarter, size / 2 + (2 * r - 1) * quarter)
            for c in (0, 1) for r in (0, 1)}


def warped(writer, path, odd):
    """Transforms the image to another system by gdalwarp, with the nearest pixel."""
    epsg = odd.choice([4326, 3857])
    target = path.with_name("w" + path.name)
    gdal.Warp(str(target), str(path), srcSRS=f"EPSG:{writer.epsg}", dstSRS=f"EPSG:{epsg}", resampleAlg="near",
              creationOptions=["COMPRESS=LZW"])
    writer.entry.pop("ortho_crs", None)
    return target.name


def add_ortho(writer):
    """Adds an orthophoto and the colours of four places."""
    odd, case = writer.odd, writer.case
    kind = odd.choice(["rgb", "rgb", "bgr", "infrared", "infrared first", "alpha", "alpha first", "sixteen", "grey",
                       "grey alpha", "palette", "nodata", "mask", "twelve", "jpeg", "white is 0"])
    colours = dict(zip([(0, 0), (1, 0), (0, 1), (1, 1)], odd.colours(4)))
    if kind.startswith("grey") or kind == "white is 0":
        colours = {k: (v, v, v) for k, v in zip(colours, odd.sample((20, 70, 120, 170, 220, 250), 4))}
    case.colour_tolerance = 12 if kind == "jpeg" else 2
    if kind == "sixteen":
        colours[(0, 0)] = (250, 240, 251)
    names = bands_of(odd, kind)
    hidden = odd.choice(list(colours)) if kind in ("alpha", "alpha first", "grey alpha", "nodata", "mask") else None
    pixels = squares(colours)
    transparent = (squares({k: (1, 1, 1) if k == hidden else (0, 0, 0) for k in colours})[..., 0] == 1)
    if kind == "nodata":
        pixels[transparent] = 1
    path = writer.folder / odd.file_name(".tif")
    raster = create(odd, path, kind, names)
    fill(raster, kind, names, pixels, transparent)
    middles = placed(writer, raster, odd)
    if kind == "nodata":
        raster.GetRasterBand(1).SetNoDataValue(1)  # for all bands: a GeoTIFF has only one nodata value
    raster = None
    if kind == "mask":
        add_mask(path, ~transparent, odd.maybe())
    writer.entry["ortho"] = path.name
    if kind in ("rgb", "alpha") and odd.maybe(0.4):
        writer.entry["ortho"] = warped(writer, path, odd)
    if "infrared" in kind:
        number = names.index("other") + 1
        text = f"bands of the orthophoto that are not used: {number} (Undefined)"
        files = 2 if writer.kind == "folder" else 1
        writer.warned.append((text, files, files))
    for key, (column, row) in middles.items():
        if writer.void != "none" and 4 < column < 10 and 4 < row < 10:
            continue
        seen = GREY if key == hidden else colours[key]
        writer.places.append((*writer.lon_lat(column, row), writer.height[int(row), int(column)], seen))
    case.notes.append(f"orthophoto: {kind}")
