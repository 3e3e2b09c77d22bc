/// What a bake process is told before anything else: enough to open the sources and to bake by itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source/source.h"
#include "lattice/parameters.h"
#include "worker/backend.h"
#include "worker/cell_pipeline.h"

namespace gigabake {

struct WorkerSetup {
  std::filesystem::path source;  ///< relative ones count from the process's working folder, which it inherits
  SourceOptions source_options;
  BakeParameters parameters;
  WorkerOptions worker;  ///< but for cuda_device, which the process chooses
  DeviceWish device;
  std::uint32_t tiles = 0;  ///< that the other side found in the source: another number means that it changed
};

std::vector<std::uint8_t> to_bytes(const WorkerSetup& setup);
/// Errors  InputError when malformed, UsageError where a parameter is out of range.
WorkerSetup setup_from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace gigabake
