#include "bench/report/light_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gigabake::bench {

std::string to_json(const LightBench& bench) {
  nlohmann::ordered_json j{{"bench", "light"},
                           {"scene", bench.scene},
                           {"voxel_size_m", bench.voxel_size_m},
                           {"samples", bench.samples},
                           {"threads", bench.threads},
                           {"mean_flip", bench.mean_flip()},
                           {"mean_flip_without", bench.mean_flip_without()},
                           {"mean_flip_unshadowed", bench.mean_flip_unshadowed()},
                           {"time_ratio", bench.time_ratio()}};
  for (const LightRow& row : bench.rows)
    j["views"].push_back({{"view", row.view},
                          {"size", {row.width, row.height}},
                          {"compared_pixels", row.compared_pixels},
                          {"flip", row.flip},
                          {"flip_without", row.flip_without},
                          {"flip_unshadowed", row.flip_unshadowed},
                          {"frame_s", row.frame_s},
                          {"frame_without_s", row.frame_without_s}});
  return j.dump(2) + "\n";
}

std::string to_markdown(const LightBench& bench) {
  std::string out = fmt::format(
      "Light with shadows: mean FLIP {:.3f} against shadowed triangles ({} rays a pixel); without shadows in the image "
      "{:.3f}, without shadows in both {:.3f}. Frames take {:.1f} times as long as without, on {} threads.\n\n"
      "| view | pixels | of them compared | FLIP | without shadows | without in both | frame, ms | without, ms |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n",
      bench.mean_flip(), bench.samples, bench.mean_flip_without(), bench.mean_flip_unshadowed(), bench.time_ratio(),
      bench.threads);
  for (const LightRow& row : bench.rows)
    out += fmt::format("| {} | {}×{} | {} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {:.1f} |\n", row.view, row.width,
                       row.height, row.compared_pixels, row.flip, row.flip_without, row.flip_unshadowed,
                       row.frame_s * 1e3, row.frame_without_s * 1e3);
  return out;
}

}  // namespace gigabake::bench
