#include "app/manual/help_sections.h"

#include <fmt/format.h>
#include <map>

#include "viewer/live/view_mode_legend.h"

namespace gigabake::app {
namespace {

using Lines = std::vector<std::string>;

const Lines source_kinds{
    "a mesh file       .glb, .gltf, .b3dm, .i3dm, .cmpt, .obj, .ply or .stl",
    "a folder          every mesh file below it",
    "3D Tiles          tileset.json, or its archive .3tz",
    "a raster          elevation, .tif (where gigabake was built with GDAL)",
    "a scene .json     a list of these with their places; docs/format-sources.md lists its keys",
};
const Lines baked_scene{"the folder of a bake, or its scene.xml"};

/// The examples by command, without the leading "gigabake".
const std::map<std::string, Lines> examples{
    {"sample", {"gigabake sample village --size 384 --seed 7", "gigabake sample village --json"}},
    {"plan",
     {"gigabake plan village/tileset.json --voxel-size 0.25",
      "gigabake plan village/tileset.json --voxel-size 0.25 -o SCENE --json"}},
    {"bake",
     {"gigabake bake village/tileset.json --voxel-size 0.25 -o SCENE",
      "gigabake bake scan.obj --voxel-size 0.01 --up z --codec lz4 -o SCENE",
      "gigabake bake dem.tif --ortho photo.tif --voxel-size 0.5 -o SCENE",
      "mpirun -n 8 gigabake bake city/tileset.json --voxel-size 0.5 --origin 46.93,8.30,610 -o SCENE"}},
    {"edit",
     {"gigabake edit SCENE --carve sphere:12,30,4,2.5", "gigabake edit SCENE --fill box:0,0,0,8,4,3 --rgb 200,190,180",
      "gigabake edit SCENE --from edits.json", "gigabake edit SCENE --undo", "gigabake edit SCENE --list"}},
    {"status", {"gigabake status SCENE", "gigabake status SCENE --follow"}},
    {"info", {"gigabake info SCENE", "gigabake info SCENE --json"}},
    {"verify", {"gigabake verify SCENE", "gigabake verify SCENE --json"}},
    {"diff", {"gigabake diff SCENE OTHER", "gigabake diff SCENE OTHER --json"}},
    {"export",
     {"gigabake export SCENE --lod 2 -o coarse.ply", "gigabake export SCENE --to 3dtiles -o tiles",
      "gigabake export SCENE --to dsm --crs EPSG:25832 --step 0.5 -o heights.tif"}},
    {"render",
     {"gigabake render SCENE -o image.png",
      "gigabake render SCENE -o image.jpg --eye 175,-215,95 --target 0,0,0 --size 1920x1080",
      "gigabake render SCENE -o levels.png --mode lod",
      "gigabake render SCENE -o frames/%04d.png --path flight.json --fps 25 --stats flight-stats.json"}},
    {"query",
     {"gigabake query SCENE --ray 0,0,200,0,0,-1 --format json",
      "gigabake query SCENE --rays rays.csv -o hits.csv --coordinates lonlat",
      "gigabake query SCENE --grid 0,0,100,100 --step 0.5 -o heights.csv",
      "gigabake query SCENE --sight 175,-215,95,0,0,40 --ignore-ends 1 --format geojson",
      "gigabake query SCENE --profile line.geojson --step 2 -o profile.csv",
      "gigabake query SCENE --volume area.geojson --above 612.5",
      "gigabake query BEFORE --volume area.geojson --against AFTER --format json"}},
    {"view", {"gigabake view SCENE", "gigabake view SCENE --size 1920x1080 -o images"}},
    {"serve",
     {"gigabake serve SCENE", "gigabake serve SCENE --port 0", "gigabake serve SCENE --bind 0.0.0.0 --viewers 4"}},
    {"bench", {"gigabake bench kernels village/tileset.json --voxel-size 0.25"}},
    {"bench kernels", {"gigabake bench kernels village/tileset.json --voxel-size 0.25 --repeats 3"}},
    {"bench bake", {"gigabake bench bake village/tileset.json --voxel-size 0.25 --cells 4 -o FOLDER"}},
    {"bench schedule", {"gigabake bench schedule --cells 100000 --workers 100 --deaths 5"}},
    {"bench pack", {"gigabake bench pack SCENE/shards --repeats 5"}},
    {"bench query", {"gigabake bench query SCENE --rays 1000000 --lod 1"}},
    {"bench render", {"gigabake bench render SCENE --size 1280x720 --what frames"}},
    {"bench edit", {"gigabake bench edit SCENE --brush 32"}},
    {"bench accuracy",
     {"gigabake bench accuracy village/tileset.json --voxel-size 0.5 -o FOLDER --settings area-coverage,thin-coverage",
      "gigabake bench accuracy village/tileset.json --voxel-size 0.5 -o FOLDER --flight --steps 10,2 --size 640x360",
      "gigabake bench accuracy --hard", "gigabake bench accuracy --leaks --json leaks.json"}},
    {"completion", {"source <(gigabake completion bash)", "gigabake completion fish | source"}},
    {"man", {"gigabake man", "gigabake man bench render", "gigabake man bake > gigabake-bake.1"}},
    {"",
     {"gigabake sample village", "gigabake plan village/tileset.json --voxel-size 0.25",
      "gigabake bake village/tileset.json --voxel-size 0.25 -o SCENE", "gigabake view SCENE"}},
};

bool reads_sources(const std::string& words) {
  return words == "plan" || words == "bake" || words == "bench kernels" || words == "bench bake" ||
         words == "bench accuracy";
}

bool reads_a_scene(const std::string& words) {
  return words == "edit" || words == "info" || words == "verify" || words == "export" || words == "render" ||
         words == "query" || words == "view" || words == "serve" || words == "status" || words == "bench render" ||
         words == "bench query" || words == "bench edit";
}

Lines legends() {
  Lines lines;
  for (const ViewMode mode : values_of<ViewMode>())
    lines.push_back(fmt::format("{:<10}{}", name_of(mode), view_mode_legend(mode)));
  return lines;
}

void add_to(CLI::App& app, const std::string& name) {
  std::string text;
  for (const HelpSection& section : help_sections(name)) {
    text += (text.empty() ? "" : "\n") + section.title + ":\n";
    for (const std::string& line : section.lines) text += "  " + line + "\n";
  }
  if (!text.empty()) text.pop_back();  // CLI11 adds the end of line
  app.footer(text);
  for (CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; }))
    add_to(*below, name + " " + below->get_name());
}

}  // namespace

std::vector<HelpSection> help_sections(const std::string& command) {
  const std::size_t space = command.find(' ');
  const std::string words = space == std::string::npos ? "" : command.substr(space + 1);
  std::vector<HelpSection> sections;
  if (reads_sources(words)) sections.push_back({"SOURCE may be", source_kinds});
  if (reads_a_scene(words)) sections.push_back({"SCENE may be", baked_scene});
  if (words == "render") sections.push_back({"Modes", legends()});
  const auto found = examples.find(words);
  if (found != examples.end()) sections.push_back({"Examples", found->second});
  return sections;
}

void add_help_sections(CLI::App& program) { add_to(program, "gigabake"); }

}  // namespace gigabake::app
