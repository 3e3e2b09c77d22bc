#include "format/source/raster/dem_checks.h"

#include <array>
#include <optional>
#include <string_view>

namespace gigabake {
namespace {

/// The surface that heights start from.
struct VerticalSystem {
  std::string name, unit;
  double unit_m = 1;
  bool is_depth = false;
};

std::optional<VerticalSystem> vertical_system(const OGRSpatialReference* crs) {
  if (crs == nullptr || crs->IsVertical() == 0) return std::nullopt;
  VerticalSystem out;
  const char* name = crs->GetAttrValue("VERT_CS");
  if (name == nullptr) name = crs->GetName();
  out.name = name != nullptr ? name : "unnamed";
  const char* unit = nullptr;
  out.unit_m = crs->GetTargetLinearUnits("VERT_CS", &unit);
  out.unit = unit != nullptr ? unit : "metre";
  OGRAxisOrientation up = OAO_Up;
  crs->GetAxis("VERT_CS", 0, &up);
  out.is_depth = up == OAO_Down;
  return out;
}

std::optional<VerticalSystem> vertical_system_of(const DemOptions& options, GDALDataset& dataset) {
  if (!options.crs.empty()) {
    const OGRSpatialReference named = whole_crs_of(options, dataset);
    if (auto vertical = vertical_system(&named)) return vertical;
  }
  if (auto vertical = vertical_system(dataset.GetSpatialRef())) return vertical;
  if (std::string_view(dataset.GetDriver()->GetDescription()) == "SRTMHGT")
    return VerticalSystem{"EGM96 height", "metre"};  // by the definition of this format
  return std::nullopt;
}

void check_vertical(const DemOptions& options, GDALDataset& dataset, std::vector<std::string>& warnings) {
  const std::optional<VerticalSystem> vertical = vertical_system_of(options, dataset);
  if (!vertical) return;
  if (vertical->is_depth && !options.height_scale)
    throw InputError(options.dem, "height_scale",
                     "the raster's heights are depths below " + in_quotes(vertical->name) +
                         "; set -1 in the scene file (a foot: -0.3048)");
  const bool has_unit = *dataset.GetRasterBand(1)->GetUnitType() != 0;
  if (std::fabs(vertical->unit_m - 1) > 1e-9 && !has_unit && !options.height_scale)
    throw InputError(options.dem, "height_scale",
                     "the heights of " + in_quotes(vertical->name) + " are in " + in_quotes(vertical->unit) +
                         "; set the metres of one in the scene file (a foot: 0.3048)");
  if (options.geoid_offset_m) return;
  warnings.push_back("its vertical reference system " + in_quotes(vertical->name) +
                     " is not applied: heights are taken as metres above the WGS84 ellipsoid and may be up to 100 m "
                     "off; set geoid_offset_m in a scene .json (0: leave them as they are)");
}

/// Heights of a system in feet are often in feet, and often in metres.
void check_unit(const DemOptions& options, GDALDataset& dataset, std::vector<std::string>& warnings) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  height_scale_of(options, band);
  const OGRSpatialReference crs = whole_crs_of(options, dataset);
  const char* unit = nullptr;
  const double unit_m = crs.GetTargetLinearUnits("PROJCS", &unit);
  if (crs.IsProjected() == 0 || std::fabs(unit_m - 1) < 1e-9 || *band.GetUnitType() != 0 || options.height_scale)
    return;
  warnings.push_back("its coordinates are in " + in_quotes(unit != nullptr ? unit : "another unit") +
                     " and it does not say in which unit its heights are: taken as metres; set height_scale in a "
                     "scene .json (1, or a foot: 0.3048)");
}

bool is_alpha(GDALRasterBand& band) { return band.GetColorInterpretation() == GCI_AlphaBand; }

int bands_without_alpha(GDALDataset& dataset) {
  int bands = 0;
  for (int i = 1; i <= dataset.GetRasterCount(); ++i) bands += is_alpha(*dataset.GetRasterBand(i)) ? 0 : 1;
  return bands;
}

/// Heights packed into the colours of an image are recognised by their red: the highest byte of a height.
/// Source  Mapbox Terrain-RGB v1: -10000 m + (65536 R + 256 G + B) · 0.1 m; Terrarium: 256 R + G + B / 256 - 32768 m.
std::string encoding_of(GDALDataset& dataset) {
  constexpr int edge = 64;
  std::array<unsigned char, std::size_t(edge) * edge> red{};
  if (dataset.GetRasterBand(1)->RasterIO(GF_Read, 0, 0, dataset.GetRasterXSize(), dataset.GetRasterYSize(), red.data(),
                                         edge, edge, GDT_Byte, 0, 0) != CE_None)
    return "";
  const auto [least, greatest] = std::minmax_element(red.begin(), red.end());
  if (*greatest <= 2 && *greatest > 0) return "Mapbox Terrain-RGB";
  return *least >= 124 && *greatest <= 163 && *greatest - *least <= 16 ? "Terrarium" : "";
}

[[noreturn]] void refuse_image(const DemOptions& options, GDALDataset& dataset, const std::string& what) {
  const std::string encoding = bands_without_alpha(dataset) >= 3 ? encoding_of(dataset) : "";
  if (!encoding.empty())
    throw InputError(options.dem, "dem",
                     "looks like elevation packed into colours (" + encoding +
                         "); decode it to heights in metres first, with gdal_calc.py, say");
  throw InputError(
      options.dem, "dem",
      "is an image (" + what + "), not heights; name it as \"ortho\" of an elevation raster in a scene .json");
}

void check_bands(const DemOptions& options, GDALDataset& dataset, std::vector<std::string>& warnings) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const GDALDataType type = band.GetRasterDataType();
  const int bands = bands_without_alpha(dataset);
  const GDALColorInterp colour = band.GetColorInterpretation();
  if (GDALDataTypeIsComplex(type) != 0)
    throw InputError(options.dem, "dem",
                     std::string("holds complex numbers (") + GDALGetDataTypeName(type) + "), not heights");
  if (colour == GCI_PaletteIndex || band.GetColorTable() != nullptr) refuse_image(options, dataset, "with a palette");
  if (colour != GCI_Undefined && colour != GCI_GrayIndex)
    refuse_image(options, dataset, std::string("its first band is ") + GDALGetColorInterpretationName(colour));
  if (type == GDT_Byte && bands >= 3) refuse_image(options, dataset, std::to_string(bands) + " bands of 8 bits");
  const double scale = band.GetScale();
  if (!std::isfinite(scale) || scale == 0 || !std::isfinite(band.GetOffset()))
    throw InputError(options.dem, "dem", "its scale or offset of heights is no number, or 0");
  if (bands > 1)
    warnings.push_back("has " + std::to_string(bands) + " bands; heights are those of the first one (" +
                       (*band.GetDescription() != 0 ? in_quotes(band.GetDescription()) : "without a name") +
                       "), the others are not used");
  if (type == GDT_Byte && scale == 1 && !options.height_scale)
    warnings.push_back(
        "has heights of 8 bits, whole metres from 0 to 255, as grey images have; set height_scale in a scene .json, "
        "the metres of one step (1: they are metres)");
}

}  // namespace

GDALRasterBand* validity_band(GDALDataset& dataset) {
  for (int i = 2; i <= dataset.GetRasterCount(); ++i)
    if (is_alpha(*dataset.GetRasterBand(i))) return dataset.GetRasterBand(i);
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  return (band.GetMaskFlags() & GMF_PER_DATASET) != 0 ? band.GetMaskBand() : nullptr;
}

double height_scale_of(const DemOptions& options, GDALRasterBand& band) {
  if (options.height_scale) return *options.height_scale;
  const std::string unit = band.GetUnitType();
  if (unit.empty() || unit == "m" || unit == "metre" || unit == "meter" || unit == "metres" || unit == "meters")
    return 1;
  throw InputError(
      options.dem, "height_scale",
      "the raster's heights are in " + in_quotes(unit) + "; set the metres of one in the scene file (a foot: 0.3048)");
}

std::vector<std::string> check_dem(const DemOptions& options, GDALDataset& dataset) {
  std::vector<std::string> warnings;
  check_bands(options, dataset, warnings);
  check_vertical(options, dataset, warnings);
  check_unit(options, dataset, warnings);
  return warnings;
}

}  // namespace gigabake
