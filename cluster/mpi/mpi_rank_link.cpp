#include "cluster/mpi/mpi_rank_link.h"

#include <chrono>
#include <utility>

#include "cluster/process/drain.h"

namespace gigabake {
namespace {

constexpr std::chrono::milliseconds max_wait{2};

}  // namespace

double MpiRankLink::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool MpiRankLink::is_drain_requested() const { return gigabake::is_drain_requested(); }

void MpiRankLink::send(int rank, Tag tag, std::vector<std::uint8_t> bytes) {
  if (rank != 0) return mpi_.send(rank, tag, std::move(bytes));
  if (tag == tag_job) baker_.handle(bytes);
}

std::optional<Message> MpiRankLink::receive() {
  if (auto own = baker_.answer()) return own;
  return mpi_.poll();
}

void MpiRankLink::wait() { process_.wait(max_wait); }

}  // namespace gigabake
