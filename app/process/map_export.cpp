#include "app/process/map_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <malloc.h>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "app/commands.h"
#include "app/messages/with_progress.h"
#include "app/options/flags.h"
#include "app/options/map_crs.h"
#include "app/options/text_values.h"
#include "app/process/clipped_scene.h"
#include "cluster/mpi/collective.h"
#include "cluster/mpi/mpi_export_team.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "core/io/bytes.h"
#include "format/export/geotiff/geotiff.h"
#include "format/system/host_limits.h"
#include "format/system/message.h"
#include "worker/device/backend.h"

namespace gigabake::app {
namespace {

/// The bytes of a ray in a batch, with its pixel and its hit.
constexpr std::uint64_t bytes_per_ray = 1024;

/// Returns the box around all surfaces in scene metres.
std::array<Vec3d, 2> box_of_scene_m(const SceneQuery& query) {
  const SceneHeader& scene = query.scene().header();
  const kernels::VoxelBox& window = query.window();
  Box3i64 box{Vec3i64::from(window.min), Vec3i64::from(window.max)};
  if (const Box3i64 part = intersection(box, scene.bounds); !part.is_empty()) box = part;
  return {scene.lattice_origin_m + Vec3d(box.min) * scene.voxel_size_m,
          scene.lattice_origin_m + Vec3d(box.end) * scene.voxel_size_m};
}

MapBox intersection_of(const MapBox& a, const MapBox& b) {
  return {{std::max(a.low[0], b.low[0]), std::max(a.low[1], b.low[1])},
          {std::min(a.high[0], b.high[0]), std::min(a.high[1], b.high[1])}};
}

MapBox map_box(const FixedPoint& low, const FixedPoint& high) {
  const auto number = [](std::int64_t fixed) { return double(fixed) / fixed_per_unit; };
  return {{number(low.x), number(low.y)}, {number(high.x), number(high.y)}};
}

/// Returns the degrees that contain all polygons.
MapBox box_of(const std::vector<AreaPolygon>& polygons) {
  FixedBox box = polygons.front().bounds();
  for (const AreaPolygon& p : polygons) {
    box.low = {std::min(box.low.x, p.bounds().low.x), std::min(box.low.y, p.bounds().low.y)};
    box.high = {std::max(box.high.x, p.bounds().high.x), std::max(box.high.y, p.bounds().high.y)};
  }
  return map_box(box.low, box.high);
}

/// The pixels of the map, and the area that the surface must be inside of.
struct MapPlace {
  MapGrid grid;
  std::shared_ptr<const AreaInScene> area;
};

double step_of(const MapExport& o, const SceneHeader& scene, const MapFrame& frame) {
  if (o.step != 0) return o.step;
  if (frame.facts().is_in_degrees)
    throw UsageError("--step: is missing; expected the edge of a pixel in degrees, the unit of --crs");
  return std::ldexp(scene.voxel_size_m, o.lod) / frame.facts().metres_per_unit;
}

void expect_classes(const MapExport& o, const SceneHeader& scene) {
  if (o.content == MapContent::classes && !scene.has_classes)
    throw UsageError("--to classes: expected a scene with classes (docs/classes.md); this scene has none");
}

MapPlace place_of(const MapExport& o, const SceneQuery& query, const MapFrame& frame, std::shared_ptr<const Area> all) {
  const SceneHeader& scene = query.scene().header();
  expect_classes(o, scene);
  const double step = step_of(o, scene, frame);
  if (!(step > 0) || !std::isfinite(step)) throw UsageError("--step: expected a number above 0");
  const std::array<Vec3d, 2> corners = box_of_scene_m(query);
  MapBox box = frame.box_of_scene(corners[0], corners[1], step);
  MapPlace place;
  if (!all) return {grid_of(box, step, false), nullptr};
  auto area = std::make_shared<Area>(*all);
  const double base_m = scene.origin ? scene.origin->height_m : 0;
  const std::array<double, 2> heights_m{base_m + corners[0][2], base_m + corners[1][2]};
  if (!area->polygons.empty())
    box = intersection_of(box, frame.box_of_degrees(box_of(area->polygons), heights_m, step));
  bool is_exact = false;
  if (area->bounds) {
    MapBox bounds = map_box(area->bounds->low, area->bounds->high);
    is_exact = area->bounds->frame != AreaFrame::degrees;
    if (!is_exact) bounds = frame.box_of_degrees(bounds, heights_m, step);
    box = intersection_of(box, bounds);
    if (is_exact && !box.is_empty()) box = bounds, area->bounds.reset();
  }
  if (box.is_empty()) throw UsageError("no part of the scene is inside --bounds or --clip");
  place.grid = grid_of(box, step, is_exact);
  if (area->bounds || !area->polygons.empty()) place.area = std::make_shared<const AreaInScene>(area, scene.origin);
  return place;
}

/// Returns the options for the scene's voxels: bounds with heights remove voxels, other bounds only remove pixels.
AreaOptions area_of_voxels(const AreaOptions& all, const Area* area) {
  AreaOptions out;
  if (area == nullptr || !area->bounds || !std::isfinite(area->bounds->height_low_m)) return out;
  out.bounds = all.bounds;
  out.crs = all.crs;
  return out;
}

/// Returns the options of the query with the pixels' centres; empty if queries do not have the coordinate system.
std::string query_text(const MapGrid& grid, const MapFrame& frame) {
  if (!frame.is_scene() && !frame.facts().is_wgs84_degrees) return {};
  // The upper corner lies beyond the last centres by a quarter of a step, so that rounding cannot leave one out.
  const auto last = [&](double first, std::uint32_t count) { return first + (count - 0.75) * grid.step; };
  const double x = grid.x(0), y = grid.y(grid.rows - 1);
  return fmt::format("; gigabake query --grid={},{},{},{} --step {}{}", x, y, last(x, grid.columns), last(y, grid.rows),
                     grid.step, frame.is_scene() ? "" : " --coordinates lonlat");
}

GeotiffImage image_of(const MapExport& o, const MapGrid& grid, const SceneHeader& scene, const MapFrame& frame) {
  GeotiffImage image;
  image.columns = grid.columns, image.rows = grid.rows;
  image.west = grid.west, image.north = grid.north(), image.step = grid.step;
  image.wkt = frame.facts().wkt;
  image.software = scene.generator;
  image.height_unit = frame.facts().height_unit;
  const std::string detail =
      fmt::format("lod {}, voxels of {} m{}", o.lod, std::ldexp(scene.voxel_size_m, o.lod), query_text(grid, frame));
  if (o.content == MapContent::colours) {
    image.pixels = GeotiffPixels::colours;
    image.description = "Colours seen from above; " + detail;
    return image;
  }
  if (o.content == MapContent::classes) {
    image.pixels = GeotiffPixels::classes;
    image.description = "Classes of the highest voxels; " + detail;
    return image;
  }
  const char* above = "above the WGS84 ellipsoid";
  if (frame.is_scene()) above = "along z of the scene's frame";
  if (frame.facts().has_heights) above = "in the coordinate system";
  image.description = fmt::format("Heights of the highest surface {}; {}", above, detail);
  return image;
}

/// The shares of --memory: half for trees, an eighth for rays, an eighth for GDAL's blocks. The rest is for the program
/// itself.
struct MemoryShares {
  std::uint64_t trees, cache;
  std::size_t batch_rays;
};

MemoryShares shares_of(std::uint64_t memory_bytes) {
  const std::uint64_t all = memory_bytes != 0 ? memory_bytes : host_limits().memory_bytes / 2;
  return {all / 2, std::clamp<std::uint64_t>(all / 8, 16 << 20, 512 << 20),
          std::size_t(std::clamp<std::uint64_t>(all / 8 / bytes_per_ray, 1024, 1 << 17))};
}

/// The values with which a rank computes blocks of the map. Later members refer to earlier ones.
struct MapOfRank {
  MapOfRank(const MapExport& o, int threads, bool shows_progress)
      : memory(shares_of(o.memory_bytes)),
        pool(threads),
        area(area_without_map_crs(o.area).area()),
        scene(o.scene, area_of_voxels(o.area, area.get()), threads, shows_progress),
        query(std::make_shared<const PagedScene>(scene.file()), query_options(o, memory), pool),
        frame(open_map_frame(query.scene().header(), o.area.crs, threads)),
        place(place_of(o, query, frame, area)),
        job{o.content, place.grid, geotiff_block, memory.batch_rays, place.area},
        map(query, frame, job, pool) {}

