#include "bench/report/motion_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gigabake::bench {
namespace {

nlohmann::ordered_json figures_json(const MotionFigures& f) {
  return {{"pair", f.pair}, {"worst_block", f.worst_block}, {"still", f.still}};
}

std::string figures_text(const MotionFigures& f, double reference) {
  return fmt::format("{:.4f}; {:.2f}; {:.3f}; {:.3f}", f.pair, reference > 0 ? f.pair / reference : 0, f.worst_block,
                     f.still);
}

}  // namespace

std::string to_json(const MotionBench& bench) {
  nlohmann::ordered_json j{{"bench", "motion"},
                           {"scene", bench.scene},
                           {"voxel_size_m", bench.voxel_size_m},
                           {"samples", bench.samples},
                           {"size", {bench.width, bench.height}},
                           {"threads", bench.threads},
                           {"worst_ratio", bench.worst_ratio(&MotionRow::plain)},
                           {"worst_ratio_blended", bench.worst_ratio(&MotionRow::blended)},
                           {"mean_still", bench.mean_still(&MotionRow::plain)},
                           {"mean_still_blended", bench.mean_still(&MotionRow::blended)}};
  for (const MotionRow& row : bench.rows)
    j["pairs"].push_back({{"path", row.path},
                          {"at", row.at},
                          {"compared_pixels", row.compared_pixels},
                          {"reference", row.reference},
                          {"plain", figures_json(row.plain)},
                          {"blended", figures_json(row.blended)}});
  return j.dump(2) + "\n";
}

std::string to_markdown(const MotionBench& bench) {
  std::string out = fmt::format(
      "Frames {} of a pixel apart, {}×{}, {} rays a pixel of the reference. The worst pair differs by {:.2f} times the "
      "difference of triangles, and by {:.2f} times with blended levels; stills against triangles: mean FLIP {:.4f} "
      "and "
      "{:.4f}.\n\n"
      "| path | compared pixels | triangles differ by | voxels: FLIP; ratio; worst block; still | levels blended: "
      "likewise |\n"
      "| --- | --- | --- | --- | --- |\n",
      motion_pixels, bench.width, bench.height, bench.samples, bench.worst_ratio(&MotionRow::plain),
      bench.worst_ratio(&MotionRow::blended), bench.mean_still(&MotionRow::plain),
      bench.mean_still(&MotionRow::blended));
  for (const MotionRow& row : bench.rows)
    out += fmt::format("| {} {:.1f} | {} | {:.4f} | {} | {} |\n", row.path, row.at, row.compared_pixels, row.reference,
                       figures_text(row.plain, row.reference), figures_text(row.blended, row.reference));
  return out;
}

}  // namespace gigabake::bench
