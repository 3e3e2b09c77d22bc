#include "app/messages/status_text.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

#include "app/options/flags.h"
#include "core/base/pluralize.h"

namespace gigabake::app {
namespace {

/// Replaces control characters: a status file is untrusted input, and a terminal would execute its escape sequences.
std::string plain(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
  return text;
}

std::uint64_t settled(const CellTally& c) { return c.taken_over + c.done + c.empty + c.quarantined; }

std::string rate(const Throughput& t) {
  return fmt::format("{:.1f} cells/s, {} voxels/s, {:.1f} MB/s", t.cells_per_s, readable_count(t.voxels_per_s),
                     t.bytes_per_s / 1e6);
}

std::string scan_line(const BakeStatus& s) {
  std::string line = fmt::format("{}/{} tiles scanned", s.tiles_scanned, s.tiles);
  if (s.tiles_scanned != 0)
    line += ", " +
            readable_seconds((s.updated_s - s.started_s) / double(s.tiles_scanned) *
                             (double(s.tiles) - double(s.tiles_scanned))) +
            " left";
  return line;
}

std::string head(const BakeStatus& s, double now_s, Writer writer) {
  std::string line = fmt::format("{} {}: ", plain(s.out), name_of(s.state));
  if (writer == Writer::gone)
    line = fmt::format("{} interrupted while {}: last update {} ago, after {}", plain(s.out), name_of(s.state),
                       readable_seconds(now_s - s.updated_s), readable_seconds(s.updated_s - s.started_s));
  else if (is_over(s.state))
    line += fmt::format("ended {} ago after {}", readable_seconds(now_s - s.updated_s),
                        readable_seconds(s.updated_s - s.started_s));
  else
    line += fmt::format("running for {}, last update {} ago", readable_seconds(now_s - s.started_s),
                        readable_seconds(now_s - s.updated_s));
  line += fmt::format("; {}, rank 0 on {} (process {})\n", pluralize(s.ranks, "rank"), plain(s.host), s.pid);
  if (!s.reason.empty()) line += plain(with_flags(s.reason)) + "\n";
  return line;
}

std::string cells_lines(const BakeStatus& s, Writer writer) {
  const bool goes_on = !is_over(s.state) && writer == Writer::there;
  const CellTally& c = s.cells;
  std::string text = fmt::format("cells  {} of {}: {} baked, {} empty, {} reused; {} in flight, {} pending", settled(c),
                                 c.planned, c.done, c.empty, c.taken_over, c.running, c.pending);
  if (c.quarantined != 0) text += fmt::format("; {} given up", c.quarantined);
  if (c.failed_attempts != 0) text += fmt::format("; {} failed", pluralize(c.failed_attempts, "attempt"));
  text += fmt::format("\nwritten  {} voxels, {}; stages read {:.1f} s, kernels {:.1f} s, write {:.1f} s\n",
                      readable_count(double(s.voxels)), readable_bytes(s.bytes), s.read_s, s.kernel_s, s.write_s);
  if (goes_on) text += "last minute  " + rate(s.recent) + "\n";
  text += "overall  " + rate(s.overall) + "\n";
  if (goes_on && s.left_s) text += "time left  about " + readable_seconds(*s.left_s) + "\n";
  return text;
}

std::string trouble_lines(const BakeStatus& s) {
  std::string text;
  if (s.process_restarts + s.workers_lost != 0)
    text += fmt::format("{} started again, {} lost\n",
                        pluralize(s.process_restarts, "bake process died and was", "bake processes died and were"),
                        pluralize(s.workers_lost, "worker was", "workers were"));
  for (const WorkerStatus& w : s.workers)
    if (w.lost) text += fmt::format("  rank {} on {} is lost\n", w.rank, plain(w.host));
  if (s.failures != 0) text += fmt::format("missing  {}\n", s.failures);
  for (const BakeFailure& f : s.first_failures)
    text += fmt::format("  {}: {}\n", plain(f.name), plain(with_flags(f.line)));
  if (s.failures > s.first_failures.size() && !s.first_failures.empty())
    text += fmt::format("  and {} more\n", s.failures - s.first_failures.size());
  return text;
}

std::string slowest_lines(const BakeStatus& s) {
  std::string text = s.slowest.empty() ? "" : "slowest cells\n";
  for (const SlowCell& c : s.slowest)
    text += fmt::format("  {:<24} {:>9.2f} s{}\n", plain(c.name), c.seconds,
                        c.rank ? fmt::format("  rank {}", *c.rank) : std::string());
  return text;
}

}  // namespace

std::string readable_bytes(std::uint64_t bytes) {
  const char* const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double v = double(bytes);
  std::size_t unit = 0;
  for (; v >= 1024 && unit < 4; ++unit) v /= 1024;
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", v, units[unit]);
}

std::string readable_count(double count) {
  const char* const units[] = {"", " k", " M", " G", " T"};
  std::size_t unit = 0;
  for (; count >= 1000 && unit < 4; ++unit) count /= 1000;
  return unit == 0 ? fmt::format("{:.0f}", count) : fmt::format("{:.1f}{}", count, units[unit]);
}

std::string readable_seconds(double seconds) {
  const double s = std::max(0.0, std::round(seconds));
  if (s < 60) return fmt::format("{:.0f} s", s);
  const double minutes = std::floor(s / 60);
  if (minutes < 60) return fmt::format("{:.0f} min {:.0f} s", minutes, s - 60 * minutes);
  return fmt::format("{:.0f} h {:.0f} min", std::floor(minutes / 60), std::fmod(minutes, 60));
}

double share_done(const BakeStatus& s) {
  const bool scan = s.state == BakeState::scanning;
  const double done = double(scan ? s.tiles_scanned : settled(s.cells));
  const double all = double(scan ? s.tiles : s.cells.planned);
  return all > 0 ? std::clamp(done / all, 0.0, 1.0) : 0;
}

std::string one_line(const BakeStatus& s) {
  if (s.state == BakeState::scanning) return scan_line(s);
  const Throughput& t = is_over(s.state) ? s.overall : s.recent;
  std::string line = fmt::format("{}/{} cells, {} voxels/s, {:.1f} MB/s", settled(s.cells), s.cells.planned,
                                 readable_count(t.voxels_per_s), t.bytes_per_s / 1e6);
  if (s.cells.quarantined != 0) line += fmt::format(", {} given up", s.cells.quarantined);
  if (s.state == BakeState::draining) line += fmt::format(", draining: {} in flight", s.cells.running);
  if (s.state == BakeState::baking && s.left_s) line += ", " + readable_seconds(*s.left_s) + " left";
  if (s.state >= BakeState::publishing) line += fmt::format(", {}", name_of(s.state));
  return line;
}

std::string describe(const BakeStatus& s, double now_s, Writer writer) {
  if (s.state == BakeState::scanning) return head(s, now_s, writer) + scan_line(s) + "\n";
  return head(s, now_s, writer) + cells_lines(s, writer) + trouble_lines(s) + slowest_lines(s);
}

}  // namespace gigabake::app
