#include "app/messages/bake_console.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <utility>

#include "app/options/flags.h"
#include "core/base/counted.h"

namespace gigabake::app {
namespace {

constexpr double line_every_s = 10;
constexpr std::size_t warnings_printed = 5;

}  // namespace

BakeConsole::BakeConsole(std::FILE* steps, StopCallbacks stop)
    : steps_(steps, std::move(stop)), line_(stderr, line_every_s), start_(std::chrono::steady_clock::now()) {}

BakeProgress BakeConsole::callbacks() {
  BakeProgress p;
  p.steps = steps_.progress();
  p.opened = [this](const SceneSources& sources) { opened(sources); };
  p.scanned = [this](std::size_t done, std::size_t all) { scanned(done, all); };
  p.planned = [this](const BakePlan& plan) { planned(plan); };
  p.status = [this](const BakeStatus& status) {
    steps_.end_step();
    line_.show(status);
  };
  p.cell_done = [this](const CellReport& report, const CellJob& job) { cell_done(report, job); };
  p.info = [this](const std::string& line) { say(line); };
  p.warning = [this](const std::string& line) { note(line); };
  return p;
}

/// Ends the steps' line first, because both lines share a terminal.
void BakeConsole::say(const std::string& line) {
  steps_.end_step();
  line_.say(with_flags(line));
}

void BakeConsole::opened(const SceneSources& sources) {
  say(fmt::format("{}, {}", counted(sources.tiles.size(), "content file"),
                  sources.origin ? fmt::format("scene origin at latitude {:.7f}°, longitude {:.7f}°, height {:.2f} m",
                                               sources.origin->latitude_deg, sources.origin->longitude_deg,
                                               sources.origin->height_m)
                                 : std::string("local frame")));
  for (const std::string& note : sources.notes) say(note);
  std::size_t informative = 0;
  for (const SkippedSource& s : sources.skipped)
    if (s.informative && ++informative <= warnings_printed) say(fmt::format("skipped {}: {}", s.name, s.reason));
  if (informative > warnings_printed) say(fmt::format("skipped likewise: {} more", informative - warnings_printed));
  start_ = std::chrono::steady_clock::now();
}

void BakeConsole::scanned(std::size_t done, std::size_t all) {
  steps_.end_step();
  BakeStatus status;
  status.updated_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  status.tiles_scanned = done;
  status.tiles = all;
  line_.show(status);
}

void BakeConsole::planned(const BakePlan& plan) {
  const std::size_t printed = std::min(plan.warnings.size(), warnings_printed);
  for (std::size_t i = 0; i < printed; ++i) say("warning: " + plan.warnings[i]);
  if (printed < plan.warnings.size()) say(fmt::format("warning: likewise {} more", plan.warnings.size() - printed));
  if (plan.jobs.empty()) return;  // the caller reports the error
  say(fmt::format("{} in {}", counted(plan.triangles, "triangle"), counted(plan.cells(), "cell")));
  if (!plan.losses.empty())
    say(fmt::format("{} missing, not readable or not whole; the last lines list {}",
                    counted(plan.losses.size(), "source is", "sources are"), plan.losses.size() == 1 ? "it" : "them"));
}

void BakeConsole::cell_done(const CellReport& report, const CellJob& job) {
  if (!report.note.empty()) note(fmt::format("cell {}: {}", job.name, report.note));
}

void BakeConsole::note(const std::string& line) {
  const std::string shown = similar_lines_.pass(line);
  if (!shown.empty()) say(shown);
}

}  // namespace gigabake::app
