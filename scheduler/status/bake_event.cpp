#include "scheduler/status/bake_event.h"

namespace gigabake {
namespace {

std::optional<std::string> note_of(const CellReport& report, const CellJob& job) {
  if (report.note.empty()) return std::nullopt;
  return "cell " + job.name + ": " + report.note;
}

}  // namespace

std::optional<std::string> warning_of(const BakeEvent& event) {
  if (const auto* finished = std::get_if<JobFinished>(&event)) return note_of(finished->report, finished->order);
  if (const auto* failed = std::get_if<JobQuarantined>(&event)) return note_of(failed->report, failed->job);
  if (const auto* died = std::get_if<ProcessDied>(&event))
    return "the bake process of rank " + std::to_string(died->rank) + " is started again: " + died->why;
  if (const auto* lost = std::get_if<WorkerLost>(&event))
    return "no message from rank " + std::to_string(lost->rank) + "; other ranks bake its cells";
  const auto* entered = std::get_if<StateEntered>(&event);
  if (entered != nullptr && entered->state == BakeState::draining)
    return "draining: cells in flight are finished, and no further cells are started; press Ctrl-C again to stop "
           "immediately";
  if (const auto* warning = std::get_if<WarningLine>(&event)) return warning->text;
  return std::nullopt;
}

}  // namespace gigabake
