#include "bench/report/accuracy_report.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/report/accuracy_verdict.h"

namespace gigabake::bench {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const PictureError& e) {
  return {{"psnr_black_db", e.psnr_black_db},
          {"psnr_white_db", e.psnr_white_db},
          {"silhouette_iou", e.silhouette_iou},
          {"coverage_bias", e.coverage_bias},
          {"holes", e.holes},
          {"rms_colour", e.rms_colour},
          {"delta_e", e.delta_e},
          {"flip", e.flip}};
}

Json to_json(const VoxelError& e) {
  return {{"points", e.points},
          {"missed", e.missed},
          {"missed_by_half", e.missed_by_half},
          {"missed_by_one", e.missed_by_one},
          {"voxels", e.voxels},
          {"extra", e.extra},
          {"beyond_half", e.beyond_half},
          {"beyond_whole", e.beyond_whole},
          {"farthest", e.max_distance},
          {"normal_deg", e.normal_deg},
          {"normal_99_deg", e.normal_99_deg},
          {"coloured", e.coloured},
          {"texels", e.texels},
          {"alpha_bias", e.alpha_bias},
          {"rms_alpha", e.rms_alpha},
          {"rms_colour", e.rms_colour},
          {"delta_e", e.delta_e}};
}

Json to_json(const AccuracySetting& s) {
  Json j{{"name", s.name},
         {"surface", s.surface},
         {"mip", s.mip},
         {"normals", s.parameters.normals},
         {"facing", has_directional_coverage(s.parameters)},
         {"max_error", s.parameters.max_error},
         {"codec", name_of(s.parameters.codec)},
         {"voxel_size_m", s.parameters.voxel_size_m},
         {"bake_s", s.bake_s},
         {"voxels", s.voxels},
         {"voxels_per_s", s.voxels_per_s()},
         {"bytes", s.bytes},
         {"bytes_per_voxel", s.bytes_per_voxel()},
         {"render_s", s.render_s},
         {"bytes_held", s.bytes_held},
         {"mean", to_json(s.mean)},
         {"voxel_error", to_json(s.voxel)}};
  for (const ViewError& view : s.views) {
    Json one = to_json(view.error);
    one["view"] = view.view;
    one["compared_pixels"] = view.compared_pixels;
    one["render_s"] = view.render_s;
    if (view.lit_flip) one["lit_flip"] = *view.lit_flip;
    j["views"].push_back(one);
  }
  return j;
}

std::string errors_row(const PictureError& e) {
  return fmt::format("{:.3f} | {:.1f} | {:.1f} | {:+.3f} | {:.3f} | {:.3f} | {:.3f} | {:.1f}", e.flip, e.psnr_black_db,
                     e.psnr_white_db, e.coverage_bias, e.holes, e.silhouette_iou, e.rms_colour, e.delta_e);
}
constexpr char error_heads[] = "FLIP | PSNR black, dB | white, dB | coverage bias | holes | IoU | RMS colour | ΔE";
constexpr char error_rules[] = "--- | --- | --- | --- | --- | --- | --- | ---";

const ViewError& at(const AccuracySetting& setting, const std::string& view) {
  return *std::find_if(setting.views.begin(), setting.views.end(), [&](const ViewError& v) { return v.view == view; });
}

std::string settings_table(const AccuracyBench& bench) {
  std::string out = fmt::format(
      "| setting | bake, s | million voxels/s | voxels | MB | bytes/voxel | render, s | {} |\n"
      "| --- | --- | --- | --- | --- | --- | --- | {} |\n",
      error_heads, error_rules);
  for (const AccuracySetting& s : bench.settings)
    out += fmt::format("| {} | {:.2f} | {:.2f} | {} | {:.2f} | {:.2f} | {:.2f} | {} |\n", s.name, s.bake_s,
                       1e-6 * s.voxels_per_s(), s.voxels, 1e-6 * double(s.bytes), s.bytes_per_voxel(), s.render_s,
                       errors_row(s.mean));
  return out;
}

/// Returns the table of lod-0 voxels, one row per setting with different voxels. A filter, a codec or directional
/// coverage changes no lod-0 voxel.
std::string voxels_table(const AccuracyBench& bench) {
  std::string out =
      "| lod 0 | missed | by ½ | by 1 | extra | centre beyond ½ | beyond √3/2 | farthest | normal, mean; 99 %, ° | "
      "texels | alpha bias | RMS alpha | RMS colour | ΔE |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const AccuracySetting& s : bench.settings) {
    const VoxelError& e = s.voxel;
    if (s.mip != "coverage" || s.parameters.codec != Codec::deflate || !has_directional_coverage(s.parameters))
      continue;
    const std::string normal = s.parameters.normals ? fmt::format("{:.2f}; {:.1f}", e.normal_deg, e.normal_99_deg) : "";
    out += fmt::format(
        "| {} | {:.5f} | {:.5f} | {:.5f} | {:.5f} | {:.3f} | {:.5f} | {:.3f} | {} | {:.2f} | {:+.4f} | {:.4f} | {:.4f} "
        "| {:.2f} |\n",
        s.name, e.missed, e.missed_by_half, e.missed_by_one, e.extra, e.beyond_half, e.beyond_whole, e.max_distance,
        normal, e.texels, e.alpha_bias, e.rms_alpha, e.rms_colour, e.delta_e);
  }
  const VoxelError& first = bench.settings.front().voxel;
  return out + fmt::format("\nOf {}: {} points of the surface, {} voxels, {} of them with surface to compare.\n",
                           bench.settings.front().name, first.points, first.voxels, first.coloured);
}

