#include "app/progress.h"

#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace gigabake::app {
namespace {

constexpr std::size_t bar_width = 30;
constexpr double seconds_between_bars = 0.1, seconds_between_lines = 10;

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

void opened(const SceneSources& sources) {
  fmt::print(stderr, "{} content files, {}\n", sources.tiles.size(),
             sources.origin ? fmt::format("scene origin {:.7f}° {:.7f}° {:.2f} m", sources.origin->latitude_deg,
                                          sources.origin->longitude_deg, sources.origin->height_m)
                            : std::string("local frame"));
  for (const SkippedSource& s : sources.skipped) fmt::print(stderr, "skipped {}: {}\n", s.name, s.reason);
}

}  // namespace

std::string readable_bytes(std::uint64_t bytes) {
  const char* const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double v = double(bytes);
  std::size_t unit = 0;
  for (; v >= 1024 && unit < 4; ++unit) v /= 1024;
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", v, units[unit]);
}

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1) { start_phase(); }

void Progress::start_phase() { start_ = last_shown_ = Clock::now(); }

BakeProgress Progress::callbacks() {
  BakeProgress p;
  p.opened = [this](const SceneSources& sources) {
    opened(sources);
    start_phase();
  };
  p.surveyed = [this](std::size_t done, std::size_t all) { show("tiles surveyed", done, all); };
  p.planned = [this](const BakePlan& plan) { planned(plan); };
  p.cell_done = [this](const CellReport& report, const CellJob& job, std::size_t done, std::size_t all) {
    cell_done(report, job, done, all);
  };
  p.noted = [this](const std::string& line) { fmt::print(stderr, "{}{}\n", terminal_ ? "\r\033[K" : "", line); };
  return p;
}

void Progress::planned(const BakePlan& plan) {
  for (const SceneLoss& l : plan.losses) fmt::print(stderr, "lost {}: {}\n", l.name, l.reason);
  fmt::print(stderr, "{} triangles in {} cells\n", plan.triangles, plan.jobs.size());
  start_phase();
}

void Progress::cell_done(const CellReport& report, const CellJob& job, std::size_t done, std::size_t all) {
  if (report.outcome == CellOutcome::failed)
    fmt::print(stderr, "{}lost cell {}: {}\n", terminal_ ? "\r\033[K" : "", job.name, report.error);
  if (!report.note.empty()) fmt::print(stderr, "{}cell {}: {}\n", terminal_ ? "\r\033[K" : "", job.name, report.note);
  show("cells", done, all);
}

void Progress::show(const char* what, std::size_t done, std::size_t all) {
  const auto now = Clock::now();
  if (done != all && seconds(now - last_shown_) < (terminal_ ? seconds_between_bars : seconds_between_lines)) return;
  last_shown_ = now;
  const double left_s = seconds(now - start_) / double(done) * double(all - done);
  if (terminal_) {
    const std::size_t filled = bar_width * done / all;
    fmt::print(stderr, "\r\033[K[{:=<{}}{: <{}}] {}/{} {}, {:.0f} s left{}", "", filled, "", bar_width - filled, done,
               all, what, left_s, done == all ? "\n" : "");
    std::fflush(stderr);
  } else {
    fmt::print(stderr, "{}/{} {}, {:.0f} s left\n", done, all, what, left_s);
  }
}

}  // namespace gigabake::app
