#include "format/source/raster/proj_operations.h"

#include <algorithm>
#include <cpl_conv.h>
#include <memory>
#include <proj.h>

#include "core/base/error.h"
#include "format/source/raster/proj_files.h"

namespace gigabake {
namespace {

template <auto release>
struct Release {
  template <class T>
  void operator()(T* value) const {
    release(value);
  }
};
using ProjContext = std::unique_ptr<PJ_CONTEXT, Release<proj_context_destroy>>;
using Object = std::unique_ptr<PJ, Release<proj_destroy>>;
using ObjectList = std::unique_ptr<PJ_OBJ_LIST, Release<proj_list_destroy>>;
using Factory = std::unique_ptr<PJ_OPERATION_FACTORY_CONTEXT, Release<proj_operation_factory_context_destroy>>;

struct ProjGrid {
  std::string name, url;
  std::filesystem::path file;
  bool is_installed = false;
};

struct ProjOperation {
  std::vector<ProjGrid> grids;
  double accuracy_m = -1;
};

Object object_of(PJ_CONTEXT* context, const OGRSpatialReference& crs) {
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  char* text = nullptr;
  crs.exportToWkt(&text, options);
  Object out(text != nullptr ? proj_create(context, text) : nullptr);
  CPLFree(text);
  return out;
}

ProjOperation operation_of(PJ_CONTEXT* context, const PJ* object) {
  ProjOperation out;
  out.accuracy_m = proj_coordoperation_get_accuracy(context, object);
  for (int i = 0; i < proj_coordoperation_get_grid_used_count(context, object); ++i) {
    const char *name = nullptr, *file = nullptr, *package = nullptr, *url = nullptr;
    int is_direct = 0, is_open = 0, is_installed = 0;
    if (proj_coordoperation_get_grid_used(context, object, i, &name, &file, &package, &url, &is_direct, &is_open,
                                          &is_installed) == 0)
      continue;
    const auto text = [](const char* value) { return std::string(value != nullptr ? value : ""); };
    out.grids.push_back({text(name), text(url), text(file), is_installed != 0});
  }
  return out;
}

/// Returns the transformations in PROJ's order of preference, without ballpark transformations.
std::vector<ProjOperation> operations(const OGRSpatialReference& from, const OGRSpatialReference& to,
                                      const std::optional<LonLatBounds>& area, PROJ_GRID_AVAILABILITY_USE use) {
  const ProjContext context(proj_context_create());
  confine_files(context.get());
  proj_log_level(context.get(), PJ_LOG_NONE);
  const Object source = object_of(context.get(), from), target = object_of(context.get(), to);
  const Factory factory(proj_create_operation_factory_context(context.get(), nullptr));
  if (!source || !target || !factory) return {};
  proj_operation_factory_context_set_allow_ballpark_transformations(context.get(), factory.get(), 0);
  proj_operation_factory_context_set_grid_availability_use(context.get(), factory.get(), use);
  proj_operation_factory_context_set_spatial_criterion(context.get(), factory.get(),
                                                       PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  if (area)
    proj_operation_factory_context_set_area_of_interest(context.get(), factory.get(), (*area)[0], (*area)[1],
                                                        (*area)[2], (*area)[3]);
  const ObjectList list(proj_create_operations(context.get(), source.get(), target.get(), factory.get()));
  std::vector<ProjOperation> out;
  for (int i = 0; list && i < proj_list_get_count(list.get()); ++i) {
    const Object object(proj_list_get(context.get(), list.get(), i));
    if (object) out.push_back(operation_of(context.get(), object.get()));
  }
  return out;
}

/// Returns how hard a transformation is to install: the number of missing grids, and whether their origin is unknown.
std::pair<std::size_t, bool> effort(const ProjOperation& operation) {
  std::pair<std::size_t, bool> out{0, false};
  for (const ProjGrid& grid : operation.grids)
    if (!grid.is_installed) ++out.first, out.second |= grid.url.empty();
  return out;
}

/// Returns the place from which a grid can be installed.
std::string origin_of(const ProjGrid& grid) {
  if (grid.name.find("egm96_15") != std::string::npos) return "the Debian package proj-data has it as egm96_15.gtx";
  if (grid.url.empty()) return "PROJ names no source of it; see https://cdn.proj.org";
  return "projsync of the Debian package proj-bin downloads it from " + grid.url;
}

}  // namespace

std::optional<UsedTransformation> used_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to,
                                                      const LonLatBounds& area) {
  const auto found = operations(from, to, area, PROJ_GRID_AVAILABILITY_DISCARD_OPERATION_IF_MISSING_GRID);
  if (found.empty()) return std::nullopt;
  UsedTransformation out;
  out.accuracy_m = found[0].accuracy_m;
  for (const ProjGrid& grid : found[0].grids)
    if (!grid.file.empty()) out.grids.push_back(grid.file);
  return out;
}

std::string why_no_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to,
                                  const std::optional<LonLatBounds>& area) {
  const std::vector<ProjOperation> known = operations(from, to, area, PROJ_GRID_AVAILABILITY_IGNORED);
  // PROJ prefers accuracy; the user prefers the transformation that is easiest to install.
  const auto best = std::min_element(
      known.begin(), known.end(), [](const ProjOperation& a, const ProjOperation& b) { return effort(a) < effort(b); });
  if (best == known.end()) return "has no transformation to the WGS84 ellipsoid in PROJ";
  std::string out;
  for (const ProjGrid& grid : best->grids)
    if (!grid.is_installed)
      out += (out.empty() ? "needs the grid " : ", and the grid ") + in_quotes(grid.name) + ", which is missing (" +
             origin_of(grid) + ")";
  return out.empty() ? "has no transformation to the WGS84 ellipsoid there" : out;
}

}  // namespace gigabake
