#include "format/diff.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"

namespace gigabake::app {
namespace {

using Json = nlohmann::ordered_json;

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
                           {"largest_rgba", l.largest},
                           {"mean_rgba", l.mean},
                           {"turned", l.turned},
                           {"refaced", l.refaced}});
    j["cells"].push_back(c);
  }
  fmt::print("{}\n", j.dump(2));
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
          "  lod {:<2} {} voxels only in A, {} only in B; of {} in both {} differ in colour (r g b alpha by at most "
          "{}, on "
          "average {:.2f}), {} in their normal, {} in coverage along an axis\n",
          l.lod, l.only_in_a, l.only_in_b, l.both, l.recoloured, fmt::join(l.largest, " "), fmt::join(l.mean, " "),
          l.turned, l.refaced);
  }
  fmt::print("lods {}: {}\n", fmt::join(d.compared, " "),
             d.same() ? std::string("the same voxels") : fmt::format("{} places differ", d.cells.size()));
  if (!d.not_compared.empty())
    fmt::print("lods {}: not compared everywhere; the scenes' cells have other voxels there\n",
               fmt::join(d.not_compared, " "));
}

}  // namespace

void add_diff(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "diff",
      "Do two scenes hold the same voxels? Which cells differ, by how much; exit code 0: the same, 1: they differ");
  auto a = std::make_shared<std::string>(), b = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("A", *a, "A/scene.xml")->required();
  command->add_option("B", *b, "B/scene.xml")->required();
  command->add_flag("--json", *json, "print the answer as JSON");
  command->callback([a, b, json, &exit_code] {
    const SceneDifference d = diff_scenes(*a, *b);
    exit_code = d.same() ? complete : failed;
    *json ? print_json(d) : print_text(d);
  });
}

}  // namespace gigabake::app
