#include <algorithm>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <limits>
#include <mutex>
#include <ogr_spatialref.h>
#include <vector>

#include "core/base/error.h"
#include "format/export/geotiff/geotiff_module.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

/// Scope that keeps the first error of GDAL, from any of GDAL's calls in this thread. GDAL reports some errors only
/// there: closing a file that could not be flushed returns nothing.
class GdalErrors {
 public:
  GdalErrors() { CPLPushErrorHandlerEx(keep, this); }
  ~GdalErrors() { CPLPopErrorHandler(); }
  GdalErrors(const GdalErrors&) = delete;
  GdalErrors& operator=(const GdalErrors&) = delete;

  /// Throws InputError if an error was reported, or if `failed`.
  void expect_none(const Path& target, bool failed = false) const {
    if (failed || !first_.empty())
      throw InputError(target, "", "cannot write: " + (first_.empty() ? std::string("GDAL failed") : first_));
  }

 private:
  static void CPL_STDCALL keep(CPLErr kind, CPLErrorNum, const char* text) {
    auto& self = *static_cast<GdalErrors*>(CPLGetErrorHandlerUserData());
    if (kind >= CE_Failure && self.first_.empty()) self.first_ = text;
  }

  std::string first_;
};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, CloseDataset>;

void register_drivers() {
  static std::once_flag once;
  std::call_once(once, [] {
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");  // writes no .aux.xml
    GDALRegister_GTiff(), GDALRegister_COG();
  });
}

GDALDriver& driver(const char* name) {
  GDALDriver* const found = GetGDALDriverManager()->GetDriverByName(name);
  if (found == nullptr) throw UsageError(std::string("`to` dsm, ortho and classes: this GDAL has no driver ") + name);
  return *found;
}

/// Passes GDAL's progress on. GDAL cannot pass exceptions, so a stop returns 0, and finish() throws.
struct ProgressOfGdal {
  const Progress& progress;
  std::uint64_t reported = 0;
  bool is_stopped = false;
  static constexpr std::uint64_t parts = 1000;

  static int CPL_STDCALL report(double done, const char*, void* data) {
    auto& self = *static_cast<ProgressOfGdal*>(data);
    try {
      const auto now = std::uint64_t(std::clamp(done, 0.0, 1.0) * double(parts));
      self.progress.advance(now > self.reported ? now - self.reported : 0);
      self.reported = std::max(self.reported, now);
    } catch (const Stopped&) {
      self.is_stopped = true;
    }
    return self.is_stopped ? 0 : 1;
  }
};

/// Each overview has half the pixels of the one before along each side; the last one is one block.
std::vector<int> overview_factors(const GeotiffImage& image) {
  std::vector<int> out;
  for (std::uint32_t edge = std::max(image.columns, image.rows), factor = 1; edge > geotiff_block;
       edge = (edge + 1) / 2)
    out.push_back(int(factor *= 2));
  return out;
}

class CogFile : public GeotiffFile {
 public:
  CogFile(const Path& target, const GeotiffImage& image, const GeotiffResources& resources)
      : target_(target),
        image_(image),
        threads_(std::to_string(resources.threads)),
        publication_(target, Leftovers::remove),
        blocks_(target.string() + ".blocks", Leftovers::remove) {
    const GdalErrors errors;
    register_drivers();
    GDALSetCacheMax64(GIntBig(resources.cache_bytes));
    create_raster();
    errors.expect_none(target_, !raster_);
    describe();
    errors.expect_none(target_);
  }

  void write_block(std::uint32_t column, std::uint32_t row, std::span<const std::byte> pixels) override {
    const GdalErrors errors;
    const std::uint32_t x = column * geotiff_block, y = row * geotiff_block;
    const int width = int(std::min(geotiff_block, image_.columns - x)),
              height = int(std::min(geotiff_block, image_.rows - y));
    auto* const data = const_cast<std::byte*>(pixels.data());  // GDAL only reads it
    const CPLErr result = raster_->RasterIO(GF_Write, int(x), int(y), width, height, data, width, height, type(),
                                            bands(), nullptr, 4, GSpacing(4) * width, 1, nullptr);
    errors.expect_none(target_, result != CE_None);
  }

