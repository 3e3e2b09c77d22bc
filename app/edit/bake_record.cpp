#include "app/edit/bake_record.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/messages/json_text.h"
#include "core/base/error.h"
#include "format/system/json/json_members.h"
#include "format/system/read_file.h"

namespace gigabake::app {
namespace {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

std::string absolute(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).lexically_normal().string();
}

void add(const char* name, const std::string& value, Words& words) {
  if (value.empty()) return;
  words.push_back(fmt::format("{}={}", name, value));
}

Words options_of(const BakeOptions& o) {
  const BakeParameters& p = o.asked.parameters;
  Words words;
  add("--voxel-size", o.voxel_size, words);
  add("--surface", std::string(name_of(p.surface)), words);
  add("--mip", std::string(name_of(p.mip)), words);
  add("--channels", o.channels, words);
  add("--max-error", std::to_string(p.max_error), words);
  if (p.depth_error != 0) add("--depth-error", std::to_string(p.depth_error), words);
  add("--codec", std::string(name_of(p.codec)), words);
  add("--cell-voxels", std::to_string(p.cell_voxels), words);
  add("--lattice-origin", o.lattice_origin, words);
  add("--origin", o.origin, words);
  if (o.asked.source_options.local) words.emplace_back("--local");
  if (const auto up = o.asked.source_options.scene_up) add("--up", std::string(name_of(*up)), words);
  add("--ortho", absolute(o.raster.ortho), words);
  add("--dem-crs", o.raster.crs, words);
  if (!o.raster.nodata.empty()) add("--nodata", fmt::format("{}", fmt::join(o.raster.nodata, ",")), words);
  if (o.raster.geoid_offset_m) add("--geoid-offset", fmt::format("{}", *o.raster.geoid_offset_m), words);
  add("--bounds", o.area.bounds, words);
  add("--clip", absolute(o.area.clip), words);
  add("--crs", o.area.crs, words);
  return words;
}

/// Parses the options with the parser of `bake`.
BakeOptions parsed(const std::filesystem::path& file, const std::string& source, Words words) {
  BakeOptions options;
  CLI::App command;
  options.add_to(command);
  words.push_back(source);
  std::reverse(words.begin(), words.end());  // the parser takes them from the end
  try {
    command.parse(words);
  } catch (const CLI::ParseError& e) {
    throw InputError(file, "options", e.what());
  }
  return options;
}

}  // namespace

std::string bake_record(const BakeOptions& options) {
  const Json record = {
      {"source", absolute(options.source)}, {"options", options_of(options)}, {"overviews", options.asked.overviews}};
  return json_text(record, 2) + "\n";
}

BakeOptions recorded_bake(const std::filesystem::path& scene_folder) {
  const std::filesystem::path file = scene_folder / "source.json";
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw InputError(file, "", "does not exist; bake the scene with this version of gigabake first");
  const std::vector<std::uint8_t> bytes = read_whole_file(file);
  const nlohmann::json json =
      parse_json_object(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const JsonMembers members(file, json);
  members.only({"source", "options", "overviews"});
  BakeOptions options = parsed(file, members.get<std::string>("source"), members.texts("options"));
  options.asked.overviews = members.get<bool>("overviews");
  options.out = scene_folder.string();
  return options;
}

}  // namespace gigabake::app
