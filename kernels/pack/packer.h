/// Packing of a baked cell's columns on the device. Only the columns are transferred; the host never receives voxels.
///
/// In builds without CUDA, the constructor of CudaPacker always throws.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/codec/packed_level.h"
#include "kernels/body/cell.h"
#include "kernels/cuda/baker.h"

namespace gigabake::kernels {

/// The format in which columns are transferred to the host.
enum class ColumnBytes : std::uint8_t {
  raw,     ///< rows in order, for compression on the host
  stored,  ///< chunks in storage format, compressed by deflate
};

struct PackRequest {
  std::vector<std::vector<LevelColumn>> levels;  ///< [lod]; the columns of each level
  std::vector<RowShape> nodes;                   ///< row shapes of the node table's columns, by NodeColumn
  ColumnBytes as = ColumnBytes::stored;
  std::uint64_t memory_bytes = 0;  ///< limit of device memory for temporary arrays and columns; 0: no limit
};

/// A packed cell: columns instead of voxels.
struct PackedCell {
  std::vector<PackedLevel> levels;    ///< [lod]; levels and nodes borrow `memory`
  std::vector<PackedColumn> nodes;    ///< in the order of PackRequest::nodes
  NodeTable constants;                ///< the constant nodes: only `kind`, `lod` and `value`
  std::vector<Hash128> content_hash;  ///< [lod]
  DownsampleState above;              ///< as in CellVolume
  CellStats stats;
  std::shared_ptr<const void> memory;  ///< page-locked; the packer reuses it after the last reference is released
};

/// A packer with a separate stream, so that a CudaBaker of the same device can bake the next cell concurrently.
class CudaPacker {
 public:
  /// Errors  CudaFailure.
  explicit CudaPacker(int device);
  ~CudaPacker();
  CudaPacker(const CudaPacker&) = delete;
  CudaPacker& operator=(const CudaPacker&) = delete;

  /// Packs a cell; does not change `volume`. Calls must not be concurrent. Returns nullopt if the cell was baked in
  /// parts or has no voxels; the caller must then use CudaBaker::download().
  /// Exact   The columns equal the columns that format/shard makes of the downloaded volume by the rules of
  ///         core/codec. Stored chunks equal the output of encode_chunk() of format/shard.
  /// Cost    Device memory: the size of the columns, the same again if they are compressed, and the temporary memory of
  ///         pack_chunks() (kernels/pack/pack_chunks.cuh). If this exceeds `request.memory_bytes`, packs groups of one
  ///         or more columns one after another. Waits for the stream twice, and twice per group.
  /// Errors  DeviceFull: the device memory or `request.memory_bytes` does not suffice; packing on the host may succeed.
  ///         CudaFailure.
  std::optional<PackedCell> pack(const CudaVolume& volume, const PackRequest& request);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gigabake::kernels
