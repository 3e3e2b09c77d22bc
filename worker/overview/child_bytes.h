/// Serialized data of a child that its overview needs. A worker sends it to the worker that makes the overview, so that
/// the latter need not read the child's shard.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "worker/overview/overview_bake.h"

namespace gigabake {

/// A child's data in serialized form, under the name of its shard (CellReport::cell.file).
struct ChildBytes {
  std::string file;
  std::vector<std::uint8_t> bytes;
};

std::vector<std::uint8_t> to_bytes(const OverviewChild& child);
/// Returns the data that to_bytes() serialized.
/// Errors  InputError if the bytes are malformed.
OverviewChild overview_child_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
