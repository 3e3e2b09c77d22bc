#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "app/commands.h"
#include "app/messages/with_progress.h"
#include "app/options/choices.h"
#include "app/options/map_crs.h"
#include "app/options/output_file.h"
#include "app/options/scene_argument.h"
#include "app/process/clipped_scene.h"
#include "app/process/map_export.h"
#include "app/process/on_all_ranks.h"
#include "app/process/point_export.h"
#include "cluster/launch/agreed_request.h"
#include "cluster/mpi/collective.h"
#include "cluster/mpi/mpi_export_team.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/export/gigavoxels/gigavoxel.h"
#include "format/export/nanovdb/nanovdb.h"
#include "format/export/openvdb/openvdb_export.h"
#include "format/export/ply/ply.h"
#include "format/export/voxel_tiles/voxel_tileset.h"
#include "format/scene/paged_scene.h"
#include "format/system/message.h"

namespace gigabake::app {
namespace {

struct ExportOptions {
  std::string scene, format, out;
  AreaOptions area;
  int lod = 0;
  bool quiet = false;
  TilesetOptions tiles = {.threads = 0};  ///< 0: the host's cores, divided among its ranks
  double step = 0;
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;
};

/// The class of a format, which determines its options.
enum class FormatClass : std::uint8_t { voxels, points, tiles, map };

struct ExportFormat {
  const char* name;
  const char* suffix;  ///< suffix of the single file that selects the format; empty if none does
  FormatClass options;
  /// Writes the voxels of the level, and returns their number. Only for voxels and points.
  std::function<std::uint64_t(const ExportOptions&, const Progress&)> write;
};

const ExportFormat formats[] = {
    {"ply", ".ply", FormatClass::voxels,
     [](const ExportOptions& o, const Progress& p) { return export_ply(o.scene, o.lod, o.out, p); }},
    {"las", ".las", FormatClass::points,
     [](const ExportOptions& o, const Progress& p) { return export_points(o.scene, o.lod, o.area.crs, o.out, p); }},
    {"nvdb", ".nvdb", FormatClass::voxels,
     [](const ExportOptions& o, const Progress& p) { return export_nanovdb(o.scene, o.lod, o.out, p); }},
    {"vdb", ".vdb", FormatClass::voxels,
     [](const ExportOptions& o, const Progress& p) {
       return export_openvdb(o.scene, o.lod, o.out, openvdb_memory_bytes(), p);
     }},
    {"3dtiles", ".3tz", FormatClass::tiles, {}},
    {"3dtiles-gltf", "", FormatClass::tiles, {}},
    {"dsm", "", FormatClass::map, {}},
    {"ortho", "", FormatClass::map, {}},
    {"classes", "", FormatClass::map, {}},
    {"gigavoxel-xml", "", FormatClass::voxels,
     [](const ExportOptions& o, const Progress& p) {
       return export_gigavoxel(o.scene, o.lod, o.out, GigavoxelTreeFile::xml, p);
     }},
    {"gigavoxel-binary", "", FormatClass::voxels,
     [](const ExportOptions& o, const Progress& p) {
       return export_gigavoxel(o.scene, o.lod, o.out, GigavoxelTreeFile::binary, p);
     }},
};

bool carries_classes(const ExportFormat& format) {
  const std::string_view name = format.name;
  return !name.starts_with("gigavoxel") && name != "dsm" && name != "ortho";
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const ExportFormat& f : formats) names.emplace_back(f.name);
  return names;
}

/// Returns the format of --to; without --to, the format for the suffix of -o.
const ExportFormat& chosen_format(const ExportOptions& o) {
  const std::string suffix = std::filesystem::path(o.out).extension().string();
  for (const ExportFormat& f : formats)
    if (o.format.empty() ? *f.suffix != 0 && suffix == f.suffix : o.format == f.name) return f;
  throw UsageError(
      fmt::format("--to: the name '{}' does not determine the format; expected a name that ends in .ply, .las, .nvdb, "
                  ".vdb or .3tz, or "
                  "--to with one of {}",
                  o.out, fmt::join(format_names(), ", ")));
}

/// Rejects options of other formats.
/// Errors  UsageError: the command line has such an option.
void expect_no_other_options(const CLI::App& command, const ExportFormat& format) {
  struct OptionOfFormats {
    const char* name;
    const char* formats;
    std::vector<FormatClass> classes;
  };
  const OptionOfFormats options[] = {
      {"--tile-voxels", "3dtiles and 3dtiles-gltf", {FormatClass::tiles}},
      {"--update", "3dtiles and 3dtiles-gltf", {FormatClass::tiles}},
      {"--threads", "3dtiles, 3dtiles-gltf, dsm, ortho and classes", {FormatClass::tiles, FormatClass::map}},
      {"--step", "dsm, ortho and classes", {FormatClass::map}},
      {"--memory", "dsm, ortho and classes", {FormatClass::map}},
  };
  for (const OptionOfFormats& option : options)
    if (command.count(option.name) != 0 &&
        std::find(option.classes.begin(), option.classes.end(), format.options) == option.classes.end())
      throw UsageError(fmt::format("{}: is an option of --to {}, not of {}", option.name, option.formats, format.name));
}

/// Prints a line if the scene has classes and the format has no place for them.
void report_lost_classes(const ExportOptions& o, const ExportFormat& format) {
  if (o.quiet || carries_classes(format) || !PagedScene(o.scene).header().has_classes) return;
  print_message(
      "{} has no place for the classes of voxels: they are left out; the other formats, except dsm and ortho, have "
      "them\n",
      format.name);
}

void print_done(const ExportOptions& o, std::uint64_t voxels) {
  if (!o.quiet) fmt::print("{} of lod {} in {}\n", pluralize(voxels, "voxel"), o.lod, o.out);
}

/// Returns the options that determine the bytes of an export.
std::vector<NamedOption> shared_options(const ExportOptions& o, const ExportFormat& format) {
  return {{"SCENE", std::filesystem::absolute(o.scene).lexically_normal().string()},
          {"`to`", format.name},
          {"`out`", std::filesystem::absolute(o.out).lexically_normal().string()},
          {"`lod`", std::to_string(o.lod)},
          {"`bounds`, `clip` or `crs`", o.area.text()},
          {"--tile-voxels", std::to_string(o.tiles.tile_voxels)},
          {"`step`", fmt::format("{}", o.step)},
          {"`update`", o.tiles.update ? "given" : "not given"}};
}

int run_on_rank(const ExportOptions& options, const ExportFormat& format, MpiSession& mpi) {
  expect_same_options(mpi, shared_options(options, format));
  TilesetOptions tiles = options.tiles;
  if (std::string_view(format.name) == "3dtiles-gltf") tiles.form = TilesetForm::gltf_2_1;
  tiles.lod = options.lod;
  if (tiles.threads == 0) tiles.threads = mpi.cores();
  std::optional<ClippedScene> scene;  // each rank clips for itself, because hosts may share no temporary folder
  check_options_collectively(
      mpi, [&] { scene.emplace(options.scene, options.area, tiles.threads, mpi.rank() == 0 && !options.quiet); });
  if (mpi.rank() == 0) report_lost_classes(options, format);
  const MpiExportTeam team(mpi);
  try {
    const std::uint64_t voxels = with_progress(
        [&](const Progress& progress) { return export_3dtiles(scene->file(), tiles, options.out, progress, team); },
        mpi.rank() == 0 && !options.quiet ? stderr : nullptr);
    if (mpi.rank() == 0) print_done(options, voxels);
    return 0;
  } catch (const Stopped&) {
    if (mpi.rank() == 0) print_message("{}\n", stop_line());
    return exit_code_of_stop();
  }
}

MapContent content_of(std::string_view format) {
  if (format == "classes") return MapContent::classes;
  return format == "ortho" ? MapContent::colours : MapContent::heights;
}

int run_map(const ExportOptions& o, const ExportFormat& format, MpiSession& mpi) {
  expect_same_options(mpi, shared_options(o, format));
  if (mpi.rank() == 0) report_lost_classes(o, format);
  MapExport map;
  map.scene = o.scene;
  map.out = o.out;
  map.content = content_of(format.name);
  map.area = o.area;
  map.lod = o.lod;
  map.step = o.step;
  map.memory_bytes = o.memory_bytes;
  map.threads = o.tiles.threads;
  map.quiet = o.quiet;
  return export_map(map, mpi);
}

void add_map_options(CLI::App& command, ExportOptions& options) {
  command.add_option(
      "--step", options.step,
      "dsm, ortho and classes: edge of a pixel in units of --crs (edge of a voxel at --lod, if these are metres)");
  command
      .add_option(
          "--memory", options.memory_bytes,
          "dsm, ortho and classes: max bytes of memory of each rank, such as 256M; 0: half of the host's memory (1G)")
      ->transform(CLI::AsSizeValue(false));
}

void add_tile_options(CLI::App& command, ExportOptions& options) {
  command
      .add_option("--tile-voxels", options.tiles.tile_voxels,
                  "3dtiles: edge of a tile in voxels, 8 to 126 (80 to 112, chosen to fit the scene)")
      ->check(CLI::Range(8, 126));
  command
      .add_option("--threads", options.tiles.threads,
                  "3dtiles, dsm, ortho and classes: threads of each rank (the host's cores shared by its ranks)")
      ->check(CLI::Range(0, 1024));
  command.add_flag("--update", options.tiles.update,
                   "3dtiles: update an earlier export of the scene; only tiles that changed are rewritten");
}

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "export", "Write a baked scene's voxels in another format; 3dtiles and maps under mpirun on all ranks");
  auto o = std::make_shared<ExportOptions>();
  command->add_option("SCENE", o->scene, "folder of a bake, or its scene.xml")->required();
  command->add_option("--to", o->format, "format (default: by the suffix of -o: .ply, .las, .nvdb, .vdb, .3tz)")
      ->check(one_of(format_names()));
  command->add_option("-o,--out", o->out, "file to write; new folder for the formats of many files")->required();
  command->add_option("--lod", o->lod, "level to write; 3dtiles and gigavoxel: the finest")
      ->capture_default_str()
      ->check(CLI::Range(0, 62));
  o->area.add_to(*command);
  add_tile_options(*command, *o);
  add_map_options(*command, *o);
  command->add_flag("-q,--quiet", o->quiet, "print only errors");
  command->callback([o, command, &exit_code] {
    const ExportFormat& format = chosen_format(*o);
    o->scene = scene_argument(o->scene).string();
    expect_parent_folder("-o", o->out);
    expect_no_other_options(*command, format);
    if (format.options == FormatClass::map) {
      expect_no_input("-o", o->out, files_of_bake(std::filesystem::path(o->scene).parent_path()));
      exit_code = on_all_ranks("export", [&](MpiSession& mpi) { return run_map(*o, format, mpi); });
      return;
    }
    if (format.options == FormatClass::tiles) {
      exit_code = on_all_ranks("export", [&](MpiSession& mpi) { return run_on_rank(*o, format, mpi); });
      return;
    }
    const bool has_crs = format.options == FormatClass::points;
    const ClippedScene scene(o->scene, has_crs ? area_without_map_crs(o->area) : o->area, 0, !o->quiet);
    ExportOptions of_clipped = *o;
    of_clipped.scene = scene.file().string();
    report_lost_classes(*o, format);
    const std::uint64_t voxels = with_progress(
        [&](const Progress& progress) { return format.write(of_clipped, progress); }, o->quiet ? nullptr : stderr);
    print_done(*o, voxels);
  });
}

}  // namespace gigabake::app
