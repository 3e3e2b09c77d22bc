#include "cluster/bake/shared_sources.h"

#include <chrono>
#include <exception>
#include <string>
#include <thread>
#include <utility>

#include "cluster/mpi/collective.h"
#include "core/base/error.h"
#include "format/job/source_bytes.h"
#include "format/source/classes/source_classes.h"
#include "format/source/levels/source_levels.h"

namespace gigabake {
namespace {

using Clock = std::chrono::steady_clock;

/// A listener that forwards rank 0's progress and sends heartbeats to the other ranks.
class HeartbeatsWhileOpening : public ProgressListener {
 public:
  HeartbeatsWhileOpening(MpiSession& mpi, const Progress& listener) : mpi_(mpi), listener_(listener) {}

  void step(const std::string& name, std::uint64_t total, const std::string& unit) override {
    listener_.step(name, total, unit);
  }
  void advance(std::uint64_t parts) override {
    listener_.advance(parts);
    show();
  }

 private:
  static constexpr std::chrono::seconds heartbeat_interval{1};

  /// Sends heartbeats, on the main thread only because MPI is initialized for one thread.
  void show() {
    if (std::this_thread::get_id() != thread_ || Clock::now() - shown_ < heartbeat_interval) return;
    shown_ = Clock::now();
    for (int rank = 1; rank < mpi_.ranks(); ++rank) mpi_.send(rank, tag_alive, {});
    mpi_.progress();
  }

  MpiSession& mpi_;
  const Progress listener_;
  const std::thread::id thread_ = std::this_thread::get_id();
  Clock::time_point shown_ = Clock::now();
};

/// Waits on every rank but 0 until opening the source on rank 0 has succeeded or failed.
void await_master(MpiSession& mpi) {
  constexpr std::chrono::milliseconds pause{5};
  for (auto heard = Clock::now();
       std::chrono::duration<double>(Clock::now() - heard).count() < mpi.collective_timeout_s();) {
    if (const auto message = mpi.poll()) {
      if (message->tag == tag_opened) return;
      heard = Clock::now();
    } else {
      std::this_thread::sleep_for(pause);
    }
  }
  throw RankLost("no message from rank 0 while it opened the source; run the same command again");
}

/// Checks that this host sees the source; otherwise every tile that the host reads would be missing.
void expect_source(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path, "", "no such file or folder");
}

}  // namespace

SharedSources open_shared_sources(MpiSession& mpi, const std::filesystem::path& path, const SourceOptions& options,
                                  const BakeParameters& parameters, const Progress& progress) {
  collective_try(mpi, [&] { expect_source(path); });
  SharedSources sources;
  sources.parameters = parameters;
  std::vector<std::uint8_t> bytes;
  std::exception_ptr failure;
  if (mpi.rank() == 0) {
    try {
      HeartbeatsWhileOpening signs(mpi, progress);
      sources.scene = open_sources(path, options, Progress(signs));
      set_source_levels(sources.scene, sources.parameters);
      set_classes(sources.scene, sources.parameters);
      bytes = to_bytes(sources.scene);
    } catch (...) {
      failure = std::current_exception();
    }
    for (int rank = 1; rank < mpi.ranks(); ++rank) mpi.send(rank, tag_opened, {});
  } else {
    await_master(mpi);
  }
  check_options_collectively(mpi, [&] {
    if (failure) std::rethrow_exception(failure);
  });
  sources.bytes = std::make_shared<const std::vector<std::uint8_t>>(mpi.from_master(std::move(bytes)));
  const std::string text = to_json(sources.parameters);
  const std::vector<std::uint8_t> agreed = mpi.from_master({text.begin(), text.end()});
  sources.parameters = parameters_from_json(std::string(agreed.begin(), agreed.end()));
  return sources;
}

}  // namespace gigabake
