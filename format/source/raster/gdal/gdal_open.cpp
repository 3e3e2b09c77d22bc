#include "format/source/raster/gdal/gdal_open.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <gdal_frmts.h>
#include <list>
#include <mutex>
#include <set>
#include <string_view>
#include <tuple>

#include "core/base/error.h"
#include "format/source/raster/gdal_raster.h"
#include "format/source/raster/proj_files.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

constexpr std::size_t max_idle_rasters = 64;

void register_drivers() {
  static std::once_flag once;
  std::call_once(once, [] {
    CPLSetConfigOption("GDAL_CACHEMAX", "64");
    CPLSetConfigOption("GDAL_PAM_ENABLED", "YES");  // reads .aux.xml; never writes it, because nothing is modified
    confine_proj();
    // Other drivers are not registered: any driver may open a side file of its format, and some use the network.
    GDALRegister_GTiff(), GDALRegister_AAIGrid(), GDALRegister_SRTMHGT(), GDALRegister_PNG(), GDALRegister_JPEG();
    GDALRegister_VRT(), GDALRegister_MEM();
  });
}

bool is_vrt(const Path& file) {
  const std::string extension = file.extension().string();
  return EQUAL(extension.c_str(), ".vrt");
}

/// Returns whether the format has no random access to blocks, so that all preceding lines must be read.
bool is_read_by_lines(GDALDataset& dataset) {
  const std::string_view driver = dataset.GetDriver() != nullptr ? dataset.GetDriver()->GetDescription() : "";
  return driver == "AAIGrid" || driver == "PNG" || driver == "JPEG";
}

/// Size and modification time of a file, which detect changes.
using FileState = std::tuple<std::uintmax_t, std::filesystem::file_time_type>;

FileState state_of(const Path& file) {
  std::error_code error;
  return {std::filesystem::file_size(file, error), std::filesystem::last_write_time(file, error)};
}

/// Pool of open rasters.
class Pool {
 public:
  BorrowedRaster borrow(const Path& file, const char* key) {
    const FileState state = state_of(file);
    {
      std::unique_lock lock(mutex_);
      is_free_.wait(lock, [&] { return !exclusive_.contains(file); });
      const auto idle =
          std::find_if(idle_.begin(), idle_.end(), [&](const Idle& i) { return i.file == file && i.state == state; });
      exclusive_.insert(file);
      if (idle != idle_.end()) {
        Dataset dataset = std::move(idle->dataset);
        idle_.erase(idle);
        if (!is_read_by_lines(*dataset)) release(file);
        return lent(file, state, std::move(dataset));
      }
    }
    try {
      Dataset dataset = open_raster(file, key);
      const std::lock_guard lock(mutex_);
      if (!is_read_by_lines(*dataset)) release(file);
      return lent(file, state, std::move(dataset));
    } catch (...) {
      const std::lock_guard lock(mutex_);
      release(file);
      throw;
    }
  }

 private:
  struct Idle {
    Path file;
    FileState state;
    Dataset dataset;
  };

  BorrowedRaster lent(const Path& file, const FileState& state, Dataset dataset) {
    const int exceptions = std::uncaught_exceptions();
    return {dataset.release(),
            [this, file, state, exceptions](GDALDataset* d) { take_back(file, state, Dataset(d), exceptions); }};
  }

  /// Returns a raster to the pool. Closes the raster after an error, because its decoder may be in an invalid state.
  void take_back(const Path& file, const FileState& state, Dataset dataset, int exceptions) {
    std::list<Idle> closed;  // closed after the lock is released
    const std::lock_guard lock(mutex_);
    if (is_read_by_lines(*dataset)) release(file);
    if (std::uncaught_exceptions() > exceptions) {
      closed.push_front({file, state, std::move(dataset)});
      return;
    }
    idle_.push_front({file, state, std::move(dataset)});
    if (idle_.size() > max_idle_rasters) closed.splice(closed.begin(), idle_, std::prev(idle_.end()));
  }

  void release(const Path& file) {
    exclusive_.erase(file);
    is_free_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable is_free_;
  std::list<Idle> idle_;      ///< most recently used first
  std::set<Path> exclusive_;  ///< files that a thread is opening or reads line by line
};

/// Copies the unit of heights from the first source, because gdalbuildvrt copies scale and offset, but no unit.
void add_unit_of_source(const Path& file, const char* key, GDALDataset& vrt) {
  GDALRasterBand& band = *vrt.GetRasterBand(1);
  if (*band.GetUnitType() != 0) return;
  const CPLStringList files(vrt.GetFileList());
  for (int i = 0; i < files.size(); ++i) {
    if (std::string_view(files[i]).starts_with(file.native())) continue;  // skips the VRT, its overviews and its mask
    const Dataset source = open_raster(files[i], key);
    band.SetUnitType(source->GetRasterBand(1)->GetUnitType());
    return;
  }
}

}  // namespace

Dataset open_raster(const Path& file, const char* key) {
  register_drivers();
  static const char* const formats[] = {"GTiff", "AAIGrid", "SRTMHGT", "PNG", "JPEG", nullptr};
  static const char* const vrt_format[] = {"VRT", nullptr};
  CPLStringList siblings;
  for (const std::string& name : safe_side_files(file)) siblings.AddString(name.c_str());
  if (is_vrt(file)) expect_closed_vrt(file, key);
  Dataset out(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, is_vrt(file) ? vrt_format : formats,
                                nullptr, siblings.List()));
  if (!out || out->GetRasterCount() < 1)
    throw InputError(
        file, key,
        "expected a GeoTIFF, ASCII grid, HGT, VRT, PNG or JPEG raster; convert others with gdal_translate IN "
        "OUT.tif" +
            QuietErrors::last());
  if (out->GetMetadataItem("OVERVIEW_FILE", "OVERVIEWS") != nullptr)
    throw InputError(file, key, "names another file as its overviews; write it again with gdal_translate");
  if (is_vrt(file)) add_unit_of_source(file, key, *out);
  return out;
}

BorrowedRaster borrow_raster(const Path& file, const char* key) {
  register_drivers();
  static Pool& pool = *new Pool;  // never destroyed, because GDAL would be destroyed before it
  return pool.borrow(file, key);
}

Dataset raster_in_memory(const Path& file, const char* key, int columns, int rows, int bands, GDALDataType type) {
  GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
  Dataset out(memory->Create("", columns, rows, bands, type, nullptr));
  if (!out) throw InputError(file, key, "cannot be read" + QuietErrors::last());
  return out;
}

}  // namespace gigabake
