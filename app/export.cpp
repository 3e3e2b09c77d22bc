#include <fmt/format.h>
#include <memory>

#include "app/commands.h"
#include "format/error.h"
#include "format/ply.h"

namespace gigabake::app {
namespace {

struct ExportOptions {
  std::string scene, format, out;
  int lod = 0;
};

}  // namespace

void add_export(CLI::App& app, int&) {
  auto* command = app.add_subcommand("export", "Write a baked scene's voxels in another format");
  auto o = std::make_shared<ExportOptions>();
  command->add_option("SCENE", o->scene, "OUT/scene.xml")->required();
  command->add_option("--to", o->format, "ply")->required();
  command->add_option("-o,--out", o->out, "file to write")->required();
  command->add_option("--lod", o->lod, "level to write")->capture_default_str()->check(CLI::Range(0, 10));
  command->callback([o] {
    if (o->format != "ply") throw UsageError("--to: expected ply, got '" + o->format + "'");
    const std::uint64_t voxels = export_ply(o->scene, o->lod, o->out);
    fmt::print("{} voxels of lod {} in {}\n", voxels, o->lod, o->out);
  });
}

}  // namespace gigabake::app
