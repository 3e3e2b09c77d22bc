#include "bench/report/accuracy_verdict.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "bench/report/accuracy_report.h"

namespace gigabake::bench {
namespace {

/// An increase of FLIP that is hardly visible.
constexpr double as_good_flip = 0.01;

template <class Value>
const AccuracySetting& minimum(const AccuracyBench& bench, double max_flip, const Value& value) {
  const AccuracySetting* found = nullptr;
  for (const AccuracySetting& s : bench.settings)
    if (s.mean.flip <= max_flip && (found == nullptr || value(s) < value(*found))) found = &s;
  return found != nullptr ? *found : bench.settings.front();
}

/// Returns text like " and meets 5 of 7 goals (not: nadir: FLIP ≤ 0.10)". Returns "" if the setting's voxels are larger
/// than the benchmark's voxel size, or if there are no images at 16 voxels per pixel.
std::string goals_met(const AccuracySetting& setting, const AccuracyBench& bench) {
  if (setting.parameters.voxel_size_m != bench.voxel_size_m) return "";
  const std::vector<AccuracyGoal> goals = goals_of(setting);
  if (goals.empty()) return "";
  std::string missed;
  for (const AccuracyGoal& goal : goals)
    if (!goal.holds()) missed += (missed.empty() ? " (not: " : "; ") + goal.text;
  const auto met = std::count_if(goals.begin(), goals.end(), [](const AccuracyGoal& g) { return g.holds(); });
  return fmt::format(" and meets {} of {} goals{}", met, goals.size(), missed.empty() ? "" : missed + ")");
}

struct Figure {
  const HardResult* result = nullptr;
  const HardFigure* figure = nullptr;
  /// Returns the ratio to the bound. If the bound is 0, returns 0 when it holds and infinity otherwise.
  double share() const {
    if (figure->bound > 0) return figure->measured / figure->bound;
    return figure->measured > 0 ? HUGE_VAL : 0;
  }
};

/// Ignores values with a goal whose bound holds: their bounds are the values reached, so that all are near.
Figure nearest_to_its_bound(const HardBench& bench) {
  Figure nearest;
  for (const HardResult& r : bench.cases)
    for (const HardFigure& f : r.figures) {
      if (f.goal && f.holds()) continue;
      const Figure here{&r, &f};
      if (nearest.figure == nullptr || here.share() > nearest.share()) nearest = here;
    }
  return nearest;
}

}  // namespace

std::string verdict(const AccuracyBench& bench) {
  if (bench.settings.empty()) return "";
  const AccuracySetting& first = bench.settings.front();
  const auto flip = [](const AccuracySetting& s) { return s.mean.flip; };
  const auto bytes = [](const AccuracySetting& s) { return double(s.bytes); };
  const AccuracySetting& nearest = minimum(bench, HUGE_VAL, flip);
  const AccuracySetting& min_bytes = minimum(bench, nearest.mean.flip + as_good_flip, bytes);
  return fmt::format(
      "`{}` at {:g} m has a mean FLIP of {:.3f} to images of the triangles (0: equal, 1: nothing in common){}. "
      "Of {} settings `{}` has the smallest error (FLIP {:.3f}, {:.1f} MB); of the settings within {:g} of it `{}` "
      "takes the least disk ({:.1f} MB, {:.2f} s to bake).\n",
      first.name, first.parameters.voxel_size_m, first.mean.flip, goals_met(first, bench), bench.settings.size(),
      nearest.name, nearest.mean.flip, 1e-6 * bytes(nearest), as_good_flip, min_bytes.name, 1e-6 * bytes(min_bytes),
      min_bytes.bake_s);
}

std::string verdict(const HardBench& bench) {
  const auto failed =
      std::count_if(bench.cases.begin(), bench.cases.end(), [](const HardResult& r) { return !r.holds(); });
  std::string text =
      failed == 0 ? fmt::format("In all {} hard cases every claimed bound holds.", bench.cases.size())
                  : fmt::format("In {} of {} hard cases a claimed bound does not hold.", failed, bench.cases.size());
  const Figure nearest = nearest_to_its_bound(bench);
  if (nearest.figure == nullptr) return text + " Nothing could be measured.\n";
  return text + fmt::format(" {} its bound {} {} of `{}`: {:.3g} of {:.3g}{}.\n",
                            nearest.figure->holds() ? "Nearest to" : "Farthest beyond",
                            nearest.figure->holds() ? "comes" : "is", nearest.figure->name, nearest.result->name,
                            nearest.figure->measured, nearest.figure->bound,
                            nearest.figure->unit.empty() ? "" : " " + nearest.figure->unit);
}

std::string goals_verdict(const HardBench& bench) {
  int goals = 0, met = 0;
  for (const HardResult& r : bench.cases)
    for (const HardFigure& f : r.figures) {
      if (!f.goal) continue;
      ++goals;
      met += f.goal->contains(f.measured) ? 1 : 0;
    }
  return fmt::format("{} of {} values meet their goal (bold). The bound of each other value is the value reached.\n",
                     met, goals);
}

std::string accuracy_columns() {
  return "- setting: surface rule, filter of coarser levels, `x2` with voxels twice as large, and other differences\n"
         "- bake, s: from the sources to scene.xml in one process, the fastest of `--repeats`; render, s: all views\n"
         "- MB, bytes/voxel: on disk, all levels\n"
         "- FLIP: perceived difference, 0 to 1, mean over the pixels; the larger one of a black and a white "
         "background\n"
         "- compared pixels: in which the reference shows the surface; with fewer than 4 in a view the command fails\n"
         "- PSNR, dB: of the colours over that background; higher is better\n"
         "- coverage bias: mean opacity minus the reference's; above 0 the scene looks too thick\n"
         "- holes: fraction of light that passes where the reference is opaque\n"
         "- IoU: of the pixels that are at least half covered in either image, the fraction covered in both; 1: equal "
         "outlines\n"
         "- RMS colour: of linear red, green, blue; ΔE: CIE76, below 2 hardly visible\n"
         "- missed, by ½, by 1: fraction of the surface without a voxel within 1/256, ½, 1 voxel\n"
         "- extra: fraction of voxels that no triangle touches; centre beyond ½, √3/2: fraction of voxels whose centre "
         "has a larger distance to the surface, in voxels; farthest: max distance of a centre\n"
         "- normal: angle to the triangle's; texels: of the source along a voxel's edge; alpha: coverage of a voxel\n"
         "- voxels a pixel, in the views' names: width of a pixel in voxels of level 0\n";
}

std::string hard_columns() {
  return "- each number: measured ≤ claimed bound; **fails** if it is larger\n"
         "- missed: voxels of the exact reference that the bake lacks; extra: voxels of the bake that the reference "
         "lacks\n"
         "- alpha, colour: largest difference in codes of 255; linear colour: in linear light, codes\n"
         "- normal: largest angle; position: largest distance of a voxel's surface from the reference, and before the "
         "snap to the lattice\n"
         "- more: numbers of single cases\n";
}

std::string goals_columns() {
  return "- area at N: covered area divided by the area of the exact silhouettes, at N voxels per pixel; the worst "
         "from "
         "90°, 35° and 10° above the horizon\n"
         "- normals beyond 30°: fraction of voxels whose normal is more than 30° from the wall's axis\n"
         "- light: mean difference from the light of the wall's side, on both sides; stripes: fraction of pixels that "
         "differ by more than 3 codes\n"
         "- sunlit inside: fraction of what an eye inside of a closed house sees\n"
         "- bound: the goal, or the value reached if the goal is not met; **bold** numbers meet the goal\n";
}

}  // namespace gigabake::bench
