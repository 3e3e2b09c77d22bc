/// Messages between ranks.
#pragma once

#include <cstdint>
#include <vector>

namespace gigabake {

enum Tag : int {
  tag_tiles = 1,  ///< master to worker: the tiles that the worker scans, u32 each
  tag_scan,       ///< worker to master: one TileScan
  tag_job,        ///< master to worker: deaths u32, then one BakeOrder
  tag_report,     ///< worker to master: one BakeAnswer
  tag_died,       ///< worker to master: why its bake process ended and lost its requests; the worker restarts it
  tag_device,     ///< worker to master: one DeviceAnswer before the first report; another if a device is needed later
  tag_alive,      ///< heartbeat; worker to master: peak bytes u64, host; master to worker: empty
  tag_opened,     ///< master to worker: opening the source has succeeded or failed
  tag_stop,       ///< master to worker: no more jobs or scans; worker to master: no scan result follows
  tag_export,     ///< any rank to rank 0: its part of an exchange between ranks that export together
};

struct Message {
  int from = 0, tag = 0;
  std::vector<std::uint8_t> bytes;
};

}  // namespace gigabake
