#include "format/scene/check/diff.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/with_progress.h"
#include "app/options/flags.h"
#include "app/options/scene_argument.h"
#include "core/base/pluralize.h"
#include "core/base/progress.h"
#include "format/system/message.h"

namespace gigabake::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int diff_same = 0, diff_differs = 1, diff_trouble = 2;

void print_json(const SceneDifference& d) {
  Json j{{"same", d.same()}, {"lods_compared", d.compared}, {"lods_not_compared", d.not_compared}};
  j["cells"] = Json::array();
  for (const CellDifference& cell : d.cells) {
    Json c{{"cell_in_a", cell.cell_in_a}, {"cell_in_b", cell.cell_in_b}, {"lods", Json::array()}};
    for (const LevelDifference& l : cell.levels)
      c["lods"].push_back({{"lod", l.lod},
                           {"only_in_a", l.only_in_a},
                           {"only_in_b", l.only_in_b},
                           {"both", l.both},
                           {"recoloured", l.recoloured},
                           {"largest_rgba", l.maximum},
                           {"mean_rgba", l.mean},
                           {"turned", l.turned},
                           {"refaced", l.refaced},
                           {"reclassified", l.reclassified}});
    j["cells"].push_back(c);
  }
  fmt::print("{}\n", json_text(j));
}

std::string place(const CellDifference& cell) {
  if (cell.cell_in_b.empty()) return cell.cell_in_a + " (only A has a cell there)";
  if (cell.cell_in_a.empty()) return cell.cell_in_b + " (only B has a cell there)";
  return cell.cell_in_a == cell.cell_in_b ? cell.cell_in_a : cell.cell_in_a + " and " + cell.cell_in_b;
}

void print_text(const SceneDifference& d) {
  for (const CellDifference& cell : d.cells) {
    fmt::print("{}\n", place(cell));
    for (const LevelDifference& l : cell.levels)
      fmt::print(
          "  lod {:<2} {} only in A, {} only in B; of {} in both {} differ in colour (r g b alpha by at most "
          "{}, on "
          "average {:.2f}), {} in their normal, {} in coverage along an axis, {} in class\n",
          l.lod, pluralize(l.only_in_a, "voxel"), l.only_in_b, l.both, l.recoloured, fmt::join(l.maximum, " "),
          fmt::join(l.mean, " "), l.turned, l.refaced, l.reclassified);
  }
  if (!d.compared.empty() || d.not_compared.empty())
    fmt::print("lods {}: {}\n", fmt::join(d.compared, " "),
               d.same() ? std::string("the same voxels, by their recorded hashes; verify reads the shards")
                        : pluralize(d.cells.size(), "place differs", "places differ"));
  if (!d.not_compared.empty())
    fmt::print("lods {}: not compared everywhere; the scenes' cells have other voxels there\n",
               fmt::join(d.not_compared, " "));
}

/// Returns an exit code like diff(1). Scenes without a comparable level do not count as equal.
int exit_code_of(const SceneDifference& d) {
  if (!d.same()) return diff_differs;
  return d.compared.empty() && !d.not_compared.empty() ? diff_trouble : diff_same;
}

}  // namespace

void add_diff(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("diff",
                                     "Compare the voxels of two scenes, and list the cells that differ and by how "
                                     "much; levels with equal recorded hashes are not read (verify reads them); exit "
                                     "code 0: equal, 1: different, 2: not comparable, 3: equal, but incomplete");
  auto a = std::make_shared<std::string>(), b = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false), quiet = std::make_shared<bool>(false);
  command->add_option("A", *a, "folder of a bake, or its scene.xml")->required();
  command->add_option("B", *b, "folder of another bake, or its scene.xml")->required();
  command->add_flag("--json", *json, "print the answer as JSON");
  command->add_flag("-q,--quiet", *quiet, "print nothing; the exit code is the answer");
  command->callback([a, b, json, quiet, &exit_code] {
    try {
      const SceneDifference d = while_reading(
          [&](const Progress& progress) {
            const std::filesystem::path scene_a = scene_argument(*a), scene_b = scene_argument(*b);
            expect_shards(scene_a);
            expect_shards(scene_b);
            return diff_scenes(scene_a, scene_b, progress);
          },
          *quiet ? nullptr : stderr);
      exit_code = exit_code_of(d);
      if (!*quiet) *json ? print_json(d) : print_text(d);
    } catch (const Stopped&) {
      throw;
    } catch (const std::exception& error) {
      print_message("gigabake: {}\n", error_text(error));
      exit_code = diff_trouble;
    }
  });
}

}  // namespace gigabake::app
