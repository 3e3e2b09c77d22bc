/// What goes between ranks, and what it means.
#pragma once

#include <cstdint>
#include <vector>

namespace gigabake {

enum Tag : int {
  tag_tiles = 1,  ///< master to worker: u32 each, the tiles that it is to survey
  tag_survey,     ///< worker to master: one TileSurvey
  tag_job,        ///< master to worker: deaths u32, then one BakeOrder
  tag_report,     ///< worker to master: one BakeAnswer
  tag_died,       ///< worker to master: why its bake process is gone with all that it had; it deals with that itself
  tag_alive,      ///< worker to master: peak bytes u64, host; master to worker: nothing; sent now and then
  tag_opened,     ///< master to worker: it has opened the source, or cannot
  tag_stop,       ///< master to worker: no more jobs, or no more surveys; worker to master: no survey follows
  tag_export,     ///< any rank to rank 0: its part of what ranks that export together exchange
};

struct Message {
  int from = 0, tag = 0;
  std::vector<std::uint8_t> bytes;
};

}  // namespace gigabake
