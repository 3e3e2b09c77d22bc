/// What earlier bakes into a folder have left of a plan, and why the rest must be done.
///
/// A cell is done where the journal has its fingerprint and its shard bears the stamp of then, to the byte. That is
/// sound although the stamp was taken right after the shard appeared and so is unsettled (format/system/file_stamp.h):
/// a shard is whole when it gets its name, and no bake ever writes into one that has it. It appears by a rename, which
/// makes another file of it: inode or change time differ. Whoever else writes into OUT is seen by the change time,
/// unless he does it within a tick of the clock after the bake. A disk that returns other bytes than were written is
/// not seen: `verify` reads every byte. A shard that is there and not known so is never trusted: a worker reads it back
/// and takes it over or bakes the cell.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "lattice/rules.h"
#include "scheduler/journal_content.h"
#include "scheduler/plan.h"

namespace gigabake {

enum class PriorReason : std::uint8_t {
  unchanged,       ///< done
  to_be_checked,   ///< a shard of that name is there, and nobody vouches for it
  shard_missing,   ///< it was baked, and its shard is gone
  inputs_changed,  ///< the cell was baked from other tiles, textures or parameters
  new_cell,        ///< the journal has nothing of that name
};
template <>
constexpr auto names_of<PriorReason>() {  // in a list beside the cell's name
  return std::to_array<std::string_view>(
      {"unchanged", "shard to be checked", "shard missing", "inputs changed", "new cell"});
}
inline constexpr std::size_t prior_reasons = names_of<PriorReason>().size();

struct PriorResults {
  std::vector<PriorReason> reasons;  ///< by job
  /// Of cells that are done, by rising id, as they were written down; id is the job's, and what a report says of the
  /// run it came from (seconds, memory, device, note) is blank.
  std::vector<CellReport> done;

  std::array<std::size_t, prior_reasons> counts() const;
};

/// Exact   A function of plan, journal and the stamps under `out`; writes nothing, needs no lock.
/// Cost    Opens a file for each cell: a million in 4.6 s on two threads and a local disk.
PriorResults find_prior(const BakePlan& plan, const JournalContent& journal, const std::filesystem::path& out,
                        int threads);

}  // namespace gigabake
