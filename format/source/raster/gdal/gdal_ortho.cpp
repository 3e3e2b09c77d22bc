#include "format/source/raster/gdal/gdal_ortho.h"

#include <gdalwarper.h>
#include <sstream>

#include "format/source/image/png_bytes.h"
#include "format/source/raster/crs_text.h"
#include "format/source/raster/gdal/gdal_open.h"
#include "format/source/raster/ortho_bands.h"

namespace gigabake {
namespace {

constexpr std::uint8_t grey = 127;  ///< colour of texels without an orthophoto

struct DestroyTransformer {
  void operator()(void* transformer) const { GDALDestroyGenImgProjTransformer(transformer); }
};
using Transformer = std::unique_ptr<void, DestroyTransformer>;

std::string ortho_crs_of(const DemOptions& o, GDALDataset& ortho, const OGRSpatialReference* raster_crs) {
  if (!o.ortho_crs.empty()) return wkt_of(crs_of_text(o.ortho, "ortho_crs", o.ortho_crs));
  const OGRSpatialReference* own = plain_crs_of(ortho);
  if (own == nullptr && ortho.GetGCPSpatialRef() != nullptr && is_plain_crs(wkt_of(*ortho.GetGCPSpatialRef())))
    own = ortho.GetGCPSpatialRef();
  if (own == nullptr) own = raster_crs;
  return own != nullptr ? wkt_of(*own) : "";
}

/// Creates a map from the pixels of an orthophoto to the pixels of `target`. If `target` is null, the map leads to
/// coordinates of the raster. Uses only the geotransform or ground control points, because geolocation arrays are in
/// other files.
Transformer transformer_of(const DemOptions& o, GDALDataset& ortho, GDALDataset* target,
                           const OGRSpatialReference* raster_crs) {
  CPLStringList options;
  const std::string source = ortho_crs_of(o, ortho, raster_crs);
  double ignored[6];
  const bool is_placed = ortho.GetGeoTransform(ignored) == CE_None;
  if (!is_placed && ortho.GetGCPCount() == 0)
    throw InputError(o.ortho, "ortho",
                     "does not state the position of its pixels; give it a geotransform or a world file");
  options.SetNameValue("SRC_METHOD", is_placed ? "GEOTRANSFORM" : "GCP_POLYNOMIAL");
  if (!source.empty() && raster_crs != nullptr) {
    options.SetNameValue("SRC_SRS", source.c_str());
    options.SetNameValue("DST_SRS", wkt_of(*raster_crs).c_str());
  }
  Transformer out(GDALCreateGenImgProjTransformer2(&ortho, target, options.List()));
  if (!out) throw InputError(o.ortho, "ortho", "cannot be placed over the raster" + QuietErrors::last());
  return out;
}

/// Returns the grid of texels over a tile and its margin.
Grid texel_grid(const DemTile& tile, int texels, int margin) {
  Grid window{tile.raster->geotransform};
  const double cells = double(margin) / texels;
  const auto [x, y] = window.place(tile.column - cells, tile.row - cells);
  window.g[0] = x, window.g[3] = y;
  for (const std::size_t i : {1, 2, 4, 5}) window.g[i] /= texels;
  return window;
}

/// The image of one tile, composed of orthophotos.
class TileImage {
 public:
  TileImage(const DemTile& tile, const OGRSpatialReference* crs)
      : crs_(crs),
        texels_(tile.raster->texels_per_cell),
        margin_(margin_texels(texels_)),
        grid_(texel_grid(tile, texels_, margin_)),
        width_(tile.columns * texels_ + 2 * margin_),
        height_(tile.rows * texels_ + 2 * margin_),
        rgb_(std::size_t(3) * std::size_t(width_) * std::size_t(height_), grey) {}

  void add(const DemOptions& o) {
    const BorrowedRaster ortho = borrow_raster(o.ortho, "ortho");
    const OrthoBands bands = ortho_bands(o.ortho, *ortho);
    const int colours = int(bands.colours.size());
    const GDALDataType type = ortho->GetRasterBand(bands.colours[0])->GetRasterDataType();
    const Dataset warped = raster_in_memory(o.ortho, "ortho", width_, height_, colours + 1, type);
    double geotransform[6];
    std::copy(grid_.g.begin(), grid_.g.end(), geotransform);
    warped->SetGeoTransform(geotransform);
    warp(o, bands, *ortho, *warped);
    for (int row = 0; row < height_; ++row) blend_row(o, bands, *ortho, *warped, row);
  }

  EncodedImage encoded(const std::string& name) const { return {name, png_bytes(name, width_, height_, rgb_)}; }

