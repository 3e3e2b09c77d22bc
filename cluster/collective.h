/// Steps that all ranks take or none.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "cluster/mpi_session.h"

namespace gigabake {

/// Thrown on every rank when a collective step failed on one. The line is there on the lowest rank that failed; on the
/// others it is empty.
class CollectiveFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// For messages.
std::string host_name();

/// Collective. line: why this rank cannot go on. Errors  CollectiveFailure on every rank where any rank has a line.
void fail_together(MpiSession& mpi, const std::optional<std::string>& line);

/// Collective. Runs `step` on every rank; what it throws anywhere becomes everybody's CollectiveFailure.
template <class Step>
void all_or_none(MpiSession& mpi, const Step& step) {
  std::optional<std::string> line;
  try {
    step();
  } catch (const std::exception& e) {
    line = e.what();
  }
  fail_together(mpi, line);
}

}  // namespace gigabake
