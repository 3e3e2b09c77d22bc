/// Events of a bake: the only channel from a bake to its status files, metrics, reports and console.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "format/job/cell_job.h"
#include "format/source/source.h"
#include "scheduler/plan/plan.h"
#include "scheduler/status/bake_status.h"

namespace gigabake {

struct SourceOpened {
  const SceneSources& sources;
};
struct TilesScanned {
  std::size_t done = 0, all = 0;
};
struct JobsPlanned {
  const BakePlan& plan;
};
struct DispatchBegan {
  const BakePlan& plan;
  const std::vector<CellReport>& reused;  ///< reports of jobs that an earlier run has baked
};
/// A rank joined or rejoined.
struct WorkerJoined {
  int rank = 0;
  std::string host;
};
struct JobDispatched {
  std::uint32_t job = 0;
  int rank = 0;
};
/// A job was baked or found empty.
struct JobFinished {
  const CellReport& report;
  const CellJob& order;  ///< the dispatched job, with its child files
};
/// An attempt failed; the job is retried unless JobQuarantined follows.
struct AttemptFailed {
  std::uint32_t job = 0;
};
/// A job failed permanently; the report has the reason.
struct JobQuarantined {
  const CellReport& report;
  const CellJob& job;
};
/// A rank's bake process ended and restarts; its jobs in flight are retried.
struct ProcessDied {
  int rank = 0;
  std::string why;
};
/// A rank's heartbeat timed out; its jobs in flight are retried on other ranks.
struct WorkerLost {
  int rank = 0;
};
struct StateEntered {
  BakeState state = BakeState::scanning;
};
/// An iteration of a loop that shows that the bake is alive.
struct BakeAlive {};
struct InfoLine {
  std::string text;
};
/// A problem that does not end the bake.
struct WarningLine {
  std::string text;
};
/// A new status. The event occurs ten times per second, and when the bake enters another state.
struct StatusUpdated {
  const BakeStatus& status;
};

/// An event of a bake. Its references are valid only during the call of a listener.
using BakeEvent = std::variant<SourceOpened, TilesScanned, JobsPlanned, DispatchBegan, WorkerJoined, JobDispatched,
                               JobFinished, AttemptFailed, JobQuarantined, ProcessDied, WorkerLost, StateEntered,
                               BakeAlive, InfoLine, WarningLine, StatusUpdated>;
using BakeListener = std::function<void(const BakeEvent&)>;

/// Returns the line with which a log warns of the event; nullopt for events that need no warning.
std::optional<std::string> warning_of(const BakeEvent& event);

}  // namespace gigabake
