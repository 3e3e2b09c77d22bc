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
const AccuracySetting& minimum(const AccuracyBench& bench, double most_flip, const Value& value) {
  const AccuracySetting* found = nullptr;
  for (const AccuracySetting& s : bench.settings)
    if (s.mean.flip <= most_flip && (found == nullptr || value(s) < value(*found))) found = &s;
  return found != nullptr ? *found : bench.settings.front();
}

/// Returns text like " and meets 5 of 7 goals (not: nadir: FLIP ≤ 0.10)". Returns "" for a setting whose voxels are
/// larger than the bench's, and without images at 16 voxels per pixel.
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

Figure nearest_to_its_bound(const HardBench& bench) {
  Figure nearest;
  for (const HardResult& r : bench.cases)
    for (const HardFigure& f : r.figures) {
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
      "`{}` at {:g} m is on average FLIP {:.3f} away from pictures of the triangles (0: the same, 1: nothing alike){}. "
      "Of {} settings `{}` comes nearest (FLIP {:.3f}, {:.1f} MB), and of those within {:g} of it `{}` takes the least "
      "disk ({:.1f} MB, {:.2f} s to bake).\n",
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

std::string accuracy_columns() {
  return "- setting: surface rule, filter of coarser levels, `x2` with voxels twice as large, and what else differs\n"
         "- bake, s: from the sources to scene.xml in one process, the fastest of `--repeats`; render, s: all views\n"
         "- MB, bytes/voxel: on disk, all levels\n"
         "- FLIP: difference as an eye sees it, 0 to 1, mean over the pixels, over black or white, the worse\n"
         "- compared pixels: in which the reference shows the surface; with fewer than 4 in a view the command fails\n"
         "- PSNR, dB: of the colours over that background; more is better\n"
         "- coverage bias: mean opacity minus the reference's; above 0 the scene looks too thick\n"
         "- holes: share of light that shines through where the reference is opaque\n"
         "- IoU: of the pixels at least half covered in either picture, those covered in both; 1 is the same outline\n"
         "- RMS colour: of linear red, green, blue; ΔE: CIE76, below 2 hardly visible\n"
         "- missed, by ½, by 1: share of the surface without a voxel as near as 1/256, ½, 1 voxel\n"
         "- extra: share of voxels that no triangle touches; centre beyond ½, √3/2: whose centre is farther from the "
         "surface, in voxels; farthest: the farthest such centre\n"
         "- normal: angle to the triangle's; texels: of the source along a voxel's edge; alpha: coverage of a voxel\n"
         "- voxels a pixel, in the views' names: how many voxels of level 0 a pixel is wide\n";
}

std::string hard_columns() {
  return "- each figure: measured ≤ what is claimed at most; **fails** where it is more\n"
         "- missed: voxels that the exact reference has and the bake has not; extra: the other way round\n"
         "- alpha, colour: largest difference in codes of 255; linear colour: in linear light, codes\n"
         "- normal: largest angle; position: largest distance of a voxel's surface from the reference, and before the "
         "snap to the lattice\n"
         "- more: figures that single cases have\n";
}

}  // namespace gigabake::bench
