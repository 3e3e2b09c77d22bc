#include "format/source/raster/raster_claims.h"

#include <algorithm>
#include <string>

#include "core/base/memory_limit.h"
#include "format/source/raster/gdal/gdal_ortho.h"

namespace gigabake {
namespace {

/// Bytes of a DemTile and of its TileRef, including the name.
constexpr std::uint64_t tile_bytes = 800;
constexpr std::uint64_t max_tiles = std::uint64_t(1) << 22;

}  // namespace

void claim_tile(const DemOptions& o, GDALDataset& dataset) {
  constexpr std::uint64_t pixel_bytes = 96, block_value_bytes = 16;
  int width = 0, height = 0;
  dataset.GetRasterBand(1)->GetBlockSize(&width, &height);
  MemoryClaim claim(o.dem, "store it in smaller blocks");
  claim.add_items(std::uint64_t(width) * std::uint64_t(height), block_value_bytes, "dem", "pixels of a block");
  const auto edge = [&](int pixels) { return std::uint64_t(std::min(pixels, o.tile_cells + 1)); };
  MemoryClaim(o.dem, "lower tile_cells in the scene file")
      .add_items(edge(dataset.GetRasterXSize()) * edge(dataset.GetRasterYSize()), pixel_bytes, "tile_cells",
                 "points of a tile");
}

void claim_tiles(const DemRaster& raster, int edge) {
  const DemOptions& o = raster.parts[0].options;
  const std::uint64_t tiles = std::uint64_t(raster.columns / edge + 1) * std::uint64_t(raster.rows / edge + 1);
  if (tiles > max_tiles) throw InputError(o.dem, "tile_cells", "more than 2^22 tiles; enlarge it in the scene file");
  MemoryClaim(o.dem, "enlarge tile_cells in the scene file").add_items(tiles, tile_bytes, "tile_cells", "tiles");
}

void claim_image(const DemRaster& raster, int edge) {
  constexpr std::uint64_t texel_bytes = 18;
  const auto part =
      std::find_if(raster.parts.begin(), raster.parts.end(), [](const DemPart& p) { return !p.options.ortho.empty(); });
  if (part == raster.parts.end()) return;
  const auto texels = [&](int pixels) {
    return std::uint64_t(std::min(pixels - 1, edge)) * std::uint64_t(raster.texels_per_cell) +
           2 * std::uint64_t(margin_texels(raster.texels_per_cell));
  };
  MemoryClaim(part->options.ortho, "lower tile_cells in the scene file")
      .add_items(texels(raster.columns) * texels(raster.rows), texel_bytes, "ortho", "texels of a tile's image");
}

}  // namespace gigabake
