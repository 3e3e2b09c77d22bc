#include "app/progress.h"

#include <cstdio>
#include <fmt/format.h>

namespace gigabake::app {
namespace {

constexpr double line_every_s = 10;

}  // namespace

Progress::Progress() : line_(stderr, line_every_s), start_(std::chrono::steady_clock::now()) {}

BakeProgress Progress::callbacks() {
  BakeProgress p;
  p.opened = [this](const SceneSources& sources) { opened(sources); };
  p.surveyed = [this](std::size_t done, std::size_t all) { surveyed(done, all); };
  p.planned = [this](const BakePlan& plan) { planned(plan); };
  p.status = [this](const BakeStatus& status) { line_.show(status); };
  p.cell_done = [this](const CellReport& report, const CellJob& job) { cell_done(report, job); };
  p.noted = [this](const std::string& line) { line_.say(line); };
  return p;
}

void Progress::opened(const SceneSources& sources) {
  line_.say(fmt::format("{} content files, {}", sources.tiles.size(),
                        sources.origin
                            ? fmt::format("scene origin {:.7f}° {:.7f}° {:.2f} m", sources.origin->latitude_deg,
                                          sources.origin->longitude_deg, sources.origin->height_m)
                            : std::string("local frame")));
  for (const SkippedSource& s : sources.skipped) line_.say(fmt::format("skipped {}: {}", s.name, s.reason));
  start_ = std::chrono::steady_clock::now();
}

void Progress::surveyed(std::size_t done, std::size_t all) {
  BakeStatus status;
  status.updated_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  status.tiles_surveyed = done;
  status.tiles = all;
  line_.show(status);
}

void Progress::planned(const BakePlan& plan) {
  for (const SceneLoss& l : plan.losses) line_.say(fmt::format("lost {}: {}", l.name, l.reason));
  line_.say(fmt::format("{} triangles in {} cells", plan.triangles, plan.jobs.size()));
}

void Progress::cell_done(const CellReport& report, const CellJob& job) {
  if (report.outcome == CellOutcome::failed) line_.say(fmt::format("lost cell {}: {}", job.name, report.error));
  if (!report.note.empty()) line_.say(fmt::format("cell {}: {}", job.name, report.note));
}

}  // namespace gigabake::app
