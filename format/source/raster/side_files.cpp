#include <algorithm>
#include <array>
#include <cctype>
#include <cpl_minixml.h>
#include <set>
#include <string_view>

#include "core/base/error.h"
#include "format/source/raster/gdal/gdal_open.h"
#include "format/source/raster/gdal_raster.h"
#include "format/system/path_within.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

constexpr std::uintmax_t max_xml_bytes = std::uintmax_t(1) << 26;
constexpr int max_vrt_depth = 8;

struct DestroyXml {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};
using Xml = std::unique_ptr<CPLXMLNode, DestroyXml>;

std::string in_case(std::string text, int (*change)(int)) {
  std::transform(text.begin(), text.end(), text.begin(), [&](unsigned char c) { return char(change(c)); });
  return text;
}

/// Returns the names that GDAL uses for side files of a raster, in upper and lower case.
std::set<std::string> side_file_names(const Path& file) {
  const std::string name = file.filename().string(), stem = file.stem().string();
  const std::string extension =
      file.extension().string().substr(std::min<std::size_t>(1, file.extension().string().size()));
  std::vector<std::string> of_stem{"prj", "tab", "wld"};
  if (!extension.empty()) {
    of_stem.push_back(extension + "w");
    of_stem.push_back({extension.front(), extension.back(), 'w'});
  }
  std::set<std::string> names{name + ".aux.xml", name + ".AUX.XML"};
  for (int (*change)(int) : {+[](int c) { return std::tolower(c); }, +[](int c) { return std::toupper(c); }}) {
    for (const char* side : {"msk", "ovr"}) names.insert(name + "." + in_case(side, change));
    for (const std::string& side : of_stem) names.insert(stem + "." + in_case(side, change));
  }
  return names;
}

/// Returns whether a file is a regular file that is no link to another folder.
bool is_in_its_folder(const Path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  const Path folder = file.has_parent_path() ? file.parent_path() : Path(".");
  return std::filesystem::canonical(file, error).parent_path() == std::filesystem::canonical(folder, error) && !error;
}

/// Returns whether the metadata of a domain contain names of files that GDAL opens.
bool leads_to_files(const char* domain) {
  return domain != nullptr && (EQUAL(domain, "OVERVIEWS") || EQUAL(domain, "GEOLOCATION"));
}

void expect_no_file_names(const Path& file, const CPLXMLNode* node) {
  for (; node != nullptr; node = node->psNext) {
    if (node->eType == CXT_Element && EQUAL(node->pszValue, "Metadata")) {
      const char* domain = CPLGetXMLValue(node, "domain", "");
      if (leads_to_files(domain))
        throw InputError(file, "", "names other files (metadata of " + in_quotes(domain) + "); delete these metadata");
    }
    expect_no_file_names(file, node->psChild);
  }
}

Xml xml_of(const Path& file) {
  std::error_code error;
  if (std::filesystem::file_size(file, error) > max_xml_bytes || error) return nullptr;
  const QuietErrors quiet;
  return Xml(CPLParseXMLFile(file.c_str()));
}

/// Returns whether the file is an XML side file of GDAL.
/// Errors  InputError: the file names other files.
bool is_safe_aux_xml(const Path& file) {
  const Xml xml = xml_of(file);
  if (!xml || CPLGetXMLNode(xml.get(), "=PAMDataset") == nullptr) return false;
  expect_no_file_names(file, xml.get());
  return true;
}

/// Returns whether a mask or overview file is a TIFF that refers to no other file.
bool is_safe_tiff(const Path& file) {
  static const char* const driver[] = {"GTiff", nullptr};
  const std::string name = file.filename().string();
  const char* const only_itself[] = {name.c_str(), nullptr};
  const QuietErrors quiet;
  const Dataset tiff(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, driver, nullptr, only_itself));
  return tiff && tiff->GetMetadataItem("OVERVIEW_FILE", "OVERVIEWS") == nullptr;
}

bool is_safe(const Path& side) {
  const std::string extension = in_case(side.extension().string(), [](int c) { return std::tolower(c); });
  if (extension == ".xml") return is_safe_aux_xml(side);
  if (extension == ".ovr") return is_safe_tiff(side);  // an unsafe overview can be omitted: heights do not depend on it
  if (extension == ".msk" && !is_safe_tiff(side))
    throw InputError(side, "",
                     "is not a TIFF, which the mask of a raster must be; delete it, or write it with GDAL again");
  return true;
}

bool is_known_element(std::string_view name) {
  static const std::set<std::string_view> known{"?xml",
                                                "VRTDataset",
                                                "SRS",
                                                "GeoTransform",
                                                "Metadata",
                                                "MDI",
                                                "GCPList",
                                                "GCP",
                                                "VRTRasterBand",
                                                "ColorInterp",
                                                "NoDataValue",
                                                "ColorTable",
                                                "Entry",
                                                "Description",
                                                "UnitType",
                                                "Offset",
                                                "Scale",
                                                "CategoryNames",
                                                "Category",
                                                "Histograms",
                                                "HistItem",
                                                "HistMin",
                                                "HistMax",
                                                "BucketCount",
                                                "IncludeOutOfRange",
                                                "Approximate",
                                                "HistCounts",
                                                "SimpleSource",
                                                "ComplexSource",
                                                "AveragedSource",
                                                "SourceFilename",
                                                "SourceBand",
                                                "SourceProperties",
                                                "SrcRect",
                                                "DstRect",
                                                "NODATA",
                                                "ScaleOffset",
                                                "ScaleRatio",
                                                "LUT",
                                                "ColorTableComponent",
                                                "UseMaskBand",
                                                "MaskBand",
                                                "HideNoDataValue",
                                                "BlockXSize",
                                                "BlockYSize",
                                                "OverviewList",
                                                "Exponent",
                                                "SrcMin",
                                                "SrcMax",
                                                "DstMin",
                                                "DstMax",
                                                "Clamp"};
  return known.contains(name);
}

