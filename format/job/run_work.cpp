#include "format/job/run_work.h"

#include <sys/resource.h>
#include <sys/time.h>

namespace gigabake {
namespace {

double seconds(const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); }

}  // namespace

RunWork& RunWork::operator+=(const RunWork& other) {
  counts += other.counts;
  stages += other.stages;
  cpu_s += other.cpu_s;
  return *this;
}

RunWork RunWorkMeter::next() {
  const RunWork now{work_counts(), process_stage_clock().times(), process_cpu_s()};
  const RunWork done{now.counts.since(before_.counts), now.stages.since(before_.stages), now.cpu_s - before_.cpu_s};
  before_ = now;
  return done;
}

double process_cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace gigabake
