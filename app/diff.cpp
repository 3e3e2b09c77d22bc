#include "format/diff.h"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"

namespace gigabake::app {
namespace {

struct DiffOptions {
  std::string a, b;
  int lod = 0;
  bool json = false;
};

void print_json(const DiffResult& r) {
  nlohmann::ordered_json j{{"same", r.same}, {"cells_compared", r.cells_compared}};
  j["cells"] = nlohmann::ordered_json::array();
  for (const DiffPlace& p : r.places)
    j["cells"].push_back({{"name", p.cell},
                          {"only_in_a", p.only_in_a},
                          {"only_in_b", p.only_in_b},
                          {"both", p.both},
                          {"changed", p.changed},
                          {"normals_changed", p.normals_changed},
                          {"largest_rgba", p.largest},
                          {"mean_rgba", p.mean}});
  fmt::print("{}\n", j.dump(2));
}

void print_text(const DiffResult& r) {
  for (const DiffPlace& p : r.places)
    fmt::print(
        "{}: {} voxels only in A, {} only in B, {} of {} changed (rgba by at most {} {} {} {}, mean {:.3f} {:.3f} "
        "{:.3f} {:.3f})\n",
        p.cell, p.only_in_a, p.only_in_b, p.changed, p.both, p.largest[0], p.largest[1], p.largest[2], p.largest[3],
        p.mean[0], p.mean[1], p.mean[2], p.mean[3]);
  fmt::print("{} cells compared, {}\n", r.cells_compared,
             r.same ? std::string("the same voxels") : fmt::format("{} differ", r.places.size()));
}

}  // namespace

void add_diff(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "diff", "Do two scenes hold the same voxels? Which cells differ, by how much; exit code 1 if they do");
  auto o = std::make_shared<DiffOptions>();
  command->add_option("A", o->a, "A/scene.xml")->required();
  command->add_option("B", o->b, "B/scene.xml")->required();
  command->add_option("--lod", o->lod, "level to compare")->capture_default_str()->check(CLI::Range(0, 10));
  command->add_flag("--json", o->json, "print the answer as JSON");
  command->callback([o, &exit_code] {
    const DiffResult r = diff_scenes(o->a, o->b, o->lod);
    exit_code = r.same ? complete : failed;
    o->json ? print_json(r) : print_text(r);
  });
}

}  // namespace gigabake::app
