/// Identity of the program build that this process runs.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "cluster/mpi/mpi_session.h"

namespace gigabake {

/// The identity of a build. Its layout must never change, because a rank of another build must be able to read it.
struct BuildIdentity {
  std::array<char, 8> magic = {'g', 'i', 'g', 'a', 'b', 'a', 'k', 'e'};
  std::uint32_t kernel_version = 0;
  std::uint32_t id_bytes = 0;
  std::array<std::uint8_t, 32> id{};  ///< the linker's build id of the program; all zeros if it has none
  std::array<char, 16> version{};     ///< of the release, zero-padded
  std::array<char, 16> command{};     ///< "bake", zero-padded
  friend bool operator==(const BuildIdentity&, const BuildIdentity&) = default;
};
static_assert(sizeof(BuildIdentity) == 80);

/// Returns the identity of this process's program. `command` is the command that this process runs.
BuildIdentity this_build(const std::string& command);
/// Returns a text for messages: "bake of gigabake 0.3.0, kernel version 8, build 5f0c3a11".
std::string describe(const BuildIdentity& build);

/// Compares the builds of all ranks. Collective call; must be the first exchange between ranks.
/// Errors  CollectiveFailure: a rank runs another build than rank 0, or another command.
void expect_same_build(MpiSession& mpi, const std::string& command);

}  // namespace gigabake
