#include "format/source/earth_centred.h"

#include <cmath>
#include <fmt/format.h>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/math/transform.h"
#include "format/source/content/content_container.h"
#include "format/source/content/content_pieces.h"
#include "format/source/gltf/bounds.h"
#include "format/source/mesh/obj_read.h"
#include "format/source/mesh/ply_read.h"
#include "format/source/mesh/stl_read.h"
#include "format/source/origin_check.h"

namespace gigabake {
namespace {

constexpr double max_half_diagonal_m = 1e6, highest_m = 20e3;
constexpr double lowest_ground_m = -1000, highest_ground_m = 9000;
/// Bytes that are read from the beginning of an OBJ, PLY or STL. Their vertices show whether all vertices must be read.
constexpr std::uint64_t first_read_bytes = std::uint64_t(1) << 18;

/// Returns whether the format has a convention for the up axis.
bool has_convention(ContentKind kind) {
  return kind != ContentKind::obj && kind != ContentKind::ply && kind != ContentKind::stl;
}

Point<Ecef> ecef(const Point<World>& p) { return {p.x, p.y, p.z}; }

WorldBox bounds_of(const TileMesh& mesh) {
  WorldBox out;
  for (const Instance& instance : mesh.instances) {
    const std::vector<float>& p = mesh.primitives[std::size_t(instance.primitive)].position;
    for (std::size_t v = 0; v + 2 < p.size(); v += 3) {
      const Point<Scene> at = instance.scene_from_local({p[v], p[v + 1], p[v + 2]});
      out.add({at.x, at.y, at.z});
    }
  }
  return out;
}

WorldBox bounds_of_instances(const TileRef& tile, const SourceFiles& files) {
  const ContentContainer container = open_container(tile, files);
  const auto& rtc = container.rtc_center;
  WorldBox out;
  for (const Affine<World, World>& instance : container.instances)
    out.add({rtc[0] + instance.m[0][3], rtc[1] + instance.m[1][3], rtc[2] + instance.m[2][3]});
  return out;
}

std::vector<Point<Local>> first_vertices(const TileRef& tile, const std::filesystem::path& root) {
  ContentPieces pieces(tile, SourceFiles(root));
  const std::vector<std::uint8_t> head = pieces.read(0, first_read_bytes);
  if (tile.kind == ContentKind::ply) return first_ply_vertices(tile.path, head);
  if (tile.kind == ContentKind::stl) return first_stl_vertices(tile.path, head, tile.bytes);
  return first_obj_vertices(tile.path, head);
}

/// Returns the bounds of all vertices, z up; empty bounds if none of the first vertices is near the earth's surface.
WorldBox bounds_of_plain_mesh(const TileRef& tile, const std::filesystem::path& root) {
  bool is_near = false;
  for (const Point<Local>& p : first_vertices(tile, root)) {
    WorldBox one;
    one.add(z_up_from<World, Local>(tile.gltf_up)(p));
    is_near |= earth_fit(one) != EarthFit::none;
  }
  return is_near ? vertex_bounds(tile, root) : WorldBox();
}

/// Bounds of one file and their classification.
struct Found {
  EarthFit fit = EarthFit::none;
  WorldBox bounds;
  bool is_known = false;
};

Found classify_file(const TileRef& tile, const std::filesystem::path& root) {
  Found out;
  try {
    out.bounds = has_convention(tile.kind) ? stated_bounds(tile, SourceFiles(root)) : bounds_of_plain_mesh(tile, root);
    out.is_known = !has_convention(tile.kind) || !out.bounds.is_empty;
    out.fit = earth_fit(out.bounds);
  } catch (const std::exception&) {
    return {};  // the scan reads the file too and reports the fault
  }
  return out;
}

/// Returns the name of the first tile and the number of the others.
std::string some(const SceneSources& sources, const std::vector<std::size_t>& tiles) {
  const std::string& first = sources.tiles[tiles[0]].name;
  return tiles.size() == 1 ? first : fmt::format("{} and {} more", first, tiles.size() - 1);
}

/// Indices of tiles, grouped by the classification of their bounds.
struct Sorted {
  std::vector<std::size_t> surface, or_projected, none;
  WorldBox bounds;  ///< of all tiles that may be on the earth
};

Sorted sorted(const SceneSources& sources, const std::optional<UpAxis>& up) {
  Sorted out;
  for (std::size_t i = 0; i < sources.tiles.size(); ++i) {
    TileRef tile = sources.tiles[i];
    if (!has_convention(tile.kind)) tile.gltf_up = up.value_or(UpAxis::z);
    const Found found = classify_file(tile, sources.root);
    if (!found.is_known) continue;
    if (found.fit == EarthFit::none) {
      out.none.push_back(i);
      continue;
    }
    (found.fit == EarthFit::surface ? out.surface : out.or_projected).push_back(i);
    out.bounds.join(found.bounds);
  }
  return out;
}

}  // namespace

WorldBox stated_bounds(const TileRef& tile, const SourceFiles& files) {
  return tile.kind == ContentKind::i3dm ? bounds_of_instances(tile, files) : gltf_bounds(tile, files);
}

WorldBox vertex_bounds(const TileRef& tile, const std::filesystem::path& root) {
  return bounds_of(read_tile(tile, root, ReadScope::positions_only));
}

EarthFit earth_fit(const WorldBox& bounds) {
  if (bounds.is_empty || !(bounds.half_diagonal() < max_half_diagonal_m)) return EarthFit::none;
  const Point<Ecef> centre = ecef(bounds.centre());
  if (!is_on_earth(centre, bounds.half_diagonal()) || geodetic_of(centre).height_m > highest_m) return EarthFit::none;
  const auto may_be_heights = [&](std::size_t axis) {
    return bounds.low[axis] >= lowest_ground_m && bounds.high[axis] <= highest_ground_m;
  };
  return may_be_heights(2) || (may_be_heights(1) && centre.z < 0) ? EarthFit::or_projected : EarthFit::surface;
}

void place_on_earth(const SourceOptions& options, SceneSources& sources) {
  const Sorted found = sorted(sources, options.scene_up);
  if (found.surface.empty()) {
    if (!found.or_projected.empty() && !options.local)
      sources.notes.push_back(fmt::format(
          "warning: {} may hold projected coordinates, or earth-centred ones at the equator; taken as a local frame. A "
          "tileset.json that refers to it places it on the earth",
          some(sources, found.or_projected)));
    return;
  }
  if (options.local) {
    sources.notes.push_back(
        fmt::format("warning: {} holds earth-centred coordinates; in a local frame (`local`, or a place in a scene "
                    ".json) they are tilted and some 6,400 km away",
                    some(sources, found.surface)));
    return;
  }
  if (!found.none.empty())
    throw InputError(sources.root, "",
                     fmt::format("{} holds earth-centred coordinates and {} does not; list them in a scene .json, the "
                                 "latter with a lon_lat_height",
                                 some(sources, found.surface), some(sources, found.none)));
  const Geodetic place = geodetic_of(ecef(found.bounds.centre()));
  if (!sources.origin) sources.origin = place;
  if (auto warning = far_origin_warning(*sources.origin, {place})) sources.notes.push_back(std::move(*warning));
  for (TileRef& tile : sources.tiles) {
    tile.scene_from_tile.m = scene_from_ecef(*sources.origin).m;
    if (!has_convention(tile.kind)) tile.gltf_up = options.scene_up.value_or(UpAxis::z);
  }
  sources.notes.push_back(some(sources, found.surface) + ": earth-centred coordinates, placed on the earth");
}

}  // namespace gigabake
