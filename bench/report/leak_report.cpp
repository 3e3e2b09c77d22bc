#include "bench/report/leak_report.h"

#include <algorithm>
#include <compare>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>

namespace gigabake::bench {
namespace {

using Json = nlohmann::ordered_json;

/// The minimum number of pixels for which a fraction is meaningful.
constexpr std::size_t enough_pixels = 100;

Json to_json(const LeakResult& scene) {
  Json j{{"name", scene.name},
         {"family", scene.family},
         {"what", scene.what},
         {"opaque", scene.is_opaque},
         {"voxels", scene.voxels}};
  if (!scene.not_measured.empty()) j["not_measured"] = scene.not_measured;
  j["rows"] = Json::array();
  for (const LeakRow& row : scene.rows) {
    Json one{{"elevation_deg", row.elevation_deg},
             {"voxels_per_pixel", row.voxels_per_pixel},
             {"eye", name_of(row.eye)},
             {"inner_pixels", row.error.inner}};
    if (row.error.inner > 0)
      one.update({{"below_99", row.error.below_99},
                  {"below_90", row.error.below_90},
                  {"min_alpha", row.error.minimum},
                  {"rms_alpha", row.error.rms},
                  {"bias_alpha", row.error.bias}});
    j["rows"].push_back(one);
  }
  return j;
}

/// The joint errors of several images for one table row, and the scene with the worst error.
struct Pooled {
  LeakError error;
  std::string worst;
  double worst_below_99 = 0, worst_rms = 0;

