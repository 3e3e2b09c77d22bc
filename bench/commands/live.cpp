#include "bench/commands/live.h"

#include <algorithm>
#include <fmt/format.h>

namespace gigabake::app {
namespace {

/// The numbers of listed frames: the first frames, and then about `listed_then` frames spread over all frames.
constexpr std::size_t listed_first = 6, listed_then = 10;

}  // namespace

void print_text(const bench::LiveBench& b) {
  fmt::print("interactive viewer, {}x{}: each frame until the image is complete, compared with the last frame\n\n",
             b.width, b.height);
  fmt::print("{:>8} {:>12} {:>9} {:>12}\n", "after, s", "pixels", "holes, %", "mean error");
  const std::size_t step = std::max<std::size_t>(1, b.frames.size() / listed_then);
  for (std::size_t i = 0; i < b.frames.size(); ++i) {
    const bench::LiveBenchFrame& f = b.frames[i];
    if (i >= listed_first && i % step != 0 && i + 1 != b.frames.size()) continue;
    fmt::print("{:>8.2f} {:>12} {:>9.2f} {:>12.2f}\n", f.at_s, fmt::format("{}x{}", f.width, f.height), 100 * f.holes,
               f.mean_error);
  }
  fmt::print("\ncomplete after {:.2f} s; render takes {:.2f} s for the same image: {}\n", b.rest_s, b.render_s,
             b.same_as_rendered ? "equal bytes" : "bytes DIFFER");
  fmt::print("a movement during a full frame shows after {:.0f} ms (median), {:.0f} ms (max)\n",
             1e3 * b.median_answer_s, 1e3 * b.worst_answer_s);
  fmt::print("closing during a full frame takes {:.0f} ms\n", 1e3 * b.close_s);
}

nlohmann::ordered_json to_json(const bench::LiveBench& b) {
  nlohmann::ordered_json j{{"width", b.width},
                           {"height", b.height},
                           {"rest_s", b.rest_s},
                           {"render_s", b.render_s},
                           {"median_answer_s", b.median_answer_s},
                           {"worst_answer_s", b.worst_answer_s},
                           {"close_s", b.close_s},
                           {"same_as_rendered", b.same_as_rendered},
                           {"surface_pixels", b.surface_pixels}};
  j["frames"] = nlohmann::ordered_json::array();
  for (const bench::LiveBenchFrame& f : b.frames)
    j["frames"].push_back(
        {{"at_s", f.at_s}, {"width", f.width}, {"height", f.height}, {"holes", f.holes}, {"mean_error", f.mean_error}});
  return j;
}

}  // namespace gigabake::app
