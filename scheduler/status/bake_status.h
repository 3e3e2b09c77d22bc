/// Status of a bake, published by rank 0: OUT/status.json for people and programs, and a text file for Prometheus.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/rules.h"

namespace gigabake {

enum class BakeState : std::uint8_t {
  scanning,
  baking,
  draining,    ///< no more cells are dispatched; running cells finish
  publishing,  ///< all cells are final; scene.xml is written next
  complete,    ///< published without losses
  incomplete,  ///< published with losses
  drained,     ///< stopped on request; the same command resumes it
  failed,      ///< nothing was published; BakeStatus::reason has the cause
};
template <>
constexpr auto names_of<BakeState>() {
  return std::to_array<std::string_view>(
      {"surveying", "baking", "draining", "publishing", "complete", "incomplete", "drained", "failed"});
}
/// Returns true if the state is final.
bool is_over(BakeState state);

/// Numbers of cells: planned = taken_over + pending + running + done + empty + quarantined.
struct CellTally {
  std::uint64_t planned = 0;
  std::uint64_t taken_over = 0;       ///< baked by an earlier run
  std::uint64_t pending = 0;          ///< queued, including retries
  std::uint64_t running = 0;          ///< in flight at a worker
  std::uint64_t done = 0;             ///< baked by this run
  std::uint64_t empty = 0;            ///< found empty by this run
  std::uint64_t quarantined = 0;      ///< failed permanently; missing from the scene
  std::uint64_t failed_attempts = 0;  ///< includes attempts at cells that a later attempt baked
  friend bool operator==(const CellTally&, const CellTally&) = default;
};

struct Throughput {
  double cells_per_s = 0, voxels_per_s = 0, bytes_per_s = 0;
  friend bool operator==(const Throughput&, const Throughput&) = default;
};

struct SlowCell {
  std::string name;
  double seconds = 0;       ///< sum over all stages
  std::optional<int> rank;  ///< nullopt if no rank had the cell in flight when its report arrived
  friend bool operator==(const SlowCell&, const SlowCell&) = default;
};

struct BakeFailure {
  std::string name, line;
  friend bool operator==(const BakeFailure&, const BakeFailure&) = default;
};

struct WorkerStatus {
  int rank = 0;
  std::string host;
  bool lost = false;
  double since_s = 0;              ///< time of the last dispatch to the rank or result from it
  std::vector<std::string> cells;  ///< names of the cells in flight, in the order of dispatch
  friend bool operator==(const WorkerStatus&, const WorkerStatus&) = default;
};

/// Status at one time. Points in time are Unix seconds of rank 0's clock.
struct BakeStatus {
  BakeState state = BakeState::scanning;
  std::string reason;     ///< reason of a failure, one line
  std::string out, host;  ///< the bake's folder; rank 0's host
  std::int64_t pid = 0;   ///< process id of rank 0
  int ranks = 0;
  double started_s = 0, updated_s = 0;
  std::uint64_t tiles_scanned = 0, tiles = 0;
  CellTally cells;
  std::uint64_t voxels = 0, bytes = 0;           ///< written by this run
  Throughput recent, overall;                    ///< recent: over the last minute; overall: since the first dispatch
  std::optional<double> left_s;                  ///< remaining time in seconds; nullopt: not enough data yet
  double read_s = 0, kernel_s = 0, write_s = 0;  ///< sums over this run's cells; stages of different cells overlap
  std::vector<SlowCell> slowest;                 ///< slowest first; at most max_slow_cells
  std::uint64_t failures = 0;                    ///< number of all losses
  std::vector<BakeFailure> first_failures;       ///< at most max_failures_listed
  std::uint64_t process_restarts = 0, workers_lost = 0;
  std::vector<WorkerStatus> workers;  ///< sorted by rank
  friend bool operator==(const BakeStatus&, const BakeStatus&) = default;
};
inline constexpr std::size_t max_slow_cells = 10, max_failures_listed = 20;

/// Returns one JSON object on one line.
/// Exact   status_from_json() returns an equal value, except that bytes that are not UTF-8 are replaced.
/// Cost    150 bytes per worker: 150 kB for a thousand workers.
std::string to_json(const BakeStatus& status);
/// Parses the result of to_json(). `file` is the name for messages.
/// Errors  InputError if the text is not JSON, or a member is missing, has another type or is out of range.
BakeStatus status_from_json(const std::filesystem::path& file, std::string_view text);

/// Returns OUT/status.json.
std::filesystem::path status_file(const std::filesystem::path& out);
/// Replaces the file atomically, without flushing to disk: after a power failure it may be missing or empty.
/// Errors  InputError if the file cannot be written.
void write_status(const std::filesystem::path& out, const BakeStatus& status);
/// Reads OUT/status.json.
/// Errors  InputError if the file does not exist or is larger than 64 MiB; the errors of status_from_json().
BakeStatus read_status(const std::filesystem::path& out);

/// Returns the status in Prometheus' text format, for node_exporter's textfile collector. Each series has the label
/// bake="OUT", so that several bakes can be collected on one host.
std::string to_prometheus(const BakeStatus& status);

}  // namespace gigabake
