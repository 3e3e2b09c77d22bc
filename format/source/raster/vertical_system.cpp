#include "format/source/raster/vertical_system.h"

#include <string_view>

namespace gigabake {
namespace {

constexpr int egm96_height = 5773;

std::optional<VerticalSystem> vertical_part(const OGRSpatialReference& crs) {
  if (crs.IsVertical() == 0) return std::nullopt;
  VerticalSystem out;
  const char* name = crs.GetAttrValue("VERT_CS");
  if (name == nullptr) name = crs.GetName();
  out.name = name != nullptr ? name : "unnamed";
  out.unit_m = crs.GetTargetLinearUnits("VERT_CS");
  OGRAxisOrientation up = OAO_Up;
  crs.GetAxis("VERT_CS", 0, &up);
  out.is_depth = up == OAO_Down;
  return out;
}

/// Returns the third axis of a geographic or projected system with three axes.
std::optional<VerticalSystem> third_axis(const OGRSpatialReference& crs) {
  constexpr int third = 2;
  if (crs.IsGeocentric() != 0 || crs.IsVertical() != 0 || crs.GetAxesCount() <= third) return std::nullopt;
  VerticalSystem out;
  OGRAxisOrientation up = OAO_Up;
  double unit_m = 1;
  if (crs.GetAxis(nullptr, third, &up, &unit_m) == nullptr) return std::nullopt;
  const char* name = crs.GetName();
  out.name = name != nullptr ? name : "unnamed";
  if (unit_m > 0) out.unit_m = unit_m;
  out.is_depth = up == OAO_Down;
  out.is_ellipsoidal = true;
  return out;
}

/// Returns the vertical part of a compound system as a separate system.
std::optional<OGRSpatialReference> vertical_alone(const OGRSpatialReference& crs) {
  const OGR_SRSNode* node = crs.GetAttrNode("VERT_CS");
  char* text = nullptr;
  if (node == nullptr || node->exportToWkt(&text) != OGRERR_NONE) return std::nullopt;
  OGRSpatialReference out;
  const bool is_read = out.importFromWkt(text) == OGRERR_NONE;
  CPLFree(text);
  return is_read ? std::optional(out) : std::nullopt;
}

std::optional<OGRSpatialReference> compound(const std::optional<OGRSpatialReference>& horizontal,
                                            const std::optional<OGRSpatialReference>& vertical) {
  OGRSpatialReference out;
  if (!horizontal || !vertical || horizontal->GetAxesCount() > 2) return std::nullopt;
  if (out.SetCompoundCS("compound", &*horizontal, &*vertical) != OGRERR_NONE) return std::nullopt;
  return out;
}

std::optional<VerticalSystem> system_of_whole(const std::optional<OGRSpatialReference>& whole) {
  if (!whole) return std::nullopt;
  std::optional<VerticalSystem> out = vertical_part(*whole);
  if (!out) out = third_axis(*whole);
  if (out && (out->is_ellipsoidal || whole->IsCompound() != 0)) out->whole = *whole;
  return out;
}

std::optional<VerticalSystem> system_of_file(const DemOptions& options, GDALDataset& dataset) {
  if (const OGRSpatialReference* own = plain_crs_of(dataset)) {
    std::optional<VerticalSystem> out = system_of_whole(*own);
    if (out && !options.crs.empty()) out->whole.reset();
    if (out && !out->is_ellipsoidal && !out->whole)
      out->whole = compound(crs_of(options, dataset), vertical_alone(*own));
    if (out) return out;
  }
  if (std::string_view(dataset.GetDriver()->GetDescription()) != "SRTMHGT") return std::nullopt;
  OGRSpatialReference egm96;
  egm96.importFromEPSG(egm96_height);
  return VerticalSystem{"EGM96 height", 1, false, false, compound(crs_of(options, dataset), egm96)};
}

}  // namespace

std::optional<VerticalSystem> vertical_system_of(const DemOptions& options, GDALDataset& dataset) {
  std::optional<VerticalSystem> out;
  if (!options.crs.empty()) out = system_of_whole(whole_crs_of(options, dataset));
  if (!out) out = system_of_file(options, dataset);
  if (out && out->whole) out->whole->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return out;
}

}  // namespace gigabake
