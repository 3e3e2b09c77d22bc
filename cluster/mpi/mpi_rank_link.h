/// Transport of dispatch() over MPI.
#pragma once

#include "cluster/dispatch/rank_baker.h"
#include "cluster/mpi/mpi_session.h"
#include "cluster/mpi/rank_link.h"

namespace gigabake {

/// Transport of rank 0. Messages to rank 0 itself go to its own bake process.
class MpiRankLink : public RankLink {
 public:
  /// Creates a link; its arguments must outlive it.
  MpiRankLink(MpiSession& mpi, BakeProcess& process) : mpi_(mpi), process_(process), baker_(process) {}

  int ranks() const override { return mpi_.ranks(); }
  double now_s() const override;
  bool is_drain_requested() const override;
  void send(int rank, Tag tag, std::vector<std::uint8_t> bytes) override;
  std::optional<Message> receive() override;
  void wait() override;

 private:
  MpiSession& mpi_;
  BakeProcess& process_;
  RankBaker baker_;
};

}  // namespace gigabake
