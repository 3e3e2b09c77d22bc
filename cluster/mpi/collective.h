/// Steps that succeed on all ranks or fail on all.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "cluster/mpi/mpi_session.h"
#include "core/base/error.h"
#include "core/base/progress.h"

namespace gigabake {

/// The exception on every rank when a collective step failed on any rank. The message is set on the lowest rank that
/// failed; it is empty on the others.
class CollectiveFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A CollectiveFailure whose cause is options of a rank that are invalid or differ from rank 0's.
class CollectiveUsageError : public CollectiveFailure {
 public:
  using CollectiveFailure::CollectiveFailure;
};

/// Returns the host's name for messages.
std::string host_name();

/// Fails on every rank if any rank failed or was stopped. Collective call. `line` is the reason why this rank failed;
/// `is_stopped` means that a stop of this rank was requested.
/// Errors  On every rank: Stopped if any rank was stopped; else CollectiveFailure if any rank has a line.
void fail_collectively(MpiSession& mpi, const std::optional<std::string>& line, bool is_stopped = false);

/// Runs `step` on every rank. Collective call. An exception on any rank becomes CollectiveFailure or Stopped on all
/// ranks.
template <class Step>
void collective_try(MpiSession& mpi, const Step& step) {
  std::optional<std::string> line;
  bool is_stopped = false;
  try {
    step();
  } catch (const Stopped&) {
    is_stopped = true;
  } catch (const std::exception& e) {
    line = reason_of(e);
  }
  fail_collectively(mpi, line, is_stopped);
}

/// Runs a step like collective_try(). Use it for a step that reads this rank's own options: without the collective
/// call, the other ranks would wait forever for a rank that ended.
/// Errors  CollectiveUsageError on every rank if the step throws UsageError on any rank.
template <class Step>
void check_options_collectively(MpiSession& mpi, const Step& step) {
  bool is_usage = false;
  try {
    collective_try(mpi, [&] {
      try {
        step();
      } catch (const UsageError&) {
        is_usage = true;
        throw;
      }
    });
  } catch (const CollectiveFailure& e) {
    if (mpi.max_of(is_usage ? 1 : 0) != 0) throw CollectiveUsageError(e.what());
    throw;
  }
}

}  // namespace gigabake
