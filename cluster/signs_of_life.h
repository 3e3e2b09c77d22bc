/// How rank 0 knows that a rank is there while it has nothing else to say.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "cluster/bake_process.h"
#include "cluster/mpi_session.h"

namespace gigabake {

struct SignOfLife {
  std::uint64_t peak_bytes = 0;  ///< of the rank's bake processes so far
  std::string host;
};
/// Errors  InputError when malformed.
SignOfLife sign_from_bytes(const std::vector<std::uint8_t>& bytes);

/// A rank's own.
class SignsOfLife {
 public:
  SignsOfLife(MpiSession& mpi, const BakeProcess& process) : mpi_(mpi), process_(process) {}
  /// Sends one now, if the last one was sent a while ago.
  void show();

 private:
  MpiSession& mpi_;
  const BakeProcess& process_;
  std::chrono::steady_clock::time_point shown_{};
};

}  // namespace gigabake
