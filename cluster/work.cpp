#include <chrono>
#include <variant>

#include "cluster/dispatch.h"
#include "cluster/signs_of_life.h"
#include "cluster/tags.h"
#include "format/bytes.h"

namespace gigabake {
namespace {

constexpr std::chrono::milliseconds longest_wait{2};

/// A rank's loop.
class Worker {
 public:
  Worker(MpiSession& mpi, BakeProcess& process) : mpi_(mpi), process_(process) {}

  void run() {
    while (!stopped_) {
      signs_.show();
      while (const auto message = mpi_.poll()) obey(*message);
      while (auto event = process_.poll()) report(*event);
      process_.wait(longest_wait);
    }
  }

 private:
  void obey(const Message& message) {
    if (message.tag == tag_stop) stopped_ = true;
    if (message.tag != tag_job) return;
    // Sent before the master knew of the last death: it counts the cell among those that died with the process.
    std::uint32_t known_deaths = 0;
    ByteReader(message.bytes, "job").get(known_deaths);
    if (known_deaths != deaths_) return;
    BakeOrder order = order_from_bytes(std::span(message.bytes).subspan(sizeof deaths_));
    process_.submit(std::move(order.job), order.attempt);
  }

  void report(const BakeProcess::Event& event) {
    if (const auto* baked = std::get_if<BakeProcess::Baked>(&event))
      mpi_.send(0, tag_report, to_bytes(BakeAnswer{baked->report, baked->attempt}));
    if (const auto* died = std::get_if<BakeProcess::Died>(&event)) {
      ++deaths_;
      mpi_.send(0, tag_died, {died->why.begin(), died->why.end()});
    }
  }

  MpiSession& mpi_;
  BakeProcess& process_;
  SignsOfLife signs_{mpi_, process_};
  std::uint32_t deaths_ = 0;
  bool stopped_ = false;
};

}  // namespace

void work(MpiSession& mpi, BakeProcess& process) { Worker(mpi, process).run(); }

}  // namespace gigabake
