#include <fmt/format.h>
#include <functional>
#include <memory>

#include "app/commands.h"
#include "format/gigavoxel.h"
#include "format/nanovdb.h"
#include "format/openvdb/openvdb_export.h"
#include "format/ply.h"
#include "format/voxel_tileset.h"

namespace gigabake::app {
namespace {

struct ExportOptions {
  std::string scene, format, out;
  int lod = 0;
};

struct ExportFormat {
  const char* name;
  /// Returns the number of voxels of the level.
  std::function<std::uint64_t(const ExportOptions&)> write;
};

const ExportFormat formats[] = {
    {"ply", [](const ExportOptions& o) { return export_ply(o.scene, o.lod, o.out); }},
    {"nvdb", [](const ExportOptions& o) { return export_nanovdb(o.scene, o.lod, o.out); }},
    {"vdb", [](const ExportOptions& o) { return export_openvdb(o.scene, o.lod, o.out, openvdb_memory_bytes()); }},
    {"3dtiles", [](const ExportOptions& o) { return export_3dtiles(o.scene, o.lod, o.out); }},
    {"gigavoxel-xml",
     [](const ExportOptions& o) { return export_gigavoxel(o.scene, o.lod, o.out, GigavoxelTreeFile::xml); }},
    {"gigavoxel-binary",
     [](const ExportOptions& o) { return export_gigavoxel(o.scene, o.lod, o.out, GigavoxelTreeFile::binary); }},
};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const ExportFormat& f : formats) names.emplace_back(f.name);
  return names;
}

}  // namespace

void add_export(CLI::App& app, int&) {
  auto* command = app.add_subcommand("export", "Write a baked scene's voxels in another format");
  auto o = std::make_shared<ExportOptions>();
  command->add_option("SCENE", o->scene, "OUT/scene.xml")->required();
  command->add_option("--to", o->format, "the format")->required()->check(CLI::IsMember(format_names()));
  command->add_option("-o,--out", o->out, "file to write; new folder for the formats of many files")->required();
  command->add_option("--lod", o->lod, "level to write; 3dtiles and gigavoxel: the finest")
      ->capture_default_str()
      ->check(CLI::Range(0, 10));
  command->callback([o] {
    for (const ExportFormat& f : formats)
      if (o->format == f.name) fmt::print("{} voxels of lod {} in {}\n", f.write(*o), o->lod, o->out);
  });
}

}  // namespace gigabake::app
