/// Elevation rasters as terrain: two triangles a cell, in tiles, an orthophoto on them.
///
/// A vertex is a pixel's centre, its place by the raster's coordinate system and WGS84. Cells with a corner that has no
/// value are holes. The diagonal goes from the first corner (lowest row and column) to the last.
/// Exact   All tiles of a raster share one frame and one grid of places, 2^-10 m apart, so that neighbours share their
///         vertices to the bit.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "format/source/mesh.h"
#include "lattice/frames.h"

namespace gigabake {

/// What a scene file says of a raster; members as its keys.
struct DemOptions {
  std::filesystem::path dem, ortho;      ///< ortho may be empty
  std::string crs;                       ///< in place of the raster's own: "EPSG:25832", WKT or a PROJ text
  std::string ortho_crs;                 ///< in place of the orthophoto's own
  std::optional<double> nodata;          ///< in place of the raster's own
  std::optional<double> height_scale;    ///< metres a unit; else what the raster says
  std::optional<double> geoid_offset_m;  ///< added to heights: the geoid above the ellipsoid; unset: 0
  int tile_cells = 256;                  ///< largest edge of a tile
};

/// One file of a surface, and its pixels' place in the surface's grid.
struct DemPart {
  DemOptions options;
  int column = 0, row = 0, columns = 0, rows = 0;
  std::vector<std::string> warnings;  ///< statements of the file that are not used; one line each, without its name.
                                      ///< Set only on the rank that opened the file
};

/// One surface: a raster, or several of one pixel grid. Where parts overlap, the last one with a value applies.
struct DemRaster {
  std::vector<DemPart> parts;            ///< at least one
  int columns = 0, rows = 0;             ///< pixels of the grid that all parts share
  int texels_per_cell = 1;               ///< of the orthophotos' images
  std::array<double, 6> geotransform{};  ///< of that grid, as GDAL defines it
  Geodetic origin;                       ///< of the frame, which is east-north-up: the middle of the first part, on the
                                         ///< ellipsoid. In a plane y and x are in the members of latitude and longitude
  bool is_on_earth = true;
};

/// A rectangle of cells.
struct DemTile {
  std::shared_ptr<const DemRaster> raster;
  int column = 0, row = 0, columns = 0, rows = 0;
  std::array<double, 3> offset_m{};  ///< of the tile's own frame in the raster's: whole metres
};

/// Returns whether a part belongs to a tile, or to the margin of one cell that its image has.
inline bool touches(const DemTile& tile, const DemPart& part) {
  return part.column <= tile.column + tile.columns + 1 && part.column + part.columns + 1 >= tile.column &&
         part.row <= tile.row + tile.rows + 1 && part.row + part.rows + 1 >= tile.row;
}

/// The tiles of one surface, at least one.
using DemSurface = std::vector<DemTile>;

/// Reads the heads of rasters, and elevation only where it is refused. Rasters of one coordinate system whose pixels
/// lie on one grid become one surface, in the place of the first of them. Formats: GeoTIFF (COG), ASCII grid, SRTM HGT,
/// PNG and JPEG with a world file, VRT of files in its folder. is_local: a raster need not be on the earth, but may be
/// on another body or in a plane. Errors  InputError naming the key of the scene file to set: a coordinate system that
/// is missing, unknown, not on the
///         earth, or that the raster's numbers do not fit; an image in place of heights; no raster; built without GDAL.
std::vector<DemSurface> open_dem(const std::vector<DemOptions>& options, bool is_local);

/// One primitive in the tile's own frame (z up), one instance there; the orthophoto's part as an image.
/// Cost    Reads the tile's window of both rasters, whatever their size.
/// Errors  InputError: what cannot be read.
struct DemMesh {
  Primitive primitive;
  Material material;
  std::vector<EncodedImage> images;   ///< one or none
  std::vector<std::string> warnings;  ///< of this tile's heights; one line each, without the raster's name
};
DemMesh read_dem(const DemTile& tile, bool with_ortho);

/// Returns the files that a tile is read from, with the side files that belong to them.
std::vector<std::filesystem::path> dem_files(const DemTile& tile);

}  // namespace gigabake
