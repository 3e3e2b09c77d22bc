/// The status of a bake, which rank 0 makes from the bake's events. It is published in OUT/status.json, in a file for
/// Prometheus, and to a listener.
#pragma once

#include <filesystem>

#include "scheduler/status/bake_event.h"
#include "scheduler/status/bake_status_record.h"

namespace gigabake {

/// Returns this host's Unix time in seconds.
double unix_now_s();

/// Status feed of rank 0. Writes nothing before the first BakeAlive, because until then another bake may have locked
/// OUT.
/// Cost    BakeAlive reads the clock. A status is made ten times per second, and the files are written once per second.
/// Errors  None: a failed write prints one line on standard error; the bake continues.
class StatusFeed {
 public:
  /// Takes the identity of this process. `metrics` is the file for Prometheus, `listener` receives each StatusUpdated;
  /// both may be empty.
  StatusFeed(std::filesystem::path out, int ranks, std::filesystem::path metrics, BakeListener listener);

  BakeStatusRecord& record() { return record_; }
  /// Records an event of the bake. BakeAlive updates the status if an update is due. Send BakeAlive in every iteration
  /// of a loop, because readers treat a bake without recent status as dead. A new state is published immediately.
  void take(const BakeEvent& event);
  /// Records that the bake was stopped before its first cell. Publishes only if a status was published before.
  void stop();
  /// Records the error that ended the bake. Publishes only if a status was published before.
  void fail(const std::string& reason);

 private:
  void update();
  void publish();
  void write(const BakeStatus& status);

  std::filesystem::path out_, metrics_;
  BakeListener listener_;
  BakeStatusRecord record_;
  double updated_s_ = 0, written_s_ = 0;
  bool began_ = false, warned_ = false;
};

}  // namespace gigabake
