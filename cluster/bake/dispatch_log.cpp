#include "cluster/bake/dispatch_log.h"

#include "core/base/error.h"

namespace gigabake {

std::string restart_line(int rank, const std::string& why) {
  return "the bake process of rank " + std::to_string(rank) + " is started again: " + why;
}

void DispatchLog::draining() {
  if (feed_.record().state() != BakeState::baking) return;
  feed_.record().enter(BakeState::draining);
  progress_.warning(
      "draining: cells in flight are finished, and no further cells are started; press Ctrl-C again to stop "
      "immediately");
}

void DispatchLog::joined(int rank, const std::string& host) { feed_.record().worker_joined(rank, host, unix_now_s()); }

void DispatchLog::handed_out(std::uint32_t job, int rank) { feed_.record().handed_out(job, rank, unix_now_s()); }

void DispatchLog::finished(const CellReport& report, const CellJob& order) {
  write_down(report, order);
  feed_.record().cell_done(report, unix_now_s());
  progress_.cell_done(report, plan_.jobs[report.id]);
}

void DispatchLog::attempt_failed(std::uint32_t job) { feed_.record().attempt_failed(job, unix_now_s()); }

void DispatchLog::set_aside(const CellReport& report) {
  feed_.record().set_aside(report.id, report.error, unix_now_s());
  progress_.cell_done(report, plan_.jobs[report.id]);
}

void DispatchLog::process_died(int rank, const std::string& why) {
  feed_.record().process_died(rank, unix_now_s());
  progress_.warning(restart_line(rank, why));
}

void DispatchLog::lost(int rank) {
  feed_.record().worker_lost(rank, unix_now_s());
  progress_.warning("no message from rank " + std::to_string(rank) + "; other ranks bake its cells");
}

/// Appends to the journal. If the journal cannot be written, this bake continues, and the next bake takes longer
/// because it reads the shards instead.
void DispatchLog::write_down(const CellReport& report, const CellJob& order) {
  try {
    journal_.append(order, report);
  } catch (const InputError& e) {
    progress_.warning(std::string("the bake continues without its journal: ") + e.what());
  }
}

}  // namespace gigabake
