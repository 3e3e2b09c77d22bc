/// Names, types and widths of a shard's columns, shared by reader and writer.
#pragma once

#include <string>
#include <vector>

#include "core/codec/packed_level.h"
#include "format/shard/columns/shared_values.h"
#include "format/shard/columns/voxel_channel.h"
#include "format/shard/hdf5/hdf5_file.h"

namespace gigabake {

inline constexpr char shard_format[] = "gigabake-shard";
inline constexpr std::int32_t shard_version = 9;

/// The first version whose levels store differences. Earlier levels store masks and values.
inline constexpr std::int32_t first_version_of_differences = 7;
/// The first versions with leaves and with classes. A shard gets the lowest version that has its content, so that
/// earlier programs read it.
inline constexpr std::int32_t first_version_of_leaves = 8, first_version_of_classes = 9;
inline constexpr std::int32_t oldest_shard_version = 1;

struct NodeColumns {
  explicit NodeColumns(std::int32_t version)
      : directional_coverage{"/nodes/facing", Hdf5Type::u8,
                             version >= 3 ? directional_coverage_bytes : coverage_bytes} {}
  Hdf5Column key{"/nodes/key", Hdf5Type::u64, 1, BytePlanes::of_elements};
  Hdf5Column lod{"/nodes/lod", Hdf5Type::u8, 1};
  Hdf5Column kind{"/nodes/kind", Hdf5Type::u8, 1};
  Hdf5Column child_mask{"/nodes/child_mask", Hdf5Type::u8, 1};
  Hdf5Column leaf_mask{"/nodes/leaf_mask", Hdf5Type::u8, 1};  ///< only in shards with leaves
  Hdf5Column first_child{"/nodes/first_child", Hdf5Type::u32, 1, BytePlanes::of_elements};
  Hdf5Column value{"/nodes/value", Hdf5Type::u32, 1, BytePlanes::of_elements};
  Hdf5Column normal{"/nodes/normal", Hdf5Type::i8, 2};
  Hdf5Column voxel_class{"/nodes/class", Hdf5Type::u16, 1, BytePlanes::of_elements};  ///< only in shards with classes
  Hdf5Column directional_coverage;  ///< versions 1 and 2 have no planes

  /// Calls visit(column, pointer to the NodeTable member) for each column, in the order of the file.
  template <class Visit>
  void for_each(const ShardHeader& header, const Visit& visit) const {
    visit(key, &NodeTable::key);
    visit(lod, &NodeTable::lod);
    visit(kind, &NodeTable::kind);
    visit(child_mask, &NodeTable::child_mask);
    visit(first_child, &NodeTable::first_child);
    visit(value, &NodeTable::value);
    visit(normal, &NodeTable::normal);
    if (header.leaf_lod != 0) visit(leaf_mask, &NodeTable::leaf_mask);
    if (header.has_directional_coverage) visit(directional_coverage, &NodeTable::directional_coverage);
    if (header.has_classes) visit(voxel_class, &NodeTable::voxel_class);
  }
  std::vector<Hdf5Column> all(const ShardHeader& header) const {
    std::vector<Hdf5Column> columns;
    for_each(header, [&](const Hdf5Column& column, auto) { columns.push_back(column); });
    return columns;
  }
};

inline std::string level_group(int lod) { return "/lod_" + std::to_string(lod); }

/// Returns a column of a level since version 7.
Hdf5Column level_column(int lod, LevelColumn column);

/// The columns of a level in versions 1 to 6, without the channels.
struct LevelColumns {
  explicit LevelColumns(int lod) : LevelColumns(level_group(lod)) {}
  explicit LevelColumns(std::string name)
      : group(std::move(name)),
        mask{group + "/mask", Hdf5Type::u64, 8},
        first{group + "/first", Hdf5Type::u64, 1, BytePlanes::of_elements} {}
  std::string group;
  Hdf5Column mask, first;
};

/// The columns of DownsampleState. `lod` is the lattice level of the shard's coarsest level.
struct DownsampleStateColumns {
  explicit DownsampleStateColumns(int lod) : raster{"/above/raster", Hdf5Type::u8, raster_bytes(lod)} {}
  Hdf5Column place{"/above/place", Hdf5Type::u8, source_place_bytes};
  Hdf5Column rgba{"/above/rgba", Hdf5Type::u8, 4};
  Hdf5Column normal{"/above/normal", Hdf5Type::i8, 2};
  Hdf5Column raster;
  Hdf5Column patch{"/above/patch", Hdf5Type::u8, source_patch_bytes};
  Hdf5Column voxel_class{"/above/class", Hdf5Type::u16, 1, BytePlanes::of_elements};
};

/// Converts the stored rows of NodeColumns::directional_coverage. Bytes of a DirectionalCoverage that a stored row
/// lacks are zero.
std::vector<DirectionalCoverage> directional_coverage_of_rows(const std::vector<std::uint8_t>& bytes,
                                                              const Hdf5Column& column);

/// The columns of one channel in versions 1 to 6. `share` and `first` exist only if voxels share values
/// (shared_values.h).
struct ChannelColumns {
  ChannelColumns(const std::string& group, const VoxelChannel& channel)
      : value{group + "/" + channel.name, channel.type, channel.width},
        share{value.name + "_share", Hdf5Type::u8, share_bytes},
        first{value.name + "_first", Hdf5Type::u64, 1, BytePlanes::of_elements} {}
  Hdf5Column value, share, first;
};

}  // namespace gigabake