class VrtCheck {
 public:
  VrtCheck(const Path& vrt, const char* key, int depth) : vrt_(vrt), key_(key), depth_(depth) {}

  void run() {
    if (depth_ > max_vrt_depth) fail("nests more than 8 VRTs");
    const Xml xml = xml_of(vrt_);
    if (!xml) fail("is not a readable VRT" + QuietErrors::last());
    check(xml.get());
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(vrt_, key_, message); }

  void check(const CPLXMLNode* node) {
    for (; node != nullptr; node = node->psNext) {
      if (node->eType == CXT_Attribute && EQUAL(node->pszValue, "subClass") &&
          !EQUAL(node->psChild->pszValue, "VRTSourcedRasterBand"))
        fail("is a VRT of the subclass " + in_quotes(node->psChild->pszValue) +
             ", which is not read; use gdal_translate to write a GeoTIFF");
      if (node->eType == CXT_Element) check_element(*node);
      check(node->psChild);
    }
  }

  void check_element(const CPLXMLNode& node) {
    if (!is_known_element(node.pszValue))
      fail("is a VRT with " + in_quotes(node.pszValue) + ", which is not read; use gdal_translate to write a GeoTIFF");
    if (EQUAL(node.pszValue, "Metadata") && leads_to_files(CPLGetXMLValue(&node, "domain", "")))
      fail("is a VRT with metadata that name files; use gdal_translate to write a GeoTIFF");
    if (EQUAL(node.pszValue, "SourceFilename")) check_source(node);
  }

  void check_source(const CPLXMLNode& node) {
    const std::string name = CPLGetXMLValue(&node, "", "");
    if (!seen_.insert(name).second) return;
    const Path folder = vrt_.has_parent_path() ? vrt_.parent_path() : Path(".");
    std::error_code error;
    const Path root = std::filesystem::canonical(folder, error);
    const Path file = std::filesystem::weakly_canonical(folder / name, error);
    if (!EQUAL(CPLGetXMLValue(&node, "relativeToVRT", "0"), "1") || !is_within(root, file) ||
        name.find(':') != name.npos)
      fail("names " + in_quotes(name) + ", which is not in the folder of the VRT; move it there, with a relative name");
    if (!std::filesystem::is_regular_file(file, error)) fail("names " + in_quotes(name) + ": no such file");
    expect_safe_source(folder / name);
  }

  /// Throws InputError if a source of a VRT has unsafe side files, because GDAL opens sources with all side files.
  /// Checks the source itself if it is a VRT.
  void expect_safe_source(const Path& source) {
    const std::vector<std::string> safe = safe_side_files(source);
    std::set<std::string> names = side_file_names(source);
    for (const char* auxiliary : {".aux", ".AUX"}) {
      names.insert(source.filename().string() + auxiliary);
      names.insert(source.stem().string() + auxiliary);
    }
    std::error_code error;
    for (const std::string& side : names)
      if (std::filesystem::exists(source.parent_path() / side, error) &&
          std::find(safe.begin(), safe.end(), side) == safe.end())
        throw InputError(source.parent_path() / side, "",
                         "may refer to other files; delete it, or write it with GDAL again");
    std::array<char, 2048> head{};
    if (VSILFILE* file = VSIFOpenL(source.c_str(), "rb")) {
      VSIFReadL(head.data(), 1, head.size() - 1, file);
      VSIFCloseL(file);
    }
    if (std::string_view(head.data(), head.size()).find("<VRTDataset") != std::string_view::npos)
      VrtCheck(source, key_, depth_ + 1).run();
  }

  const Path& vrt_;
  const char* key_;
  int depth_;
  std::set<std::string> seen_;
};

}  // namespace

std::vector<std::string> safe_side_files(const Path& file) {
  std::vector<std::string> out{file.filename().string()};
  for (const std::string& name : side_file_names(file)) {
    const Path side = file.parent_path() / name;
    if (is_in_its_folder(side) && is_safe(side)) out.push_back(name);
  }
  return out;
}

std::vector<std::string> side_file_warnings(const Path& file) {
  const std::vector<std::string> safe = safe_side_files(file);
  std::vector<std::string> out;
  std::error_code error;
  for (const std::string& name : side_file_names(file))
    if (name.ends_with(".aux.xml") && std::filesystem::exists(file.parent_path() / name, error) &&
        std::find(safe.begin(), safe.end(), name) == safe.end())
      out.push_back("its side file " + in_quotes(name) +
                    " is not read: it is damaged, not of GDAL, or a link that leads out of the folder");
  return out;
}

void expect_closed_vrt(const Path& file, const char* key) { VrtCheck(file, key, 0).run(); }

}  // namespace gigabake