 private:
  void warp(const DemOptions& o, const OrthoBands& bands, GDALDataset& ortho, GDALDataset& warped) const {
    const std::unique_ptr<GDALWarpOptions, decltype(&GDALDestroyWarpOptions)> w(GDALCreateWarpOptions(),
                                                                                &GDALDestroyWarpOptions);
    const Transformer transformer = transformer_of(o, ortho, &warped, crs_);
    const int count = int(bands.colours.size());
    w->hSrcDS = &ortho, w->hDstDS = &warped;
    w->eResampleAlg = bands.is_palette ? GRA_NearestNeighbour : GRA_Bilinear;  // palette indices cannot be interpolated
    w->nBandCount = count;
    w->panSrcBands = static_cast<int*>(CPLMalloc(std::size_t(count) * sizeof(int)));
    w->panDstBands = static_cast<int*>(CPLMalloc(std::size_t(count) * sizeof(int)));
    for (int i = 0; i < count; ++i) w->panSrcBands[i] = bands.colours[std::size_t(i)], w->panDstBands[i] = i + 1;
    w->nSrcAlphaBand = bands.alpha, w->nDstAlphaBand = count + 1;
    if (bands.alpha != 0)
      w->papszWarpOptions =
          CSLSetNameValue(w->papszWarpOptions, "SRC_ALPHA_MAX", std::to_string(bands.max_alpha).c_str());
    set_nodata(bands, ortho, *w);
    w->pfnTransformer = GDALGenImgProjTransform, w->pTransformerArg = transformer.get();
    GDALWarpOperation operation;
    const bool ok =
        operation.Initialize(w.get()) == CE_None && operation.ChunkAndWarpImage(0, 0, width_, height_) == CE_None;
    w->pTransformerArg = nullptr;
    if (!ok) throw InputError(o.ortho, "ortho", "cannot be read" + QuietErrors::last());
  }

  /// Sets the nodata values for warping. A pixel has no value if all of its colours are nodata.
  static void set_nodata(const OrthoBands& bands, GDALDataset& ortho, GDALWarpOptions& w) {
    int has_all = 1;
    std::vector<double> nodata;
    for (const int number : bands.colours) {
      int has_nodata = 0;
      nodata.push_back(ortho.GetRasterBand(number)->GetNoDataValue(&has_nodata));
      has_all &= has_nodata;
    }
    if (has_all == 0) return;
    w.padfSrcNoDataReal = static_cast<double*>(CPLMalloc(nodata.size() * sizeof(double)));
    std::copy(nodata.begin(), nodata.end(), w.padfSrcNoDataReal);
    w.papszWarpOptions = CSLSetNameValue(w.papszWarpOptions, "UNIFIED_SRC_NODATA", "YES");
  }

  void blend_row(const DemOptions& o, const OrthoBands& bands, GDALDataset& ortho, GDALDataset& warped, int row) {
    const int count = int(bands.colours.size()) + 1;
    std::vector<double> values(std::size_t(count) * std::size_t(width_));
    if (warped.RasterIO(GF_Read, 0, row, width_, 1, values.data(), width_, 1, GDT_Float64, count, nullptr,
                        int(sizeof(double)) * count, 0, sizeof(double), nullptr) != CE_None)
      throw InputError(o.ortho, "ortho", "cannot be read" + QuietErrors::last());
    const GDALRasterBand& first = *ortho.GetRasterBand(bands.colours[0]);
    const double opaque = warped.GetRasterBand(1)->GetRasterDataType() == GDT_Byte ? 255 : 65535;
    GDALColorTable* table = bands.is_palette ? const_cast<GDALRasterBand&>(first).GetColorTable() : nullptr;
    for (int column = 0; column < width_; ++column) {
      const double* v = &values[std::size_t(column) * std::size_t(count)];
      double rgb[3], alpha = v[count - 1] / opaque;
      if (bands.is_palette)
        alpha *= colour_of_index(*table, int(v[0]), rgb);
      else
        for (int c = 0; c < 3; ++c) rgb[c] = intensity(bands, v[count == 4 ? c : 0]);
      std::uint8_t* texel = &rgb_[(std::size_t(row) * std::size_t(width_) + std::size_t(column)) * 3];
      for (std::size_t c = 0; c < 3; ++c) texel[c] = std::uint8_t(std::lround(texel[c] + (rgb[c] - texel[c]) * alpha));
    }
  }

  static double intensity(const OrthoBands& bands, double value) {
    const double v = std::min(255.0, value * 255 / bands.max_value);
    return bands.is_inverted ? 255 - v : v;
  }

  /// Writes the colour of a palette entry to `rgb` and returns its opacity.
  static double colour_of_index(GDALColorTable& table, int index, double* rgb) {
    GDALColorEntry entry{};
    if (index < 0 || index >= table.GetColorEntryCount() || table.GetColorEntryAsRGB(index, &entry) == 0) entry = {};
    rgb[0] = entry.c1, rgb[1] = entry.c2, rgb[2] = entry.c3;
    return entry.c4 / 255.0;
  }

