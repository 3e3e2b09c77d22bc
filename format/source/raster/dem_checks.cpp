#include "format/source/raster/dem_checks.h"

#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <string_view>

#include "format/source/raster/gdal/gdal_open.h"
#include "format/source/raster/vertical_system.h"

namespace gigabake {
namespace {

/// Rejects depths, which height_scale turns into heights.
void expect_no_depths(const DemOptions& options, GDALDataset& dataset) {
  const std::optional<VerticalSystem> vertical = vertical_system_of(options, dataset);
  if (vertical && vertical->is_depth && !options.height_scale)
    throw InputError(options.dem, "height_scale",
                     "the raster's heights are depths below " + in_quotes(vertical->name) +
                         "; set -1 in the scene file (a foot: -0.3048)");
}

constexpr double us_survey_foot_m = 1200.0 / 3937, foot_m = 0.3048;

bool is_foot(double unit_m) { return std::fabs(unit_m - foot_m) < 1e-5; }

/// Returns a unit's name in lower case, without '.', '_' and spaces.
std::string letters_of(std::string_view unit) {
  std::string out;
  for (const char c : unit)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) out += char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Returns letters_of() of a unit, without the "s" of a plural.
std::string plain_unit(std::string_view unit) {
  std::string out = letters_of(unit);
  if (out.size() > 2 && out.back() == 's') out.pop_back();
  return out;
}

/// Returns the metres of a unit; nullopt if the name is unknown or is "foot", which is ambiguous.
/// Source  Spellings of GDAL's drivers, EPSG, ESRI and UDUNITS.
std::optional<double> metres_of(std::string_view unit) {
  static const std::map<std::string_view, double> units{
      {"m", 1},
      {"meter", 1},
      {"metre", 1},
      {"mtr", 1},
      {"metro", 1},
      {"meterabovesealevel", 1},
      {"metreabovesealevel", 1},
      {"mabovemsl", 1},
      {"masl", 1},
      {"dm", 0.1},
      {"decimeter", 0.1},
      {"decimetre", 0.1},
      {"cm", 0.01},
      {"centimeter", 0.01},
      {"centimetre", 0.01},
      {"mm", 0.001},
      {"millimeter", 0.001},
      {"millimetre", 0.001},
      {"km", 1000},
      {"kilometer", 1000},
      {"kilometre", 1000},
      {"internationalfoot", foot_m},
      {"internationalfeet", foot_m},
      {"ussurveyfoot", us_survey_foot_m},
      {"ussurveyfeet", us_survey_foot_m},
      {"usfoot", us_survey_foot_m},
      {"usfeet", us_survey_foot_m},
      {"usft", us_survey_foot_m},
      {"ftus", us_survey_foot_m},
      {"footus", us_survey_foot_m},
      {"footussurvey", us_survey_foot_m},
      {"surveyfoot", us_survey_foot_m},
      {"surveyfeet", us_survey_foot_m},
  };
  auto at = units.find(letters_of(unit));  // "ftus" is no plural
  if (at == units.end()) at = units.find(plain_unit(unit));
  return at == units.end() ? std::nullopt : std::optional(at->second);
}

bool names_a_foot(std::string_view unit) {
  const std::string name = plain_unit(unit);
  return name == "ft" || name == "foot" || name == "feet";
}

/// Adds a warning if the horizontal unit is not the metre and no unit of heights is declared. Such rasters may have
/// heights in either unit.
void check_unit(const DemOptions& options, GDALDataset& dataset, std::vector<std::string>& warnings) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const double scale = height_scale_of(options, dataset);
  const auto crs = whole_crs_of(options, dataset);
  if (!crs || (crs->IsProjected() == 0 && crs->IsLocal() == 0) || *band.GetUnitType() != 0 || options.height_scale)
    return;
  const char* unit = nullptr;
  const double unit_m = crs->GetTargetLinearUnits(nullptr, &unit);
  if (std::fabs(unit_m - 1) < 1e-9 || std::fabs(scale - 1) > 1e-9) return;
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

/// Returns the name of the encoding if heights are packed into colours; else an empty text. The range of red, the most
/// significant byte of a height, identifies the encoding.
/// Source  Mapbox Terrain-RGB v1: -10000 m + (65536 R + 256 G + B) · 0.1 m; Terrarium: 256 R + G + B / 256 - 32768 m.
std::string encoding_of(GDALDataset& dataset) {
  constexpr int edge = 64;
  std::array<unsigned char, std::size_t(edge) * edge> red{};
  if (dataset.GetRasterBand(1)->RasterIO(GF_Read, 0, 0, dataset.GetRasterXSize(), dataset.GetRasterYSize(), red.data(),
                                         edge, edge, GDT_Byte, 0, 0) != CE_None)
    return "";
  const auto [minimum, greatest] = std::minmax_element(red.begin(), red.end());
  if (*greatest <= 2 && *greatest > 0) return "Mapbox Terrain-RGB";
  return *minimum >= 124 && *greatest <= 163 && *greatest - *minimum <= 16 ? "Terrarium" : "";
}

[[noreturn]] void refuse_image(const DemOptions& options, GDALDataset& dataset, const std::string& what) {
  const std::string encoding = bands_without_alpha(dataset) >= 3 ? encoding_of(dataset) : "";
  if (!encoding.empty())
    throw InputError(options.dem, "dem",
                     "looks like elevation packed into colours (" + encoding +
                         "); decode it to heights in metres first, for example with gdal_calc.py");
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
    throw InputError(options.dem, "dem", "the scale of its heights is 0, or their scale or offset is not finite");
  if (bands > 1)
    warnings.push_back("has " + std::to_string(bands) + " bands; heights are read from the first band (" +
                       (*band.GetDescription() != 0 ? in_quotes(band.GetDescription()) : "without a name") +
                       "), the others are not used");
  const char* kind = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  if (type == GDT_Byte && kind == nullptr && scale == 1 && !options.height_scale)
    warnings.push_back(
        "has 8-bit heights, taken as whole metres from 0 to 255; set height_scale in a scene .json to "
        "the metres of one step (1: they are metres)");
}

}  // namespace

GDALRasterBand* validity_band(GDALDataset& dataset) {
  for (int i = 2; i <= dataset.GetRasterCount(); ++i)
    if (is_alpha(*dataset.GetRasterBand(i))) return dataset.GetRasterBand(i);
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  // A nodata value of a single band is no mask: take_heights() compares heights with it. Nodata of all bands is a mask.
  const int flags = band.GetMaskFlags();
  return flags == GMF_NODATA || (flags & GMF_ALL_VALID) != 0 ? nullptr : band.GetMaskBand();
}

double height_scale_of(const DemOptions& options, GDALDataset& dataset) {
  if (options.height_scale) return *options.height_scale;
  const std::string unit = dataset.GetRasterBand(1)->GetUnitType();
  const std::optional<double> metres = metres_of(unit);
  if (metres) return *metres;
  const std::optional<VerticalSystem> vertical = vertical_system_of(options, dataset);
  if (plain_unit(unit).empty()) return vertical ? vertical->unit_m : 1;
  if (vertical && names_a_foot(unit) && is_foot(vertical->unit_m)) return vertical->unit_m;
  throw InputError(options.dem, "height_scale",
                   "the raster's heights are in " + in_quotes(unit) +
                       "; set the metres per unit in the scene file (a foot: 0.3048, a US-survey foot: 0.3048006096)");
}

std::vector<std::string> check_dem(const DemOptions& options, GDALDataset& dataset) {
  std::vector<std::string> warnings = side_file_warnings(options.dem);
  check_bands(options, dataset, warnings);
  expect_no_depths(options, dataset);
  check_unit(options, dataset, warnings);
  return warnings;
}

}  // namespace gigabake
