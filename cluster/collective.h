/// Steps that all ranks take or none.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "cluster/mpi_session.h"
#include "lattice/error.h"
#include "lattice/progress.h"

namespace gigabake {

/// Thrown on every rank when a collective step failed on one. The line is there on the lowest rank that failed; on the
/// others it is empty.
class CollectiveFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// As CollectiveFailure, where the options of a rank are wrong or not those of rank 0.
class CollectiveUsageError : public CollectiveFailure {
 public:
  using CollectiveFailure::CollectiveFailure;
};

/// For messages.
std::string host_name();

/// Collective. line: why this rank cannot go on; is_stopped: it was asked not to. Errors  On every rank: Stopped where
/// any rank was stopped; else CollectiveFailure where any has a line.
void fail_together(MpiSession& mpi, const std::optional<std::string>& line, bool is_stopped = false);

/// Collective. Runs `step` on every rank; what it throws anywhere becomes everybody's CollectiveFailure, or Stopped.
template <class Step>
void all_or_none(MpiSession& mpi, const Step& step) {
  std::optional<std::string> line;
  bool is_stopped = false;
  try {
    step();
  } catch (const Stopped&) {
    is_stopped = true;
  } catch (const std::exception& e) {
    line = reason_of(e);
  }
  fail_together(mpi, line, is_stopped);
}

/// Like all_or_none(), for a step that reads this rank's own options. Errors  CollectiveUsageError on every rank if it
/// throws UsageError on one: a rank that ended alone would leave the others waiting.
template <class Step>
void check_options_together(MpiSession& mpi, const Step& step) {
  bool is_usage = false;
  try {
    all_or_none(mpi, [&] {
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
