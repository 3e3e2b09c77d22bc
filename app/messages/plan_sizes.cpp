#include "app/messages/plan_sizes.h"

#include <cmath>
#include <fmt/format.h>

#include "app/messages/status_text.h"
#include "app/options/flags.h"
#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"

namespace gigabake::app {
namespace {

constexpr std::size_t asked = 1;  // index of the requested size in PlanMeasure::sizes

std::optional<double> seconds_of(const MeasuredSize& size, const PlanSizes& sizes) {
  if (!size.estimate.bake_s) return std::nullopt;
  return *size.estimate.bake_s + sizes.scan_s;
}

std::string workers(const PlanMeasure& m) {
  return m.ranks == 1 ? pluralize(m.threads, "thread")
                      : fmt::format("{} ranks × {}", m.ranks, pluralize(m.threads, "thread"));
}

std::string row(const MeasuredSize& size, bool is_asked, const PlanSizes& sizes) {
  const std::optional<double> seconds = seconds_of(size, sizes);
  return fmt::format("  {:>10} {:>12} {:>14}   {}{}\n", fmt::format("{:g} m", size.voxel_size_m),
                     readable_count(double(size.estimate.voxels_lod0)), readable_bytes(size.estimate.bytes),
                     seconds ? "about " + readable_seconds(*seconds) : "not measured",
                     is_asked ? "   <- requested" : "");
}

/// Returns the basis of the numbers: the area only, or baked sample cells.
std::string basis(const MeasuredSize& size, const PlanSizes& sizes) {
  if (size.pieces == 0)
    return size.problem.empty()
               ? std::string("from the surface's area only, nothing was baked; real bakes may differ by half\n")
               : fmt::format("from the surface's area only, because nothing could be measured: {}\n",
                             with_flags(size.problem));
  std::string text =
      fmt::format("measured: {} of {} baked in {:.1f} s by one rank on {}, {:.1f} % of the surface",
                  pluralize(size.pieces, "piece"), pluralize(size.tiles, "tile"), size.wall_s,
                  size.on_device ? "its GPU" : pluralize(sizes.measure.threads, "thread"), 100 * size.estimate.share);
  if (size.estimate.share < 1) text += fmt::format("; voxels ± {:.0f} %", std::ceil(200 * size.estimate.voxels_error));
  return text + (size.problem.empty() ? "\n" : fmt::format("; stopped early: {}\n", with_flags(size.problem)));
}

std::string suggestion(const PlanSizes& sizes) {
  const double texel_m = sizes.measure.textures.texel_m;
  if (texel_m <= 0) return "";
  const double wanted_m = round_size(texel_m), asked_m = sizes.measure.sizes[asked].voxel_size_m;
  const char* verdict = asked_m > 1.5 * wanted_m   ? "coarser voxels lose some of it"
                        : asked_m < wanted_m / 1.5 ? "finer voxels sharpen shapes, not colours"
                                                   : "this is the requested size";
  return fmt::format("texels of the textures are about {:.2g} m: voxels of {:g} m show their full detail; {}\n",
                     texel_m, wanted_m, verdict);
}

/// Returns the scratch space that the bake needs on disk; empty if all data fits into memory.
std::string scratch_line(const PlanMeasure& m) {
  const std::optional<std::uint64_t>& textures = m.textures.scratch_bytes;
  std::string line;
  if (m.scratch.tiles != 0) line = describe_scratch(m.scratch);
  if (textures.value_or(0) != 0)
    line += (line.empty() ? "about " : " and ") + readable_size(*textures) +
            (line.empty() ? " of scratch for large textures" : " for large textures");
  if (line.empty()) return "";
  line += " in " + m.scratch_folder.string() + " while cells are baked";
  return line + (textures ? "\n" : ", and 7 bytes per texel of large textures\n");
}

void add_scratch(const PlanMeasure& m, nlohmann::ordered_json& j) {
  nlohmann::ordered_json& out = j["scratch"];
  out = {{"folder", m.scratch_folder.string()},
         {"large_tiles", m.scratch.tiles},
         {"tile_bytes", m.scratch.bytes},
         {"texture_bytes", nullptr},
         {"bytes", m.scratch.bytes + m.textures.scratch_bytes.value_or(0)}};
  if (m.textures.scratch_bytes) out["texture_bytes"] = *m.textures.scratch_bytes;
}

}  // namespace

std::string sizes_text(const PlanSizes& sizes) {
  const PlanMeasure& m = sizes.measure;
  std::string text = fmt::format("  {:>10} {:>12} {:>14}   time with {}\n", "voxel size", "voxels", "disk", workers(m));
  for (std::size_t i = 0; i < m.sizes.size(); ++i) text += row(m.sizes[i], i == asked, sizes);
  return text + basis(m.sizes[asked], sizes) + scratch_line(m) + suggestion(sizes);
}

void add_sizes(const PlanSizes& sizes, nlohmann::ordered_json& j) {
  const PlanMeasure& m = sizes.measure;
  j["sizes"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < m.sizes.size(); ++i) {
    const MeasuredSize& size = m.sizes[i];
    nlohmann::ordered_json one{{"voxel_size_m", size.voxel_size_m},
                               {"asked", i == asked},
                               {"voxels_lod0", size.estimate.voxels_lod0},
                               {"voxels", size.estimate.voxels},
                               {"bytes", size.estimate.bytes},
                               {"seconds", nullptr},
                               {"voxels_error", size.estimate.voxels_error},
                               {"pieces", size.pieces},
                               {"tiles", size.tiles},
                               {"surface_share", size.estimate.share},
                               {"measured_s", size.wall_s},
                               {"on_device", size.on_device}};
    if (const auto seconds = seconds_of(size, sizes)) one["seconds"] = *seconds;
    if (!size.problem.empty()) one["problem"] = size.problem;
    j["sizes"].push_back(one);
  }
  j["survey_s"] = sizes.scan_s;
  j["ranks"] = m.ranks;
  j["threads"] = m.threads;
  j["texel_m"] = nullptr;
  j["suggested_voxel_size_m"] = nullptr;
  if (const double texel_m = m.textures.texel_m; texel_m > 0) {
    j["texel_m"] = texel_m;
    j["suggested_voxel_size_m"] = round_size(texel_m);
  }
  add_scratch(m, j);
}

}  // namespace gigabake::app
