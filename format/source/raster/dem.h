/// Elevation rasters as terrain: tiles with two triangles per cell, textured with an orthophoto.
///
/// Vertices are centres of pixels, converted from the coordinate system of the raster to WGS84. Cells with a corner
/// without a value are holes. The diagonal of a cell connects the first corner (lowest row and column) and the last.
/// Exact   All tiles of a raster share one frame, and positions are multiples of 2^-10 m, so vertices that neighbouring
///         tiles share are bit-identical.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/math/frames.h"
#include "format/source/mesh.h"

namespace gigabake {

/// The options of a raster in a scene file; members are named like the keys.
struct DemOptions {
  std::filesystem::path dem, ortho;      ///< ortho may be empty
  std::string crs;                       ///< overrides that of the raster: "EPSG:25832", WKT or a PROJ text
  std::string ortho_crs;                 ///< overrides that of the orthophoto
  std::vector<double> nodata;            ///< numbers that mark missing heights; override that of the raster
  std::optional<double> height_scale;    ///< metres per unit; overrides the unit of the raster
  std::optional<double> geoid_offset_m;  ///< height of the geoid above the ellipsoid, added to heights; unset: 0
  int tile_cells = 256;                  ///< max edge of a tile in cells
};

/// One file of a surface, and the position of its pixels in the grid of the surface.
struct DemPart {
  DemOptions options;
  int column = 0, row = 0, columns = 0, rows = 0;
  std::vector<std::filesystem::path> grids;  ///< grids of PROJ from which heights are converted
  std::string heights_note;                  ///< how heights are understood; one line, without the file's name, or
                                             ///< empty. Set only on the rank that opened the file
  std::vector<std::string> warnings;         ///< unused declarations of the file, one line each, without its name.
                                             ///< Set only on the rank that opened the file
};

/// A surface: one or more rasters on one pixel grid. If parts overlap, the last part that has a value applies.
struct DemRaster {
  std::vector<DemPart> parts;            ///< not empty
  int columns = 0, rows = 0;             ///< pixels of the grid that all parts share
  int texels_per_cell = 1;               ///< resolution of the image of a tile
  std::array<double, 6> geotransform{};  ///< of the shared grid, as GDAL defines it
  Geodetic origin;                       ///< origin of the east-north-up frame: centre of the first part, on the
                                         ///< ellipsoid. In a plane latitude and longitude hold y and x
  bool is_on_earth = true;
};

/// A rectangle of cells of a surface.
struct DemTile {
  std::shared_ptr<const DemRaster> raster;
  int column = 0, row = 0, columns = 0, rows = 0;
  std::array<double, 3> offset_m{};  ///< origin of the tile's frame in the frame of the raster, in whole metres
  /// A box around the tile in the frame of the raster, for all heights on the earth. Equal corners: unknown. Set only
  /// on the rank that opened the file.
  std::array<double, 3> low_m{}, high_m{};
};

/// Returns whether a part overlaps a tile or the margin of one cell around its image.
inline bool touches(const DemTile& tile, const DemPart& part) {
  return part.column <= tile.column + tile.columns + 1 && part.column + part.columns + 1 >= tile.column &&
         part.row <= tile.row + tile.rows + 1 && part.row + part.rows + 1 >= tile.row;
}

/// The tiles of one surface; not empty.
using DemSurface = std::vector<DemTile>;

/// Reads the headers of rasters and groups the rasters into surfaces, in the order of their first rasters.
/// Rasters with the same coordinate system and pixel grid become one surface. Elevation is read only if a raster is
/// rejected. If `is_local`, a raster may be on another body than the earth or in a plane. Formats: GeoTIFF (COG), ASCII
/// grid, SRTM HGT, PNG and JPEG with a world file, VRT of files in its folder.
/// Errors  InputError names the key to set in the scene file. The coordinate system is missing, unknown, not on the
///         earth or does not fit the numbers of the raster. The file is not a raster, or is an image. The build has no
///         GDAL.
std::vector<DemSurface> open_dem(const std::vector<DemOptions>& options, bool is_local);

/// The mesh of a tile in the frame of the tile (z up), with its part of the orthophoto as an image.
struct DemMesh {
  Primitive primitive;
  Material material;
  std::vector<EncodedImage> images;   ///< at most one
  std::vector<std::string> warnings;  ///< about heights of the tile; one line each, without the raster's name
};
/// Reads a tile.
/// Cost    Reads only the window of the tile from the rasters and orthophotos, independent of their size.
/// Errors  InputError: a file cannot be read.
DemMesh read_dem(const DemTile& tile, bool with_ortho);

/// Returns the files from which a tile is read, including their side files.
std::vector<std::filesystem::path> dem_files(const DemTile& tile);

}  // namespace gigabake
