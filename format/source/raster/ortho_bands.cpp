#include "format/source/raster/ortho_bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/base/error.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

/// The min fraction of the 16-bit range that samples must reach; else the range of the image is unknown.
constexpr double min_used_fraction = 0.25;
constexpr const char* to_bytes_hint = "convert them with gdal_translate -ot Byte -scale MIN MAX 0 255 IN.tif OUT.tif";

bool is_signed_byte(GDALRasterBand& band) {
  const char* kind = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  return kind != nullptr && EQUAL(kind, "SIGNEDBYTE");
}

/// Returns the number of bits that the numbers of a band use.
int bits_of(GDALRasterBand& band) {
  const int type_bits = GDALGetDataTypeSizeBits(band.GetRasterDataType());
  const char* text = band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE");
  const int bits = text != nullptr ? std::atoi(text) : type_bits;
  return bits >= 1 && bits <= type_bits ? bits : type_bits;
}

bool is_other_colour(GDALColorInterp colour) {
  return colour >= GCI_HueBand &&
         colour <= GCI_YCbCr_CrBand;  // includes saturation, lightness, cyan, magenta, yellow, black
}

/// Returns the maximum of a sample of pixels; 0 if they cannot be read.
double sampled_maximum(GDALRasterBand& band) {
  constexpr int edge = 64;
  std::vector<double> sample(std::size_t(edge) * edge, 0);
  const int width = std::min(edge, band.GetXSize()), height = std::min(edge, band.GetYSize());
  int has_nodata = 0;
  const double nodata = band.GetNoDataValue(&has_nodata);
  if (band.RasterIO(GF_Read, 0, 0, band.GetXSize(), band.GetYSize(), sample.data(), width, height, GDT_Float64, 0, 0) !=
      CE_None)
    return 0;
  double greatest = 0;
  for (const double v : sample)
    if (has_nodata == 0 || v != nodata) greatest = std::max(greatest, v);
  return greatest;
}

void expect_colour_numbers(const Path& file, GDALRasterBand& band) {
  const GDALDataType type = band.GetRasterDataType();
  if ((type == GDT_Byte || type == GDT_UInt16) && !is_signed_byte(band)) return;
  throw InputError(file, "ortho",
                   std::string("its numbers are ") +
                       (is_signed_byte(band) ? "signed bytes" : GDALGetDataTypeName(type)) +
                       ", whose range of colours is unknown; " + to_bytes_hint);
}

/// Sets the range of the colours to 0 … 2^n - 1 for the n bits that the file declares.
void set_range(const Path& file, GDALDataset& dataset, OrthoBands& out) {
  int bits = 0;
  double greatest = 0;
  for (const int number : out.colours) {
    GDALRasterBand& band = *dataset.GetRasterBand(number);
    expect_colour_numbers(file, band);
    bits = std::max(bits, bits_of(band));
    if (bits == 16) greatest = std::max(greatest, sampled_maximum(band));
  }
  out.max_value = double((1 << bits) - 1);
  if (bits == 16 && greatest > 0 && greatest < min_used_fraction * out.max_value)
    throw InputError(file, "ortho",
                     "its 16-bit colours reach only " + std::to_string(int(greatest)) +
                         " in a sample, so their range is unknown; " + to_bytes_hint);
}

/// Returns the value of full opacity. Normally all bits of the alpha band are set. Many masks, however,
/// contain only 0 and 1, or 0 and 255 in 16 bits.
double max_alpha_of(GDALRasterBand& band) {
  const double all_bits = std::ldexp(1, bits_of(band)) - 1, greatest = sampled_maximum(band);
  if (greatest == 1) return 1;
  return greatest > 0 && greatest <= 255 ? std::min(all_bits, 255.0) : all_bits;
}

std::string names_of(GDALDataset& dataset, const std::vector<int>& bands) {
  std::string out;
  for (const int number : bands) {
    GDALRasterBand& band = *dataset.GetRasterBand(number);
    const std::string name = *band.GetDescription() != 0
                                 ? band.GetDescription()
                                 : GDALGetColorInterpretationName(band.GetColorInterpretation());
    out += (out.empty() ? "" : ", ") + std::to_string(number) + " (" + as_line(name, max_quote_bytes) + ")";
  }
  return out;
}