  void add(const LeakResult& scene, const LeakRow& row) {
    if (row.error.inner == 0) return;
    const bool is_worse = scene.is_opaque ? row.error.below_99 > worst_below_99 : row.error.rms > worst_rms;
    if (worst.empty() || is_worse) {
      worst = scene.name;
      worst_below_99 = row.error.below_99;
      worst_rms = row.error.rms;
    }
    error = together(error, row.error);
  }
};

using Scenes = std::vector<const LeakResult*>;

constexpr char figure_heads[] = "inner pixels | below .99, % | below .9, % | least alpha | RMS | bias |";
constexpr char figure_rules[] = "--- | --- | --- | --- | --- | --- |";

std::string figures_of(const LeakError& e) {
  if (e.inner == 0) return "0 | | | | | |";
  return fmt::format("{} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | {:+.3f} |", e.inner, 100 * e.below_99, 100 * e.below_90,
                     e.minimum, e.rms, e.bias);
}

std::string worst_of(const Pooled& pooled, bool is_opaque) {
  if (pooled.worst.empty()) return " |";
  if (is_opaque && pooled.worst_below_99 == 0) return " none leaks |";
  return is_opaque ? fmt::format(" `{}`: {:.2f} % |", pooled.worst, 100 * pooled.worst_below_99)
                   : fmt::format(" `{}`: RMS {:.3f} |", pooled.worst, pooled.worst_rms);
}

/// A key that is equal for views that differ only in the scene. Keys are ordered from vertical to grazing views, then
/// from near to far.
struct ViewKey {
  double below = 0;  ///< negative elevation
  LeakEye eye = LeakEye::anywhere;
  double voxels_per_pixel = 0;
  explicit ViewKey(const LeakRow& row)
      : below(-row.elevation_deg), eye(row.eye), voxels_per_pixel(row.voxels_per_pixel) {}
  auto operator<=>(const ViewKey&) const = default;
};

/// Returns a name like "90, on a lattice plane".
std::string view_name(const ViewKey& view) {
  return fmt::format("{:g}{}", -view.below,
                     view.eye == LeakEye::anywhere ? "" : fmt::format(", {}", name_of(view.eye)));
}

/// Returns a table with one row per view, over all scenes with this view.
std::string views_table(const Scenes& scenes) {
  std::map<ViewKey, Pooled> views;
  for (const LeakResult* scene : scenes)
    for (const LeakRow& row : scene->rows) views[ViewKey(row)].add(*scene, row);
  std::string out = fmt::format("| elevation, ° | voxels a pixel | {} worst scene |\n| --- | --- | {} --- |\n",
                                figure_heads, figure_rules);
  for (const auto& [view, pooled] : views)
    out += fmt::format("| {} | {:g} | {}{}\n", view_name(view), view.voxels_per_pixel, figures_of(pooled.error),
                       worst_of(pooled, scenes.front()->is_opaque));
  return out;
}

/// Returns a table with one row per scene, over all its views.
std::string scenes_table(const Scenes& scenes) {
  std::string out = fmt::format("| scene | description | {}\n| --- | --- | {}\n", figure_heads, figure_rules);
  for (const LeakResult* scene : scenes) {
    Pooled pooled;
    for (const LeakRow& row : scene->rows) pooled.add(*scene, row);
    const std::string figures = scene->not_measured.empty() ? figures_of(pooled.error)
                                                            : "not measured: " + scene->not_measured + " | | | | | |";
    out += fmt::format("| `{}` | {} | {}\n", scene->name, scene->what, figures);
  }
  return out;
}

std::vector<Scenes> families_of(const LeakBench& bench) {
  std::vector<Scenes> families;
  for (const LeakResult& scene : bench.scenes) {
    if (families.empty() || families.back().front()->family != scene.family) families.emplace_back();
    families.back().push_back(&scene);
  }
  return families;
}

struct WorstLeak {
  const LeakResult* scene = nullptr;
  const LeakRow* row = nullptr;
  std::size_t pictures = 0, bounded = 0;
};

WorstLeak worst_leak(const LeakBench& bench) {
  WorstLeak worst;
  const auto badness = [](const LeakError& e) { return std::pair(e.below_99, 1 - e.minimum); };
  for (const LeakResult& scene : bench.scenes)
    for (const LeakRow& row : scene.rows) {
      if (!scene.is_opaque || row.error.inner == 0) continue;
      ++worst.pictures;
      worst.bounded += is_bounded(row.error);
      if (row.error.inner < enough_pixels) continue;
      if (worst.row == nullptr || badness(row.error) > badness(worst.row->error)) {
        worst.scene = &scene;
        worst.row = &row;
      }
    }
  return worst;
}

std::string leak_columns() {
  return "- inner pixels: pixels whose 7 × 7 neighbourhood shows only the inside of the surface in the reference; the "
         "image under test does not matter\n"
         "- below .99, .9: fraction of inner pixels whose alpha is more than .01, .1 below the reference, which is 1 "
         "if the scene is opaque\n"
         "- least alpha, RMS, bias: min of alpha; RMS and mean of alpha minus the reference, over inner pixels; the "
         "RMS includes the noise of a traced reference\n"
         "- elevation: of the camera above the horizon; on a lattice plane: straight down from a height that is a "
         "multiple of 64 voxels, so that all rays sample at one phase; where levels change: a level ends and the next "
         "begins on the surface, in the middle of the image\n"
         "- voxels a pixel: width of a pixel in voxels of level 0; only views in which a scene is at least 24 pixels "
         "wide are measured: `--scene-voxels` makes scenes wider\n";
}

}  // namespace

std::string verdict(const LeakBench& bench) {
  const WorstLeak worst = worst_leak(bench);
  if (worst.row == nullptr) return "No opaque surface shows enough inner pixels to measure leaks.\n";
  const LeakError& e = worst.row->error;
  const std::string asked =
      fmt::format("required: at most {:g} % and at least {:g}", 100 * max_below_99, min_opaque_alpha);
  const std::string where = fmt::format("`{}` from {}° at {:g} voxels a pixel", worst.scene->name,
                                        worst.row->elevation_deg, worst.row->voxels_per_pixel);
  const std::string figures = fmt::format("{:.1f} % of the inner pixels are below alpha .99 and the min is {:.2f}",
                                          100 * e.below_99, e.minimum);
  if (bench.is_bounded())
    return fmt::format("Leaks are bounded in all {} images of opaque surfaces: the worst is {}, where {} ({}).\n",
                       worst.pictures, where, figures, asked);
  return fmt::format(
      "Leaks are not yet bounded: the worst is {}, where {} ({}; {} of {} images of opaque surfaces are within the "
      "bounds).\n",
      where, figures, asked, worst.bounded, worst.pictures);
}

std::string to_json(const LeakBench& bench) {
  Json j{{"bench", "accuracy --leaks"},
         {"backend", bench.backend},
         {"samples", bench.samples},
         {"bounded", bench.is_bounded()},
         {"verdict", verdict(bench)}};
  if (bench.edge > 0) j["edge_voxels"] = bench.edge;
  j["bounds"] = {{"max_below_99", max_below_99}, {"min_alpha", min_opaque_alpha}};
  j["scenes"] = Json::array();
  for (const LeakResult& scene : bench.scenes) j["scenes"].push_back(to_json(scene));
  return j.dump(2) + "\n";
}

std::string to_markdown(const LeakBench& bench) {
  const std::string scenes = bench.edge > 0 ? fmt::format("Scenes are {} voxels wide and", bench.edge) : "The scene is";
  std::string out = verdict(bench) + fmt::format("{} baked with default settings on {}.\n", scenes, bench.backend);
  for (const Scenes& family : families_of(bench)) {
    out += fmt::format("\n### {}\n\n", family.front()->family);
    const bool has_rows = std::any_of(family.begin(), family.end(), [](const auto* s) { return !s->rows.empty(); });
    if (has_rows) out += views_table(family) + "\n";
    out += scenes_table(family);
  }
  return out + "\n" + leak_columns();
}

std::string leaks_in_short(const LeakBench& bench) {
  Scenes all;
  for (const LeakResult& scene : bench.scenes) all.push_back(&scene);
  if (all.empty()) return "";
  return "\n### Leaks of a few opaque planes\n\n" + verdict(bench) + "They do not affect whether the suite holds.\n\n" +
         views_table(all) + "\n" + leak_columns();
}

}  // namespace gigabake::bench
