#include <fmt/format.h>
#include <iterator>

#include "core/base/valid_text.h"
#include "scheduler/status/bake_status.h"

namespace gigabake {
namespace {

/// Returns a label value for Prometheus: valid UTF-8 with escaped quotes, backslashes and line ends.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : valid_utf8(text)) {
    if (c == '\\' || c == '"') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out;
}

class Exposition {
 public:
  explicit Exposition(const std::string& bake) : bake_(escaped(bake)) {}

  void counter(const char* name, const char* help, double value) {
    head(name, "counter", help);
    sample(name, "", value);
  }
  void gauge(const char* name, const char* help, double value) {
    head(name, "gauge", help);
    sample(name, "", value);
  }
  void head(const char* name, const char* type, const char* help) {
    fmt::format_to(std::back_inserter(text_), "# HELP {0} {1}\n# TYPE {0} {2}\n", name, help, type);
  }
  /// Appends a sample. Each label in `labels` has the form `,key="value"`.
  void sample(const char* name, const std::string& labels, double value) {
    fmt::format_to(std::back_inserter(text_), "{}{{bake=\"{}\"{}}} {}\n", name, bake_, labels, value);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string bake_, text_;
};

std::string label(const char* key, std::string_view value) { return fmt::format(",{}=\"{}\"", key, escaped(value)); }

void add_state(Exposition& e, const BakeStatus& s) {
  e.head("gigabake_state", "gauge", "1 for the current state of the bake, else 0.");
  for (const BakeState state : values_of<BakeState>())
    e.sample("gigabake_state", label("state", name_of(state)), state == s.state);
  e.gauge("gigabake_started_timestamp_seconds", "When the bake started, Unix time.", s.started_s);
  e.gauge("gigabake_updated_timestamp_seconds", "When this file was written, Unix time.", s.updated_s);
  e.gauge("gigabake_ranks", "Ranks of the bake.", s.ranks);
  e.gauge("gigabake_tiles", "Tiles of the source.", double(s.tiles));
  e.gauge("gigabake_tiles_surveyed", "Tiles scanned so far.", double(s.tiles_scanned));
}

void add_cells(Exposition& e, const CellTally& c) {
  e.head("gigabake_cells", "gauge", "Cells of the plan by state.");
  const auto cells = [&e](const char* state, std::uint64_t n) {
    e.sample("gigabake_cells", label("state", state), double(n));
  };
  cells("taken_over", c.taken_over);
  cells("pending", c.pending);
  cells("running", c.running);
  cells("done", c.done);
  cells("empty", c.empty);
  cells("set_aside", c.quarantined);
  e.counter("gigabake_failed_attempts_total", "Failed attempts to bake a cell.", double(c.failed_attempts));
}

}  // namespace

std::string to_prometheus(const BakeStatus& s) {
  Exposition e(s.out);
  add_state(e, s);
  add_cells(e, s.cells);
  e.counter("gigabake_voxels_written_total", "Voxels written by this run, all levels.", double(s.voxels));
  e.counter("gigabake_written_bytes_total", "Bytes of shards written by this run.", double(s.bytes));
  e.head("gigabake_stage_seconds_total", "counter", "Seconds that cells spent in a stage, summed over cells.");
  e.sample("gigabake_stage_seconds_total", label("stage", "read"), s.read_s);
  e.sample("gigabake_stage_seconds_total", label("stage", "kernels"), s.kernel_s);
  e.sample("gigabake_stage_seconds_total", label("stage", "write"), s.write_s);
  if (s.left_s) e.gauge("gigabake_left_seconds", "Estimated time until the last cell is baked.", *s.left_s);
  e.gauge("gigabake_missing", "Tiles and cells that will be missing from the scene.", double(s.failures));
  e.counter("gigabake_process_restarts_total", "Bake processes that died and were started again.",
            double(s.process_restarts));
  e.counter("gigabake_workers_lost_total", "Workers whose heartbeat timed out.", double(s.workers_lost));
  return e.take();
}

}  // namespace gigabake
