/// Elevation rasters as bytes, and values that the bytes of sources share (source_bytes.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/io/bytes.h"
#include "format/source/raster/dem.h"

namespace gigabake::source_bytes {

/// The name of the bytes in errors.
inline constexpr const char* what = "sources";

/// Throws InputError: `key` is not `expected`.
[[noreturn]] void refuse(const char* key, const char* expected);

template <class Value>
void put_optional(ByteWriter& w, const std::optional<Value>& value) {
  w.put(std::uint8_t(value.has_value()));
  if (value) w.put(*value);
}

template <class Value>
void get_optional(ByteReader& r, std::optional<Value>& value) {
  bool is_there = false;
  r.get(is_there);
  value.reset();
  if (is_there) r.get(value.emplace());
}

std::filesystem::path get_path(ByteReader& r);

void put_raster(ByteWriter& w, const DemRaster& raster);
std::shared_ptr<const DemRaster> get_raster(ByteReader& r);
/// Writes the cells of a raster; `raster` is the number of the raster.
void put_dem(ByteWriter& w, const DemTile& dem, std::uint32_t raster);
std::shared_ptr<const DemTile> get_dem(ByteReader& r, const std::vector<std::shared_ptr<const DemRaster>>& rasters);

}  // namespace gigabake::source_bytes
