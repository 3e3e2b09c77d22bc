/// What every rank does with rank 0's orders: passes them to its bake process, and the answers on.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "cluster/bake_process.h"
#include "cluster/message.h"

namespace gigabake {

class RankBaker {
 public:
  explicit RankBaker(BakeProcess& process) : process_(process) {}

  /// Of a tag_job. An order that was sent before rank 0 knew of the last death is dropped: rank 0 counts its cell among
  /// those that died with the process. Errors  InputError when malformed.
  void obey(std::span<const std::uint8_t> order);
  /// The next tag_report or tag_died for rank 0, if there is one; never waits.
  std::optional<Message> answer();

 private:
  BakeProcess& process_;
  std::uint32_t deaths_ = 0;  ///< of the process, as far as rank 0 was told
};

/// The bytes of a tag_job. deaths: of the rank's bake process, as far as rank 0 has heard.
std::vector<std::uint8_t> order_bytes(std::uint32_t deaths, const CellJob& job, std::uint32_t attempt);

}  // namespace gigabake
