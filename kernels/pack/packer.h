/// A baked cell's columns, made where its voxels are: what comes down the bus is what a shard's file holds, and the
/// host has no voxels.
///
/// Built without CUDA there are no baked cells on a device, and so nothing to pack.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/cuda/baker.h"
#include "lattice/pack/packed_level.h"

namespace gigabake::kernels {

/// How columns come to the host.
enum class ColumnBytes : std::uint8_t {
  raw,     ///< row after row, for the host to compress
  stored,  ///< chunk after chunk as a file holds it, compressed by deflate
};

struct PackRequest {
  std::vector<std::vector<ChannelPlace>> channels;  ///< [lod]; what each level's columns of values hold
  std::vector<RowShape> nodes;                      ///< of the node table's columns, as NodeColumn numbers them
  ColumnBytes as = ColumnBytes::stored;
  std::uint64_t memory_bytes = 0;  ///< of device memory, for working arrays and columns. 0: no bound
};

/// A cell without its voxels: what is left of them are columns.
struct PackedCell {
  std::vector<PackedLevel> levels;    ///< [lod]; they and the nodes borrow `memory`
  std::vector<PackedColumn> nodes;    ///< as they were asked for
  NodeTable constants;                ///< of the nodes those that are no bricks: kind, lod and value alone
  std::vector<Hash128> content_hash;  ///< [lod]
  ParentSource above;                 ///< as CellVolume has it
  CellStats stats;
  std::shared_ptr<const void> memory;  ///< page-locked; goes back to the packer with the last who holds it
};

/// Packs on a stream of its own, beside a CudaBaker of the same device that bakes the next cell.
class CudaPacker {
 public:
  /// Errors  CudaFailure.
  explicit CudaPacker(int device);
  ~CudaPacker();
  CudaPacker(const CudaPacker&) = delete;
  CudaPacker& operator=(const CudaPacker&) = delete;

  /// None where the cell came in parts or has no voxels: what is left of it to do is CudaBaker::download()'s. One call
  /// at a time; the volume stays as it is. Exact   The columns that format/shard makes of the downloaded volume, by the
  /// rules of lattice/pack; stored chunks
  ///         are its encode_chunk()'s.
  /// Cost    On the device once more what the columns take, as much again where they are compressed there, and what
  ///         pack_chunks() works with (kernels/pack/pack_chunks.cuh). Waits for the stream four times.
  /// Errors  DeviceFull: with more memory, or on the host, it can be packed. CudaFailure.
  std::optional<PackedCell> pack(const CudaVolume& volume, const PackRequest& request);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gigabake::kernels
