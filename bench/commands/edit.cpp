#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "app/commands.h"
#include "app/edit/scene_editor.h"
#include "app/messages/json_text.h"
#include "app/messages/with_progress.h"
#include "app/options/renderer_options.h"
#include "app/options/scene_argument.h"
#include "app/options/text_values.h"
#include "app/process/bench_program.h"
#include "bench/commands/commands.h"
#include "bench/edit_bench.h"

namespace gigabake::app {
namespace {

struct EditBenchOptions {
  bench::EditBenchRequest request;
  RendererArguments renderer;
  std::string size = "1280x720";
  bool json = false;
};

void print_text(const bench::EditBench& b) {
  fmt::print("edits with a brush of {:.0f} voxels, {}x{}; ms, medians\n\n", b.brush_voxels, b.width, b.height);
  fmt::print("{:<6} {:>9} {:>9} {:>11} {:>9} {:>9} {:>9}\n", "", "preview", "on disk", "next image", "complete", "undo",
             "uploads");
  for (const bench::EditBenchRow& row : b.rows)
    fmt::print("{:<6} {:>9.0f} {:>9.0f} {:>11.0f} {:>9.0f} {:>9.0f} {:>9}\n", row.type, 1e3 * row.preview_s,
               1e3 * row.disk_s, 1e3 * row.image_s, 1e3 * row.rest_s, 1e3 * row.undo_s, row.uploads);
  fmt::print("\ncomplete images, compared with a new renderer: {}\nlast image, compared with the first: {}\n",
             b.same_as_rendered ? "equal bytes" : "bytes DIFFER", b.is_restored ? "equal bytes" : "bytes DIFFER");
}

nlohmann::ordered_json to_json(const bench::EditBench& b) {
  nlohmann::ordered_json j{{"bench", "edit"},
                           {"width", b.width},
                           {"height", b.height},
                           {"brush_voxels", b.brush_voxels},
                           {"same_as_rendered", b.same_as_rendered},
                           {"is_restored", b.is_restored}};
  for (const bench::EditBenchRow& row : b.rows)
    j["edits"].push_back({{"type", row.type},
                          {"preview_s", row.preview_s},
                          {"disk_s", row.disk_s},
                          {"image_s", row.image_s},
                          {"rest_s", row.rest_s},
                          {"undo_s", row.undo_s},
                          {"uploads", row.uploads}});
  return j;
}

int run(const EditBenchOptions& options) {
  bench::EditBenchRequest request = options.request;
  std::tie(request.width, request.height) = size_option(options.size);
  request.renderer = renderer_options(options.renderer);
  request.editor = make_scene_editor(request.scene.parent_path(), caller_program());
  const bench::EditBench result = while_reading([&](const Progress& progress) {
    progress.step("editing a scene");
    return bench::bench_edits(request);
  });
  if (options.json)
    fmt::print("{}\n", json_text(to_json(result)));
  else
    print_text(result);
  return result.failed() ? failed : complete;
}

}  // namespace

void add_bench_edit(CLI::App& bench, int& exit_code) {
  auto* command = bench.get_subcommand("edit");
  auto options = std::make_shared<EditBenchOptions>();
  auto scene = std::make_shared<std::string>();
  command->add_option("SCENE", *scene, "folder of a new bake, or its scene.xml; each edit is undone")->required();
  command->add_option("--size", options->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command->add_option("--brush", options->request.brush_voxels, "diameter of the brush in voxels")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 4096.0));
  command->add_option("--distance", options->request.distance_voxels, "from the eye to the surface, voxels")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e6));
  command->add_option("--repeats", options->request.repeats, "edits per type; the median is reported")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  add_renderer_options(*command, options->renderer);
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options, scene, &exit_code] {
    options->request.scene = scene_argument(*scene);
    exit_code = run(*options);
  });
}

}  // namespace gigabake::app
