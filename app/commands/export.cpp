#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <memory>

#include "app/commands.h"
#include "app/messages/with_progress.h"
#include "app/options/choices.h"
#include "app/options/scene_argument.h"
#include "format/export/gigavoxel.h"
#include "format/export/nanovdb.h"
#include "format/export/openvdb/openvdb_export.h"
#include "format/export/ply.h"
#include "format/export/voxel_tileset.h"
#include "lattice/counted.h"
#include "lattice/error.h"

namespace gigabake::app {
namespace {

struct ExportOptions {
  std::string scene, format, out;
  int lod = 0;
  bool quiet = false;
};

struct ExportFormat {
  const char* name;
  const char* suffix;  ///< of its one file; empty where it is a folder
  /// Returns the number of voxels of the level.
  std::function<std::uint64_t(const ExportOptions&, const Progress&)> write;
};

const ExportFormat formats[] = {
    {"ply", ".ply", [](const ExportOptions& o, const Progress& p) { return export_ply(o.scene, o.lod, o.out, p); }},
    {"nvdb", ".nvdb",
     [](const ExportOptions& o, const Progress& p) { return export_nanovdb(o.scene, o.lod, o.out, p); }},
    {"vdb", ".vdb",
     [](const ExportOptions& o, const Progress& p) {
       return export_openvdb(o.scene, o.lod, o.out, openvdb_memory_bytes(), p);
     }},
    {"3dtiles", "", [](const ExportOptions& o, const Progress& p) { return export_3dtiles(o.scene, o.lod, o.out, p); }},
    {"gigavoxel-xml", "",
     [](const ExportOptions& o, const Progress& p) {
       return export_gigavoxel(o.scene, o.lod, o.out, GigavoxelTreeFile::xml, p);
     }},
    {"gigavoxel-binary", "",
     [](const ExportOptions& o, const Progress& p) {
       return export_gigavoxel(o.scene, o.lod, o.out, GigavoxelTreeFile::binary, p);
     }},
};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const ExportFormat& f : formats) names.emplace_back(f.name);
  return names;
}

/// --to, or else what the name of -o ends in.
const ExportFormat& chosen_format(const ExportOptions& o) {
  const std::string suffix = std::filesystem::path(o.out).extension().string();
  for (const ExportFormat& f : formats)
    if (o.format.empty() ? *f.suffix != 0 && suffix == f.suffix : o.format == f.name) return f;
  throw UsageError(
      fmt::format("--to: the name '{}' does not say the format; expected .ply, .nvdb or .vdb at its end, or "
                  "--to with one of {}",
                  o.out, fmt::join(format_names(), ", ")));
}

}  // namespace

void add_export(CLI::App& app, int&) {
  auto* command = app.add_subcommand("export", "Write a baked scene's voxels in another format");
  auto o = std::make_shared<ExportOptions>();
  command->add_option("SCENE", o->scene, "OUT of a bake, or OUT/scene.xml")->required();
  command->add_option("--to", o->format, "the format (what -o ends in: .ply, .nvdb, .vdb)")
      ->check(one_of(format_names()));
  command->add_option("-o,--out", o->out, "file to write; new folder for the formats of many files")->required();
  command->add_option("--lod", o->lod, "level to write; 3dtiles and gigavoxel: the finest")
      ->capture_default_str()
      ->check(CLI::Range(0, 10));
  command->add_flag("-q,--quiet", o->quiet, "print errors alone");
  command->callback([o] {
    const ExportFormat& format = chosen_format(*o);
    o->scene = scene_argument(o->scene).string();
    const std::uint64_t voxels = with_progress([&](const Progress& progress) { return format.write(*o, progress); },
                                               o->quiet ? nullptr : stderr);
    if (!o->quiet) fmt::print("{} of lod {} in {}\n", counted(voxels, "voxel"), o->lod, o->out);
  });
}

}  // namespace gigabake::app