/// Bands of a raster by their colour interpretation.
struct Interpreted {
  std::array<int, 3> rgb{};
  int alpha = 0;
  std::vector<int> others;  ///< all except the alpha band

  Interpreted(const Path& file, GDALDataset& dataset) {
    for (int number = 1; number <= dataset.GetRasterCount(); ++number) {
      const GDALColorInterp colour = dataset.GetRasterBand(number)->GetColorInterpretation();
      if (is_other_colour(colour))
        throw InputError(file, "ortho",
                         std::string("its colours are not red, green and blue (band ") + std::to_string(number) +
                             " is " + GDALGetColorInterpretationName(colour) + "); convert it to an RGB GeoTIFF");
      if (colour == GCI_AlphaBand && alpha == 0) {
        alpha = number;
        continue;
      }
      others.push_back(number);
      const int place = colour - GCI_RedBand;
      if (place >= 0 && place < 3 && rgb[std::size_t(place)] == 0) rgb[std::size_t(place)] = number;
    }
  }
  bool has_rgb() const { return rgb[0] != 0 && rgb[1] != 0 && rgb[2] != 0; }

  /// Returns the bands of red, green and blue. A colour that no band states is assigned to the first unassigned band.
  std::vector<int> completed_rgb() const {
    std::vector<int> out(rgb.begin(), rgb.end());
    for (const int number : others) {
      const auto missing = std::find(out.begin(), out.end(), 0);
      if (missing != out.end() && std::find(out.begin(), out.end(), number) == out.end()) *missing = number;
    }
    return out;
  }
};

void add_band_warnings(GDALDataset& dataset, const Interpreted& bands, OrthoBands& out) {
  std::vector<int> unused;
  for (const int number : bands.others)
    if (std::find(out.colours.begin(), out.colours.end(), number) == out.colours.end()) unused.push_back(number);
  if (unused.size() > 8) unused.resize(8);
  if (!unused.empty())
    out.warnings.push_back("bands of the orthophoto that are not used: " + names_of(dataset, unused));
  if (out.colours.size() == 3 && !bands.has_rgb())
    out.warnings.push_back("the orthophoto does not state which of its bands are red, green and blue: taken as bands " +
                           names_of(dataset, out.colours));
}

}  // namespace

OrthoBands ortho_bands(const Path& file, GDALDataset& dataset) {
  OrthoBands out;
  const Interpreted bands(file, dataset);
  if (bands.others.empty()) throw InputError(file, "ortho", "has no colours, only an alpha band");
  out.alpha = bands.alpha;
  if (out.alpha != 0) out.max_alpha = max_alpha_of(*dataset.GetRasterBand(out.alpha));
  GDALRasterBand& first = *dataset.GetRasterBand(bands.others[0]);
  if (const GDALColorTable* table = first.GetColorTable();
      table != nullptr && (bands.others.size() == 1 || first.GetColorInterpretation() == GCI_PaletteIndex)) {
    if (table->GetPaletteInterpretation() != GPI_RGB && table->GetPaletteInterpretation() != GPI_Gray)
      throw InputError(file, "ortho", "its palette is not of red, green and blue; convert it to an RGB GeoTIFF");
    expect_colour_numbers(file, first);
    out.is_palette = true;
    out.colours = {bands.others[0]};
  } else {
    if (bands.others.size() >= 3)
      out.colours = bands.completed_rgb();
    else
      out.colours = {bands.others[0]};
    set_range(file, dataset, out);
    const char* white = dataset.GetMetadataItem("MINISWHITE", "IMAGE_STRUCTURE");
    out.is_inverted = out.colours.size() == 1 && white != nullptr && EQUAL(white, "YES");
  }
  add_band_warnings(dataset, bands, out);
  return out;
}

}  // namespace gigabake