std::string views_table(const AccuracySetting& setting) {
  std::string out =
      fmt::format("| {}, view and voxels a pixel | compared pixels | render, s | {} |\n| --- | --- | --- | {} |\n",
                  setting.name, error_heads, error_rules);
  for (const ViewError& v : setting.views)
    out += fmt::format("| {} | {} | {:.2f} | {} |\n", v.view, v.compared_pixels, v.render_s, errors_row(v.error));
  return out;
}

/// Returns the table of lit images, for views whose voxels are larger than pixels.
std::string lit_table(const AccuracyBench& bench) {
  std::string heads = "| lit FLIP, view and voxels a pixel |", rules = "| --- |", out;
  for (const AccuracySetting& s : bench.settings) heads += " " + s.name + " |", rules += " --- |";
  for (const ViewError& first : bench.settings.front().views) {
    if (!first.lit_flip) continue;
    out += "| " + first.view + " |";
    for (const AccuracySetting& s : bench.settings) out += fmt::format(" {:.4f} |", *at(s, first.view).lit_flip);
    out += "\n";
  }
  return heads + "\n" + rules + "\n" + out;
}

std::string goals_table(const AccuracyBench& bench) {
  std::string heads = "| lod 4, a voxel a pixel |", rules = "| --- |";
  std::vector<std::string> rows;
  for (const AccuracySetting& s : bench.settings) {
    if (s.parameters.voxel_size_m != bench.voxel_size_m || s.name != s.surface + "-" + s.mip) continue;
    heads += " " + s.name + " |";
    rules += " --- |";
    const std::vector<AccuracyGoal> goals = goals_of(s);
    rows.resize(goals.size());
    for (std::size_t i = 0; i < goals.size(); ++i) {
      if (rows[i].empty()) rows[i] = "| " + goals[i].text + " |";
      rows[i] += fmt::format(" {:.3f}{} |", goals[i].measured, goals[i].holds() ? " ✓" : "");
    }
  }
  if (rows.empty()) return "";
  std::string out = heads + "\n" + rules + "\n";
  for (const std::string& row : rows) out += row + "\n";
  return out;
}

}  // namespace

std::vector<AccuracyGoal> goals_of(const AccuracySetting& setting) {
  constexpr double max_holes = 0.02, max_bias = 0.02, max_flip = 0.10;
  if (std::none_of(setting.views.begin(), setting.views.end(), [](const ViewError& v) { return v.view == "nadir 16"; }))
    return {};
  std::vector<AccuracyGoal> goals{{"nadir: holes ≤ 0.02", at(setting, "nadir 16").error.holes, max_holes}};
  for (const char* direction : {"nadir", "oblique", "grazing"})
    goals.push_back({std::string(direction) + ": coverage bias within ±0.02",
                     std::fabs(at(setting, std::string(direction) + " 16").error.coverage_bias), max_bias});
  for (const char* direction : {"nadir", "oblique", "grazing"})
    goals.push_back(
        {std::string(direction) + ": FLIP ≤ 0.10", at(setting, std::string(direction) + " 16").error.flip, max_flip});
  return goals;
}

std::string to_json(const AccuracyBench& bench) {
  Json j{{"bench", "accuracy"},       {"backend", bench.backend}, {"voxel_size_m", bench.voxel_size_m},
         {"verdict", verdict(bench)}, {"samples", bench.samples}, {"reference_s", bench.reference_s}};
  for (const AccuracyView& v : bench.views)
    j["views"].push_back({{"name", v.name()},
                          {"direction", v.direction},
                          {"voxels_per_pixel", v.voxels_per_pixel},
                          {"width", v.camera.width},
                          {"height", v.camera.height}});
  for (const AccuracySetting& s : bench.settings) j["settings"].push_back(to_json(s));
  for (const AccuracyGoal& goal : goals_of(bench.settings.front()))
    j["goals"].push_back(
        {{"goal", goal.text}, {"measured", goal.measured}, {"bound", goal.bound}, {"holds", goal.holds()}});
  return j.dump(2) + "\n";
}

std::string to_markdown(const AccuracyBench& bench) {
  return verdict(bench) + "\n" +
         fmt::format(
             "Means over {} views, {:g} m voxels, {} rays a pixel in the reference; the bias is its magnitude.\n\n",
             bench.views.size(), bench.voxel_size_m, bench.samples) +
         settings_table(bench) + "\n" + voxels_table(bench) + "\n" + views_table(bench.settings.front()) + "\n" +
         lit_table(bench) + "\n" + goals_table(bench) + "\n" + accuracy_columns();
}

}  // namespace gigabake::bench
