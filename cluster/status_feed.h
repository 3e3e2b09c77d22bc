/// Who hears of a bake's status: readers of OUT/status.json, Prometheus, and rank 0's own log.
#pragma once

#include <filesystem>
#include <functional>

#include "scheduler/bake_status_record.h"

namespace gigabake {

/// Unix time of this host.
double unix_now_s();

/// Rank 0's. Writes nothing before the first turn(): until then the folder may be another bake's.
/// Cost    turn() is a look at the clock; ten times a second a status is made, once a second the files are written.
/// Errors  None: a file that cannot be written costs one line on standard error, never the bake.
class StatusFeed {
 public:
  using Listener = std::function<void(const BakeStatus&)>;

  /// The identity of this process. metrics: a file for Prometheus; may be empty, as may the listener.
  StatusFeed(std::filesystem::path out, int ranks, std::filesystem::path metrics, Listener listener);

  BakeStatusRecord& record() { return record_; }
  /// In every turn of a loop: readers take a bake for dead that says nothing for a while.
  void turn();
  /// Passes the status on at once: the bake enters another state, or ends.
  void publish();
  /// The bake was asked to end before its first cell. Says so where anything was said before.
  void stop();
  /// What ended the bake. Says so where anything was said before.
  void fail(const std::string& reason);

 private:
  void write(const BakeStatus& status);

  std::filesystem::path out_, metrics_;
  Listener listener_;
  BakeStatusRecord record_;
  double told_s_ = 0, written_s_ = 0;
  bool began_ = false, complained_ = false;
};

}  // namespace gigabake
