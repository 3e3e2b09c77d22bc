#include "app/options/flags.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace gigabake::app {
namespace {

/// The field names that UsageError and messages use (core/base/error.h), with the option that sets each field.
constexpr auto flags = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"backend", "--backend"},
    {"bind", "--bind"},
    {"bounds", "--bounds"},
    {"cell_voxels", "--cell-voxels"},
    {"channels", "--channels"},
    {"clip", "--clip"},
    {"clip_box", "--clip-box"},
    {"clip_plane", "--clip-plane"},
    {"codec", "--codec"},
    {"coordinates", "--coordinates"},
    {"crs", "--crs"},
    {"dem_crs", "--dem-crs"},
    {"depth", "--depth"},
    {"depth_error", "--depth-error"},
    {"external_url", "--external-url"},
    {"eye_m", "--eye"},
    {"format", "--format"},
    {"fovy_deg", "--fovy"},
    {"frames", "--frames"},
    {"frames_per_s", "--fps"},
    {"geoid_offset_m", "--geoid-offset"},
    {"gpus", "--gpus"},
    {"grid", "--grid"},
    {"ground_step_m", "--ground-step"},
    {"ignore_ends", "--ignore-ends"},
    {"lattice_origin_m", "--lattice-origin"},
    {"local", "--local"},
    {"lod", "--lod"},
    {"max_distance", "--max-distance"},
    {"max_error", "--max-error"},
    {"memory_bytes", "--memory"},
    {"mip", "--mip"},
    {"no_keep_going", "--no-keep-going"},
    {"no_measure", "--no-measure"},
    {"no_overviews", "--no-overviews"},
    {"nodata", "--nodata"},
    {"origin", "--origin"},
    {"ortho", "--ortho"},
    {"out", "-o"},
    {"pixel_error", "--pixel-error"},
    {"port", "--port"},
    {"prune", "--prune"},
    {"scratch", "--scratch"},
    {"size", "--size"},
    {"size_m", "--size"},
    {"spread", "--footprint"},
    {"step", "--step"},
    {"surface", "--surface"},
    {"target_m", "--target"},
    {"texel_m", "--texel"},
    {"threads", "--threads"},
    {"tiles", "--tiles"},
    {"time", "--time"},
    {"to", "--to"},
    {"token", "--token"},
    {"up", "--up"},
    {"update", "--update"},
    {"volume", "--volume"},
    {"voxel_size_m", "--voxel-size"},
});

}  // namespace

std::string with_flags(const std::string& message) {
  std::string text;
  std::size_t at = 0;
  for (;;) {
    const std::size_t open = message.find('`', at);
    const std::size_t close = open == std::string::npos ? open : message.find('`', open + 1);
    if (close == std::string::npos) return text + message.substr(at);
    const std::string_view name = std::string_view(message).substr(open + 1, close - open - 1);
    const auto* const flag = std::find_if(flags.begin(), flags.end(), [&](const auto& f) { return f.first == name; });
    text += message.substr(at, open - at);
    // If the name is not a field, it may be text of a file. Its closing mark can then be the opening mark of a field.
    text += flag != flags.end() ? std::string(flag->second) : message.substr(open, close - open);
    at = flag != flags.end() ? close + 1 : close;
  }
}

}  // namespace gigabake::app
