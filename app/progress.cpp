#include "app/progress.h"

#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace gigabake::app {
namespace {

constexpr std::size_t bar_width = 30;
constexpr double seconds_between_lines = 10;

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

std::string readable_bytes(std::uint64_t bytes) {
  const char* const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double v = double(bytes);
  std::size_t unit = 0;
  for (; v >= 1024 && unit < 4; ++unit) v /= 1024;
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", v, units[unit]);
}

Progress::Progress()
    : terminal_(::isatty(STDERR_FILENO) == 1), start_(std::chrono::steady_clock::now()), last_line_(start_) {}

BakeProgress Progress::callbacks() {
  BakeProgress p;
  p.opened = [](const SceneSources& s) {
    fmt::print(stderr, "{} content files, {}\n", s.tiles.size(),
               s.origin ? fmt::format("scene origin {:.7f}° {:.7f}° {:.2f} m", s.origin->latitude_deg,
                                      s.origin->longitude_deg, s.origin->height_m)
                        : std::string("local frame"));
    for (const SkippedSource& skipped : s.skipped)
      fmt::print(stderr, "skipped: {}: {}\n", skipped.name, skipped.reason);
  };
  p.planned = [](const BakePlan& plan) {
    fmt::print(stderr, "{} triangles in {} cells\n", plan.triangles, plan.jobs.size());
    if (plan.non_finite + plan.zero_area != 0)
      fmt::print(stderr, "dropped: {} triangles with NaN or infinite vertices, {} without area\n", plan.non_finite,
                 plan.zero_area);
    if (plan.skipped_points + plan.skipped_lines != 0)
      fmt::print(stderr, "skipped: {} points and {} lines, which have no surface\n", plan.skipped_points,
                 plan.skipped_lines);
  };
  p.cell_done = [this](const CellReport& r, const CellJob& j, std::size_t done, std::size_t all) {
    cell_done(r, j, done, all);
  };
  return p;
}

void Progress::cell_done(const CellReport& report, const CellJob& job, std::size_t done, std::size_t all) {
  if (report.outcome == CellOutcome::failed)
    fmt::print(stderr, "{}cell {} failed: {}\n", terminal_ ? "\r\033[K" : "", job.name, report.error);
  const auto now = std::chrono::steady_clock::now();
  const double left_s = seconds(now - start_) / double(done) * double(all - done);
  if (terminal_) {
    const std::size_t filled = bar_width * done / all;
    fmt::print(stderr, "\r\033[K[{:=<{}}{: <{}}] {}/{} cells, {:.0f} s left{}", "", filled, "", bar_width - filled,
               done, all, left_s, done == all ? "\n" : "");
    std::fflush(stderr);
  } else if (done == all || seconds(now - last_line_) > seconds_between_lines) {
    fmt::print(stderr, "{}/{} cells, {:.0f} s left\n", done, all, left_s);
    last_line_ = now;
  }
}

}  // namespace gigabake::app
