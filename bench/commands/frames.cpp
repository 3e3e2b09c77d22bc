#include "bench/commands/frames.h"

#include <fmt/format.h>

#include "core/base/pluralize.h"

namespace gigabake::app {
namespace {

double mrays_per_s(const bench::FrameBench& b, double seconds) {
  return seconds > 0 ? 1e-6 * b.width * b.height / seconds : 0;
}

}  // namespace

void print_text(const bench::FrameBench& b) {
  fmt::print("frames of {}×{}, {}: everything filtered, from empty pools, then at rest\n\n", b.width, b.height,
             b.backend);
  if (!b.views.empty())
    fmt::print("{:<14} {:>7} {:>9} {:>11} {:>9} {:>9} {:>9} {:>9} {:>10} {:>6}\n", "view", "frames", "uploads",
               "complete, s", "frame, ms", "median", "rays, ms", "Mrays/s", "first, dB", "exact");
  for (const bench::FrameBenchView& v : b.views)
    fmt::print("{:<14} {:>7} {:>9} {:>11.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.1f} {:>10.1f} {:>6}\n", v.view,
               v.frames_to_complete, v.uploads, v.complete_s, 1e3 * v.best_s, 1e3 * v.median_s, 1e3 * v.best_cast_s,
               mrays_per_s(b, v.best_cast_s), v.first_psnr_db, v.same_as_exact ? "yes" : "NO");
  const bench::FlightTimes& f = b.flight;
  if (f.frames == 0) return;
  fmt::print(
      "\nflight of {}: median {:.2f} ms, 99 % below {:.2f} ms, worst {:.2f} ms; {}; at most {:.0f} of "
      "{:.0f} MB\nerror of its frames against exact ones: PSNR {:.1f} dB, worst {:.1f} dB\n",
      pluralize(f.frames, "frame"), 1e3 * f.median_s, 1e3 * f.p99_s, 1e3 * f.worst_s, pluralize(f.uploads, "upload"),
      double(f.peak_bytes) / 1e6, double(f.allowed_bytes) / 1e6, f.mean_psnr_db, f.worst_psnr_db);
}

nlohmann::ordered_json to_json(const bench::FrameBench& b) {
  nlohmann::ordered_json j{{"backend", b.backend}, {"width", b.width}, {"height", b.height}};
  j["views"] = nlohmann::ordered_json::array();
  for (const bench::FrameBenchView& v : b.views)
    j["views"].push_back({{"view", v.view},
                          {"frames_to_complete", v.frames_to_complete},
                          {"uploads", v.uploads},
                          {"complete_s", v.complete_s},
                          {"best_s", v.best_s},
                          {"median_s", v.median_s},
                          {"best_cast_s", v.best_cast_s},
                          {"first_psnr_db", v.first_psnr_db},
                          {"same_as_exact", v.same_as_exact},
                          {"surface_pixels", v.surface_pixels}});
  const bench::FlightTimes& f = b.flight;
  j["flight"] = {{"frames", f.frames},
                 {"median_s", f.median_s},
                 {"p99_s", f.p99_s},
                 {"worst_s", f.worst_s},
                 {"uploads", f.uploads},
                 {"peak_bytes", f.peak_bytes},
                 {"allowed_bytes", f.allowed_bytes},
                 {"mean_psnr_db", f.mean_psnr_db},
                 {"worst_psnr_db", f.worst_psnr_db},
                 {"surface_pixels", f.surface_pixels}};
  return j;
}

}  // namespace gigabake::app
