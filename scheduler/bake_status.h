/// How a bake is going, as rank 0 tells others: OUT/status.json for people and programs, and a text file for
/// Prometheus.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lattice/rules.h"

namespace gigabake {

enum class BakeState : std::uint8_t {
  surveying,
  baking,
  draining,    ///< hands out nothing more; waits for what is out
  publishing,  ///< every cell is settled; scene.xml comes next
  complete,    ///< published, nothing is missing
  incomplete,  ///< published, something is missing
  drained,     ///< stopped when asked to; the same command goes on from there
  failed,      ///< nothing was published: BakeStatus::reason
};
template <>
constexpr auto names_of<BakeState>() {
  return std::to_array<std::string_view>(
      {"surveying", "baking", "draining", "publishing", "complete", "incomplete", "drained", "failed"});
}
/// Nothing more will happen.
bool is_over(BakeState state);

/// planned = taken_over + pending + running + done + empty + set_aside.
struct CellTally {
  std::uint64_t planned = 0;
  std::uint64_t taken_over = 0;       ///< an earlier run has baked them
  std::uint64_t pending = 0;          ///< wait, perhaps not for the first time
  std::uint64_t running = 0;          ///< in a worker's hand
  std::uint64_t done = 0;             ///< baked by this run
  std::uint64_t empty = 0;            ///< by this run, and nothing was in them
  std::uint64_t set_aside = 0;        ///< given up: they will be missing
  std::uint64_t failed_attempts = 0;  ///< of cells that may have been baked since
  friend bool operator==(const CellTally&, const CellTally&) = default;
};

struct Throughput {
  double cells_per_s = 0, voxels_per_s = 0, bytes_per_s = 0;
  friend bool operator==(const Throughput&, const Throughput&) = default;
};

struct SlowCell {
  std::string name;
  double seconds = 0;       ///< of all its stages
  std::optional<int> rank;  ///< none: its worker had been given up by then
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
  double since_s = 0;              ///< when it was last given something or gave something back
  std::vector<std::string> cells;  ///< in hand, in the order in which it was given them
  friend bool operator==(const WorkerStatus&, const WorkerStatus&) = default;
};

/// Points in time are Unix seconds of rank 0's clock.
struct BakeStatus {
  BakeState state = BakeState::surveying;
  std::string reason;     ///< why it failed, one line
  std::string out, host;  ///< the bake's folder; where rank 0 runs
  std::int64_t pid = 0;   ///< of rank 0
  int ranks = 0;
  double started_s = 0, updated_s = 0;
  std::uint64_t tiles_surveyed = 0, tiles = 0;
  CellTally cells;
  std::uint64_t voxels = 0, bytes = 0;           ///< written by this run
  Throughput recent, overall;                    ///< over the last minute; since the first cell was handed out
  std::optional<double> left_s;                  ///< none: nobody can tell yet
  double read_s = 0, kernel_s = 0, write_s = 0;  ///< sums over this run's cells; stages of different cells overlap
  std::vector<SlowCell> slowest;                 ///< the first is the slowest; at most most_slow_cells
  std::uint64_t failures = 0;                    ///< what will be missing, all of it
  std::vector<BakeFailure> first_failures;       ///< at most most_failures_listed
  std::uint64_t process_restarts = 0, workers_lost = 0;
  std::vector<WorkerStatus> workers;  ///< by rank
  friend bool operator==(const BakeStatus&, const BakeStatus&) = default;
};
inline constexpr std::size_t most_slow_cells = 10, most_failures_listed = 20;

/// One JSON object on one line. Exact  status_from_json() returns the same value; bytes that are no UTF-8 are replaced.
/// Cost  150 bytes a worker: 150 kB for a thousand.
std::string to_json(const BakeStatus& status);
/// file: for messages. Errors  InputError: not JSON, or a member that is missing, of another type or out of range.
BakeStatus status_from_json(const std::filesystem::path& file, std::string_view text);

/// OUT/status.json.
std::filesystem::path status_file(const std::filesystem::path& out);
/// Readers see this status or the one before. Not flushed to disk: after a loss of power it may be gone or empty.
/// Errors  InputError.
void write_status(const std::filesystem::path& out, const BakeStatus& status);
/// Errors  InputError: no such file, larger than 64 MiB, or as status_from_json().
BakeStatus read_status(const std::filesystem::path& out);

/// Prometheus' text format, for node_exporter's textfile collector. Each series carries bake="OUT", so that several
/// bakes can be collected on one host.
std::string to_prometheus(const BakeStatus& status);

}  // namespace gigabake