  static QueryOptions query_options(const MapExport& o, const MemoryShares& memory) {
    QueryOptions options;
    options.lod = o.lod;
    options.memory_bytes = memory.trees;
    options.device = [] { return choose_device({Backend::automatic}).device; };
    return options;
  }

  MemoryShares memory;
  ThreadPool pool;
  std::shared_ptr<const Area> area;
  ClippedScene scene;
  SceneQuery query;
  MapFrame frame;
  MapPlace place;
  MapJob job;
  SurfaceMap map;
};

/// Computes the blocks in turn on all ranks. Rank 0 writes them in their order.
void write_blocks(SurfaceMap& map, GeotiffFile* file, MpiSession& mpi, const ExportTeam& team,
                  const Progress& progress) {
  const std::uint64_t ranks = std::uint64_t(mpi.ranks()), blocks = map.blocks();
  for (std::uint64_t first = 0; first < blocks; first += ranks) {
    std::vector<std::uint8_t> own;
    check_options_collectively(mpi, [&] {
      const std::uint64_t number = first + std::uint64_t(mpi.rank());
      if (number >= blocks) return;
      const std::span<const std::byte> pixels = map.block(number, progress);
      const auto* const bytes = reinterpret_cast<const std::uint8_t*>(pixels.data());
      own.assign(bytes, bytes + pixels.size());
    });
    const std::vector<std::vector<std::uint8_t>> parts = team.collect(std::move(own));
    check_options_collectively(mpi, [&] {
      for (std::size_t i = 0; i < parts.size() && first + i < blocks; ++i)
        file->write_block(std::uint32_t((first + i) % map.block_columns()),
                          std::uint32_t((first + i) / map.block_columns()), std::as_bytes(std::span(parts[i])));
    });
  }
}

/// The tally and the unreadable shards of all ranks.
struct MapResult {
  MapTally tally;
  std::set<std::string> problems;
};

MapResult result_of(const MapOfRank& rank, const ExportTeam& team) {
  ByteWriter own;
  own.put(rank.map.tally());
  own.put(rank.query.problems());
  MapResult all;
  for (const std::vector<std::uint8_t>& bytes : team.exchange(own.take())) {
    ByteReader reader(bytes, "results of a rank");
    MapTally tally;
    std::vector<std::string> problems;
    reader.get(tally);
    reader.get(problems);
    all.tally.with_surface += tally.with_surface;
    all.tally.missing += tally.missing;
    all.problems.insert(problems.begin(), problems.end());
  }
  return all;
}

int print_result(const MapExport& o, const MapGrid& grid, const MapResult& result, bool is_first) {
  const int code = result.tally.missing == 0 ? complete : cells_failed;
  if (!is_first) return code;
  for (const std::string& problem : result.problems) print_message("gigabake: cell missing: {}\n", with_flags(problem));
  if (!o.quiet)
    fmt::print("{} × {} pixels of {} in {}, {} with a surface\n", grid.columns, grid.rows, grid.step, o.out,
               result.tally.with_surface);
  if (code != complete)
    print_message("gigabake: {} a cell that is missing and have no value; bake the scene again\n",
                  pluralize(result.tally.missing, "pixel lies in", "pixels lie in"));
  return code;
}

/// Computes and writes the map. Collective call.
void write_map(const MapExport& o, MapOfRank& rank, MpiSession& mpi, const ExportTeam& team, const Progress& progress) {
  const MapGrid& grid = rank.place.grid;
  std::unique_ptr<GeotiffFile> file;
  check_options_collectively(mpi, [&] {
    if (mpi.rank() != 0) return;
    const GeotiffImage image = image_of(o, grid, rank.query.scene().header(), rank.frame);
    file = create_geotiff(o.out, image, {rank.memory.cache, rank.pool.threads()});
  });
  progress.step("casting rays", std::uint64_t(grid.columns) * grid.rows / std::uint64_t(mpi.ranks()), "pixel");
  write_blocks(rank.map, file.get(), mpi, team, progress);
  check_options_collectively(mpi, [&] {
    if (file) file->finish(progress);
  });
}

}  // namespace

int export_map(const MapExport& o, MpiSession& mpi) {
  // glibc raises this limit when a large block is freed. Trees would then fragment the heap: 345 MB instead of 223 MB
  // with --memory 256M.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
  const bool is_first = mpi.rank() == 0, shows_progress = is_first && !o.quiet;
  std::optional<MapOfRank> rank;
  check_options_collectively(mpi, [&] { rank.emplace(o, o.threads != 0 ? o.threads : mpi.cores(), shows_progress); });
  const MpiExportTeam team(mpi);
  try {
    with_progress(
        [&](const Progress& progress) {
          write_map(o, *rank, mpi, team, progress);
          return 0;
        },
        shows_progress ? stderr : nullptr);
  } catch (const Stopped&) {
    if (is_first) print_message("{}\n", stop_line());
    return exit_code_of_stop();
  }
  return print_result(o, rank->place.grid, result_of(*rank, team), is_first);
}

}  // namespace gigabake::app
