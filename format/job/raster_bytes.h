/// Elevation rasters as bytes, and values that the bytes of sources share (source_bytes.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/io/bytes.h"
#include "format/source/raster/dem.h"

namespace gigabake::source_bytes {

/// The name of the bytes in errors.
inline constexpr const char* what = "sources";

/// Throws InputError: `key` is not `expected`.
[[noreturn]] void refuse(const char* key, const char* expected);

std::filesystem::path get_path(ByteReader& r);

void put_raster(ByteWriter& w, const DemRaster& raster);
std::shared_ptr<const DemRaster> get_raster(ByteReader& r);
/// Writes the cells of a raster; `raster` is the number of the raster.
void put_dem(ByteWriter& w, const DemTile& dem, std::uint32_t raster);
std::shared_ptr<const DemTile> get_dem(ByteReader& r, const std::vector<std::shared_ptr<const DemRaster>>& rasters);

}  // namespace gigabake::source_bytes
