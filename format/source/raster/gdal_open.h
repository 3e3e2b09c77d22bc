/// Opens rasters with GDAL and keeps them open between tiles.
#pragma once

#include <filesystem>
#include <gdal_priv.h>
#include <memory>
#include <string>
#include <vector>

namespace gigabake {

struct CloseDataset {
  void operator()(GDALDataset* d) const { GDALClose(d); }
};
using Dataset = std::unique_ptr<GDALDataset, CloseDataset>;

/// Opens a raster with the side files of its own name: world file, .prj, .tab, .aux.xml, .msk, .ovr.
/// No other file is opened: a side file that names files is refused, and so is a VRT with sources outside its folder.
/// Errors  InputError(file, key).
Dataset open_raster(const std::filesystem::path& file, const char* key);

/// An open raster that one thread uses; its destruction makes it available to others again.
using BorrowedRaster = std::shared_ptr<GDALDataset>;

/// Returns a raster that is already open, or opens it. Of formats that are read line by line only one is open at a
/// time, so that no line is read twice: other threads wait. A thread may borrow only one raster at a time.
/// Errors  InputError(file, key).
BorrowedRaster borrow_raster(const std::filesystem::path& file, const char* key);

/// Creates a raster in memory. Errors  InputError(file, key): no memory.
Dataset raster_in_memory(const std::filesystem::path& file, const char* key, int columns, int rows, int bands,
                         GDALDataType type);

/// Throws unless every source of a VRT is a raster file in the folder of the VRT or below.
/// Elements other than those that gdalbuildvrt and gdal_translate write are refused. Errors  InputError(file, key).
void expect_closed_vrt(const std::filesystem::path& file, const char* key);

/// Returns the names of side files that GDAL may open with a raster.
/// Errors  InputError naming a side file that leads to other files.
std::vector<std::string> safe_side_files(const std::filesystem::path& file);

}  // namespace gigabake
