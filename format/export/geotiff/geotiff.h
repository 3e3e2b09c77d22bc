/// Writer of cloud-optimized GeoTIFF files (COG), block by block, in bounded memory. It needs GDAL.
///
/// GDAL's COG driver copies a finished raster. Blocks therefore go to a temporary raster in the target's folder first,
/// with light compression. finish() adds overviews to it and copies it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "core/base/progress.h"

namespace gigabake {

enum class GeotiffPixels : std::uint8_t {
  heights,  ///< one band of float; NaN is no-data
  colours,  ///< red, green, blue and alpha, one byte each; alpha 0: no-data
  classes   ///< one band of int32; −1 is no-data
};

/// A raster with square pixels. Row 0 is the northern one.
struct GeotiffImage {
  GeotiffPixels pixels = GeotiffPixels::heights;
  std::uint32_t columns = 0, rows = 0;
  double west = 0, north = 0, step = 0;  ///< the corner of the first pixel, and the edge of a pixel
  std::string wkt;                       ///< the coordinate system
  std::string software, description;
  std::string height_unit;  ///< of heights
};

struct GeotiffResources {
  std::uint64_t cache_bytes = std::uint64_t(64) << 20;  ///< of GDAL's blocks
  int threads = 1;                                      ///< that compress
};

/// The edge of a block in pixels.
inline constexpr std::uint32_t geotiff_block = 512;

/// Errors  All members throw InputError that names the target: the disk is full, or GDAL failed.
class GeotiffFile {
 public:
  virtual ~GeotiffFile() = default;
  /// Writes the pixels of block (column, row), row by row. Blocks on the eastern and southern border are narrower.
  virtual void write_block(std::uint32_t column, std::uint32_t row, std::span<const std::byte> pixels) = 0;
  /// Adds overviews and publishes the file. Without finish(), no file remains.
  /// Errors  Stopped if `progress` cancels.
  virtual void finish(const Progress& progress) = 0;
};

/// Opens a file that finish() publishes as `target`.
/// Errors  InputError: the folder is missing or not writable. UsageError: this build has no GDAL.
std::unique_ptr<GeotiffFile> create_geotiff(const std::filesystem::path& target, const GeotiffImage& image,
                                            const GeotiffResources& resources);

}  // namespace gigabake