  const OGRSpatialReference* crs_;
  int texels_, margin_;
  Grid grid_;
  int width_, height_;
  std::vector<std::uint8_t> rgb_;
};

/// Returns whether `transformer` maps a point of one pixel grid into the other pixel grid. Tests 33 × 33 points.
bool reaches(void* transformer, int direction, int columns, int rows, double other_columns, double other_rows) {
  constexpr int steps = 32;
  std::vector<double> x, y, z;
  for (int r = 0; r <= steps; ++r)
    for (int c = 0; c <= steps; ++c)
      x.push_back(double(columns) * c / steps), y.push_back(double(rows) * r / steps), z.push_back(0);
  std::vector<int> ok(x.size(), 0);
  GDALGenImgProjTransform(transformer, direction, int(x.size()), x.data(), y.data(), z.data(), ok.data());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (ok[i] != 0 && x[i] >= 0 && x[i] <= other_columns && y[i] >= 0 && y[i] <= other_rows) return true;
  return false;
}

/// Returns whether a sample of an orthophoto has a pixel that is not transparent; true if the sample cannot be read.
bool has_colour(GDALDataset& ortho, const OrthoBands& bands) {
  constexpr int edge = 128;
  const int width = std::min(edge, ortho.GetRasterXSize()), height = std::min(edge, ortho.GetRasterYSize());
  std::vector<std::uint8_t> mask(std::size_t(width) * std::size_t(height));
  for (const int number : bands.colours) {
    GDALRasterBand& band = *ortho.GetRasterBand(bands.alpha != 0 ? bands.alpha : number);
    GDALRasterBand& validity = bands.alpha != 0 ? band : *band.GetMaskBand();
    if (validity.RasterIO(GF_Read, 0, 0, ortho.GetRasterXSize(), ortho.GetRasterYSize(), mask.data(), width, height,
                          GDT_Byte, 0, 0) != CE_None ||
        std::any_of(mask.begin(), mask.end(), [](std::uint8_t m) { return m != 0; }))
      return true;
  }
  return false;
}

/// Returns the width of a pixel of an orthophoto in coordinates of the raster.
double pixel_size(const DemOptions& o, GDALDataset& ortho, const OGRSpatialReference* crs) {
  const Transformer to_raster = transformer_of(o, ortho, nullptr, crs);
  double suggested[6];
  int width = 0, height = 0;
  if (GDALSuggestedWarpOutput(&ortho, GDALGenImgProjTransform, to_raster.get(), suggested, &width, &height) != CE_None)
    throw InputError(o.ortho, "ortho", "cannot be placed over the raster" + QuietErrors::last());
  return std::fabs(suggested[1]);
}

}  // namespace

OrthoFacts check_ortho(const DemPart& part, const Grid& grid, const OGRSpatialReference* crs) {
  const DemOptions& o = part.options;
  const BorrowedRaster ortho = borrow_raster(o.ortho, "ortho");
  const OrthoBands bands = ortho_bands(o.ortho, *ortho);
  OrthoFacts out;
  out.warnings = bands.warnings;
  for (const std::string& line : side_file_warnings(o.ortho)) out.warnings.push_back("of the orthophoto: " + line);
  out.texels_per_cell = std::sqrt(std::fabs(grid.determinant())) / pixel_size(o, *ortho, crs);
  const Dataset target = raster_in_memory(o.ortho, "ortho", 1, 1, 1, GDT_Byte);
  Grid of_part = grid;
  const auto [x, y] = grid.place(part.column - 0.5, part.row - 0.5);
  of_part.g[0] = x, of_part.g[3] = y;
  double geotransform[6];
  std::copy(of_part.g.begin(), of_part.g.end(), geotransform);
  target->SetGeoTransform(geotransform);
  const Transformer to_raster = transformer_of(o, *ortho, target.get(), crs);
  const int width = ortho->GetRasterXSize(), height = ortho->GetRasterYSize();
  if (!reaches(to_raster.get(), FALSE, width, height, part.columns, part.rows) &&
      !reaches(to_raster.get(), TRUE, part.columns, part.rows, width, height))
    out.warnings.push_back("the orthophoto " + in_quotes(o.ortho.filename().string()) +
                           " covers nothing of the raster, which is grey; is its coordinate system right? Set "
                           "\"ortho_crs\" in the scene .json");
  else if (!has_colour(*ortho, bands))
    out.warnings.push_back("the orthophoto " + in_quotes(o.ortho.filename().string()) +
                           " covers nothing: a sample of it has only transparent pixels");
  return out;
}

EncodedImage read_ortho(const DemTile& tile, const OGRSpatialReference* crs) {
  TileImage image(tile, crs);
  std::vector<std::filesystem::path> added;
  for (const DemPart& part : tile.raster->parts) {
    const DemOptions& o = part.options;
    if (!touches(tile, part) || o.ortho.empty() || std::find(added.begin(), added.end(), o.ortho) != added.end())
      continue;
    image.add(o);
    added.push_back(o.ortho);
  }
  return image.encoded(added.empty() ? tile.raster->parts[0].options.dem.string() : added[0].string());
}

}  // namespace gigabake
