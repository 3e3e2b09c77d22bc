/// Opening of rasters with GDAL, and a pool of rasters that remain open between tiles.
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

/// Opens a raster with side files of the same name: world file, .prj, .tab, .aux.xml, .msk, .ovr.
/// Other files are never opened: a side file that names files is rejected, like a VRT with sources outside its folder.
/// Errors  InputError(file, key): the file cannot be opened or is rejected.
Dataset open_raster(const std::filesystem::path& file, const char* key);

/// An open raster for exclusive use by one thread. Its destruction returns the raster to the pool.
using BorrowedRaster = std::shared_ptr<GDALDataset>;

/// Returns an open raster from the pool, or opens the raster. A file in a format that is read line by line is open only
/// once, so that no line is read twice. Other threads wait for it. A thread may borrow only one raster at a time.
/// Errors  InputError(file, key) like open_raster().
BorrowedRaster borrow_raster(const std::filesystem::path& file, const char* key);

/// Creates a raster in memory.
/// Errors  InputError(file, key): the allocation fails.
Dataset raster_in_memory(const std::filesystem::path& file, const char* key, int columns, int rows, int bands,
                         GDALDataType type);

/// Checks that each source of a VRT is a raster file in the folder of the VRT or below.
/// Accepts only elements that gdalbuildvrt and gdal_translate write.
/// Errors  InputError(file, key): a source or an element is not accepted.
void expect_closed_vrt(const std::filesystem::path& file, const char* key);

/// Returns the names of the raster and of the side files that GDAL may open with it.
/// Errors  InputError(side file): the side file names other files.
std::vector<std::string> safe_side_files(const std::filesystem::path& file);

/// Returns one warning for each .aux.xml side file that cannot be read.
/// Errors  InputError like safe_side_files().
std::vector<std::string> side_file_warnings(const std::filesystem::path& file);

}  // namespace gigabake
