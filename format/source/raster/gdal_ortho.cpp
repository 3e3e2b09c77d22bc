#include <gdalwarper.h>

#include "format/source/image/png_bytes.h"
#include "format/source/raster/gdal_raster.h"

namespace gigabake {
namespace {

constexpr int most_texels_a_cell = 32, most_texture_edge = 8192;

/// The orthophoto over a tile and a cell around it, in the tile's own grid.
class OrthoWindow {
 public:
  OrthoWindow(const DemTile& tile, const Grid& grid, const EarthMap& earth) : tile_(tile), grid_(grid), earth_(earth) {}

  EncodedImage read() const {
    const DemOptions& o = tile_.raster->options;
    const Dataset ortho = open_raster(o.ortho, "ortho");
    const OGRSpatialReference* own = plain_crs_of(*ortho);
    const std::string source_crs = wkt_of(own != nullptr ? *own : earth_.crs());
    const std::string crs = wkt_of(earth_.crs());
    const int texels = texels_a_cell(*ortho, source_crs, crs);
    const int width = (tile_.columns + 2 * margin_cells) * texels, height = (tile_.rows + 2 * margin_cells) * texels;
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    const Dataset out(memory->Create("", width, height, 3, GDT_Byte, nullptr));
    if (!out) throw InputError(o.ortho, "ortho", "cannot be read" + QuietErrors::last());
    Grid window = grid_;
    const auto [x, y] = grid_.place(tile_.column - margin_cells, tile_.row - margin_cells);
    window.g[0] = x, window.g[3] = y;
    for (const int i : {1, 2, 4, 5}) window.g[i] /= texels;
    out->SetGeoTransform(window.g);
    out->SetProjection(crs.c_str());
    fill_grey(*out);
    warp(*ortho, *out, source_crs, crs);
    return {o.ortho.string(), png_of(*out, width, height)};
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(tile_.raster->options.ortho, "ortho", message + QuietErrors::last());
  }

  /// As many as keep the photo's resolution.
  int texels_a_cell(GDALDataset& ortho, const std::string& source_crs, const std::string& crs) const {
    void* to_tile = GDALCreateGenImgProjTransformer(&ortho, source_crs.c_str(), nullptr, crs.c_str(), TRUE, 0, 1);
    if (to_tile == nullptr) fail("cannot be placed over the raster");
    double suggested[6];
    int width = 0, height = 0;
    const CPLErr error = GDALSuggestedWarpOutput(&ortho, GDALGenImgProjTransform, to_tile, suggested, &width, &height);
    GDALDestroyGenImgProjTransformer(to_tile);
    if (error != CE_None) fail("cannot be placed over the raster");
    const double cell = std::sqrt(std::fabs(grid_.determinant())), pixel = std::fabs(suggested[1]);
    const int most = std::max(1, most_texture_edge / (std::max(tile_.columns, tile_.rows) + 2 * margin_cells));
    return std::clamp(int(std::lround(cell / pixel)), 1, std::min(most, most_texels_a_cell));
  }

  /// Where there is no photo.
  static void fill_grey(GDALDataset& out) {
    for (int band = 1; band <= 3; ++band) out.GetRasterBand(band)->Fill(127);
  }

  void warp(GDALDataset& ortho, GDALDataset& out, const std::string& source_crs, const std::string& crs) const {
    std::unique_ptr<GDALWarpOptions, decltype(&GDALDestroyWarpOptions)> o(GDALCreateWarpOptions(),
                                                                          &GDALDestroyWarpOptions);
    const bool is_colour = ortho.GetRasterCount() >= 3;
    o->hSrcDS = &ortho;
    o->hDstDS = &out;
    o->eResampleAlg = GRA_Bilinear;
    o->nBandCount = 3;
    o->panSrcBands = static_cast<int*>(CPLMalloc(3 * sizeof(int)));
    o->panDstBands = static_cast<int*>(CPLMalloc(3 * sizeof(int)));
    for (int i = 0; i < 3; ++i) o->panSrcBands[i] = is_colour ? i + 1 : 1, o->panDstBands[i] = i + 1;
    if (ortho.GetRasterCount() == 4 || ortho.GetRasterCount() == 2) o->nSrcAlphaBand = ortho.GetRasterCount();
    o->pTransformerArg = GDALCreateGenImgProjTransformer(&ortho, source_crs.c_str(), &out, crs.c_str(), FALSE, 0, 1);
    if (o->pTransformerArg == nullptr) fail("cannot be placed over the raster");
    o->pfnTransformer = GDALGenImgProjTransform;
    GDALWarpOperation operation;
    const bool ok = operation.Initialize(o.get()) == CE_None &&
                    operation.ChunkAndWarpImage(0, 0, out.GetRasterXSize(), out.GetRasterYSize()) == CE_None;
    GDALDestroyGenImgProjTransformer(o->pTransformerArg);
    o->pTransformerArg = nullptr;
    if (!ok) fail("cannot be read");
  }

  std::vector<std::uint8_t> png_of(GDALDataset& out, int width, int height) const {
    std::vector<std::uint8_t> rgb(std::size_t(3) * std::size_t(width) * std::size_t(height));
    if (out.RasterIO(GF_Read, 0, 0, width, height, rgb.data(), width, height, GDT_Byte, 3, nullptr, 3, 3 * width, 1,
                     nullptr) != CE_None)
      fail("cannot be read");
    return png_bytes(tile_.raster->options.ortho.string(), width, height, rgb);
  }

  const DemTile& tile_;
  const Grid& grid_;
  const EarthMap& earth_;
};

}  // namespace

EncodedImage read_ortho(const DemTile& tile, const Grid& grid, const EarthMap& earth) {
  return OrthoWindow(tile, grid, earth).read();
}

}  // namespace gigabake