  void finish(const Progress& progress) override {
    const GdalErrors errors;
    ProgressOfGdal of_gdal{progress};
    progress.step("writing overviews", ProgressOfGdal::parts, "");
    std::vector<int> factors = overview_factors(image_);
    // Means of classes are other classes.
    const char* filter = image_.pixels == GeotiffPixels::classes ? "MODE" : "AVERAGE";
    bool failed = !factors.empty() && raster_->BuildOverviews(filter, int(factors.size()), factors.data(), 0, nullptr,
                                                              ProgressOfGdal::report, &of_gdal) != CE_None;
    expect_done(errors, of_gdal, failed);
    progress.step("writing the file", ProgressOfGdal::parts, "");
    of_gdal.reported = 0;
    const CPLStringList options = cog_options();
    Dataset copy(driver("COG").CreateCopy(publication_.temporary().c_str(), raster_.get(), FALSE,
                                          const_cast<char**>(options.List()), ProgressOfGdal::report, &of_gdal));
    failed = !copy;
    copy.reset();
    raster_.reset();
    expect_done(errors, of_gdal, failed);
    publication_.publish();
  }

 private:
  void create_raster() {
    CPLStringList options;
    for (const char* option : {"TILED=YES", "BIGTIFF=YES", "COMPRESS=DEFLATE", "ZLEVEL=1", "SPARSE_OK=YES"})
      options.AddString(option);
    options.SetNameValue("BLOCKXSIZE", std::to_string(geotiff_block).c_str());
    options.SetNameValue("BLOCKYSIZE", std::to_string(geotiff_block).c_str());
    options.SetNameValue("NUM_THREADS", threads_.c_str());
    if (image_.pixels == GeotiffPixels::colours)
      options.SetNameValue("PHOTOMETRIC", "RGB"), options.SetNameValue("ALPHA", "NON-PREMULTIPLIED");
    raster_.reset(driver("GTiff").Create(blocks_.temporary().c_str(), int(image_.columns), int(image_.rows), bands(),
                                         type(), options.List()));
  }

  int bands() const { return image_.pixels == GeotiffPixels::colours ? 4 : 1; }
  GDALDataType type() const {
    if (image_.pixels == GeotiffPixels::colours) return GDT_Byte;
    return image_.pixels == GeotiffPixels::heights ? GDT_Float32 : GDT_Int32;
  }

  void describe() {
    OGRSpatialReference crs;
    if (crs.importFromWkt(image_.wkt.c_str()) != OGRERR_NONE)
      throw InputError(target_, "", "GDAL rejects " + image_.wkt);
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    raster_->SetSpatialRef(&crs);
    double transform[6] = {image_.west, image_.step, 0, image_.north, 0, -image_.step};
    raster_->SetGeoTransform(transform);
    raster_->SetMetadataItem("TIFFTAG_SOFTWARE", image_.software.c_str());
    raster_->SetMetadataItem("TIFFTAG_IMAGEDESCRIPTION", image_.description.c_str());
    GDALRasterBand& band = *raster_->GetRasterBand(1);
    if (image_.pixels == GeotiffPixels::classes) band.SetNoDataValue(-1);
    if (image_.pixels != GeotiffPixels::heights) return;
    band.SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
    band.SetUnitType(image_.height_unit.c_str());
  }

  CPLStringList cog_options() const {
    CPLStringList options;
    for (const char* option : {"COMPRESS=DEFLATE", "PREDICTOR=YES", "BIGTIFF=IF_SAFER", "OVERVIEWS=FORCE_USE_EXISTING"})
      options.AddString(option);
    options.SetNameValue("BLOCKSIZE", std::to_string(geotiff_block).c_str());
    options.SetNameValue("NUM_THREADS", threads_.c_str());
    return options;
  }

  void expect_done(const GdalErrors& errors, const ProgressOfGdal& progress, bool failed) const {
    if (progress.is_stopped) throw Stopped();
    errors.expect_none(target_, failed);
  }

  Path target_;
  GeotiffImage image_;
  std::string threads_;
  Publication publication_;
  Publication blocks_;  ///< never published: the raster that is copied
  Dataset raster_;
};

std::unique_ptr<GeotiffFile> create(const Path& target, const GeotiffImage& image, const GeotiffResources& resources) {
  return std::make_unique<CogFile>(target, image, resources);
}

}  // namespace
}  // namespace gigabake

const gigabake::GeotiffModule* gigabake_geotiff() {
  static const gigabake::GeotiffModule module{gigabake::create};
  return &module;
}
