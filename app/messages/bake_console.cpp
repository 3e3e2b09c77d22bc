#include "app/messages/bake_console.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <utility>

#include "app/options/flags.h"
#include "core/base/pluralize.h"

namespace gigabake::app {
namespace {

constexpr double line_every_s = 10;
constexpr std::size_t warnings_printed = 5;

}  // namespace

BakeConsole::BakeConsole(std::FILE* steps, StopCallbacks stop)
    : steps_(steps, std::move(stop)), line_(stderr, line_every_s) {}

BakeProgress BakeConsole::progress() {
  return {steps_.progress(), [this](const BakeEvent& event) { take(event); }};
}

void BakeConsole::take(const BakeEvent& event) {
  if (const auto* source = std::get_if<SourceOpened>(&event)) opened(source->sources);
  if (const auto* jobs = std::get_if<JobsPlanned>(&event)) planned(jobs->plan);
  if (const auto* info = std::get_if<InfoLine>(&event)) say(info->text);
  if (const auto warning = warning_of(event)) note(*warning);
  if (const auto* updated = std::get_if<StatusUpdated>(&event)) {
    steps_.end_step();
    line_.show(updated->status);
  }
}

/// Prints a line. Ends the line of the steps first, because the displays of steps and cells share a terminal.
void BakeConsole::say(const std::string& line) {
  steps_.end_step();
  line_.say(with_flags(line));
}

void BakeConsole::opened(const SceneSources& sources) {
  say(fmt::format("{}, {}", pluralize(sources.tiles.size(), "content file"),
                  sources.origin ? fmt::format("scene origin at latitude {:.7f}°, longitude {:.7f}°, height {:.2f} m",
                                               sources.origin->latitude_deg, sources.origin->longitude_deg,
                                               sources.origin->height_m)
                                 : std::string("local frame")));
  for (const std::string& note : sources.notes) say(note);
  std::size_t informative = 0;
  for (const SkippedSource& s : sources.skipped)
    if (s.informative && ++informative <= warnings_printed) say(fmt::format("skipped {}: {}", s.name, s.reason));
  if (informative > warnings_printed) say(fmt::format("skipped likewise: {} more", informative - warnings_printed));
}

void BakeConsole::planned(const BakePlan& plan) {
  const std::size_t printed = std::min(plan.warnings.size(), warnings_printed);
  for (std::size_t i = 0; i < printed; ++i) say("warning: " + plan.warnings[i]);
  if (printed < plan.warnings.size()) say(fmt::format("warning: likewise {} more", plan.warnings.size() - printed));
  if (plan.jobs.empty()) return;  // the caller reports the error
  say(fmt::format("{} in {}", pluralize(plan.triangles, "triangle"), pluralize(plan.cells(), "cell")));
  if (!plan.losses.empty())
    say(fmt::format("{} missing, not readable or not whole; the last lines list {}",
                    pluralize(plan.losses.size(), "source is", "sources are"),
                    plan.losses.size() == 1 ? "it" : "them"));
}

void BakeConsole::note(const std::string& line) {
  const std::string shown = similar_lines_.pass(line);
  if (!shown.empty()) say(shown);
}

}  // namespace gigabake::app
