#include "cluster/mpi/mpi_export_team.h"

#include <chrono>
#include <thread>
#include <utility>

#include "cluster/mpi/collective.h"
#include "core/io/bytes.h"

namespace gigabake {
namespace {

using Parts = std::vector<std::vector<std::uint8_t>>;

/// Receives one message from every other rank on rank 0. No message can belong to a later exchange, because each rank
/// waits for the answer to its message.
Parts gathered(MpiSession& mpi, std::vector<std::uint8_t> own) {
  Parts parts(std::size_t(mpi.ranks()));
  parts[0] = std::move(own);
  const auto start = std::chrono::steady_clock::now();
  for (int missing = mpi.ranks() - 1; missing > 0;) {
    if (auto message = mpi.poll()) {
      parts[std::size_t(message->from)] = std::move(message->bytes);
      --missing;
      continue;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > mpi.collective_timeout_s())
      throw RankLost("no message from another rank; run the same command again");
  }
  return parts;
}

}  // namespace

MpiExportTeam::MpiExportTeam(MpiSession& mpi) : mpi_(mpi) { mpi_.set_collective_timeout(86400); }

void MpiExportTeam::together(const std::function<void()>& step) const { collective_try(mpi_, step); }

Parts MpiExportTeam::exchange(std::vector<std::uint8_t> own) const {
  ByteWriter writer;
  if (mpi_.rank() == 0)
    writer.put(gathered(mpi_, std::move(own)));
  else
    mpi_.send(0, tag_export, std::move(own));
  const std::vector<std::uint8_t> all = mpi_.from_master(writer.take());
  Parts parts;
  ByteReader(all, "parts of all ranks").get(parts);
  return parts;
}

Parts MpiExportTeam::collect(std::vector<std::uint8_t> own) const {
  Parts parts;
  if (mpi_.rank() == 0)
    parts = gathered(mpi_, std::move(own));
  else
    mpi_.send(0, tag_export, std::move(own));
  mpi_.from_master(0);  // no rank begins the next exchange before rank 0 has all messages
  return parts;
}

}  // namespace gigabake
