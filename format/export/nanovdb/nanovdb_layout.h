/// The binary layout of a NanoVDB file, version 32, as defined by nanovdb/NanoVDB.h and nanovdb/util/IO.h.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/vec3.h"

namespace gigabake::nanovdb_layout {

inline constexpr std::uint64_t magic = 0x304244566f6e614e;  ///< "NanoVDB0"
inline constexpr std::uint32_t version = 32u << 21 | 4u << 10 | 2u;
inline constexpr std::uint32_t has_bbox = 2, is_breadth_first = 32;  ///< GridData::flags
inline constexpr std::uint8_t leaf_has_bbox = 2;
inline constexpr std::uint64_t node_is_active = 2;
inline constexpr std::uint32_t class_voxel_volume = 7;  ///< cubes: index (i, j, k) is [i, i+1) × [j, j+1) × [k, k+1)
inline constexpr std::uint32_t no_checksum = 0xffffffff;

struct alignas(4) Rgba8 {
  static constexpr std::uint32_t grid_type = 12;
  std::array<std::uint8_t, 4> c{};
};
struct Vec3f {
  static constexpr std::uint32_t grid_type = 6;
  Vec3<float> v{};
};

struct UInt32 {
  static constexpr std::uint32_t grid_type = 10;
  std::uint32_t v = 0;
};

struct IndexBox {
  Vec3<std::int32_t> min{INT32_MAX, INT32_MAX, INT32_MAX}, max{INT32_MIN, INT32_MIN, INT32_MIN};
};

struct FileHeader {
  std::uint64_t magic_number = magic;
  std::uint32_t file_version = version;
  std::uint16_t grids = 0;
  std::uint16_t codec = 0;  ///< 0: uncompressed
};

/// Metadata of one grid. In the file, the zero-terminated name of the grid follows.
struct FileMetaData {
  std::uint64_t grid_bytes = 0, file_bytes = 0, name_key = 0, voxels = 0;
  std::uint32_t grid_type = 0, grid_class = class_voxel_volume;
  std::array<double, 6> world_box{};
  IndexBox index_box;
  Vec3d voxel_size{};
  std::uint32_t name_bytes = 0;
  std::array<std::uint32_t, 4> nodes{0, 0, 0, 1};  ///< number of leaf, lower, upper and root nodes
  Vec3<std::uint32_t> tiles{};
  std::uint16_t codec = 0, padding = 0;
  std::uint32_t file_version = version;
};

struct Map {
  std::array<float, 9> matrix_f{}, inverse_f{};
  std::array<float, 3> translation_f{};
  float taper_f = 1;
  std::array<double, 9> matrix{}, inverse{};
  Vec3d translation{};
  double taper = 1;
};

struct alignas(32) GridData {
  std::uint64_t magic_number = magic;
  std::uint32_t head_crc = no_checksum, node_crc = no_checksum;
  std::uint32_t grid_version = version;
  std::uint32_t flags = is_breadth_first;
  std::uint32_t grid_index = 0, grid_count = 1;
  std::uint64_t grid_bytes = 0;
  std::array<char, 256> name{};
  Map map;
  std::array<double, 6> world_box{};
  Vec3d voxel_size{};
  std::uint32_t grid_class = class_voxel_volume, grid_type = 0;
  std::int64_t blind_data_offset = 0;
  std::uint32_t blind_data_count = 0;
  std::uint32_t data0 = 0;
  std::uint64_t data1 = 0, data2 = 0;
};

struct alignas(32) TreeData {
  /// Offsets in bytes from this structure to the first leaf, first lower node, first upper node and the root.
  std::array<std::uint64_t, 4> node_offset{};
  Vec3<std::uint32_t> nodes{};  ///< number of leaf, lower and upper nodes
  Vec3<std::uint32_t> tiles{};
  std::uint64_t voxels = 0;
};

template <class Value>
struct alignas(32) RootData {
  IndexBox box;
  std::uint32_t tiles = 0;
  Value background, minimum, maximum;
  float average = 0, deviation = 0;
};

struct alignas(32) RootTile {
  std::uint64_t key = 0;
  std::int64_t child = 0;  ///< offset of the child in bytes from the root
  std::uint32_t state = 0;
  Vec3<std::uint32_t> value{};
};

/// A node with (2^log2)³ children. Child (x, y, z) has number x << 2·log2 | y << log2 | z.
template <class Value, int log2>
struct alignas(32) InternalNode {
  static constexpr std::size_t children = std::size_t(1) << (3 * log2);
  union Child {
    Value value;
    std::int64_t offset = 0;  ///< offset of the child in bytes from this node
  };
  IndexBox box;
  std::uint64_t flags = node_is_active;
  std::array<std::uint64_t, children / 64> value_mask{}, child_mask{};
  Value minimum, maximum;
  float average = 0, deviation = 0;
  alignas(32) std::array<Child, children> table{};
};
template <class Value>
using UpperNode = InternalNode<Value, 5>;
template <class Value>
using LowerNode = InternalNode<Value, 4>;

/// A leaf. Voxel (x, y, z) has number x << 6 | y << 3 | z.
template <class Value>
struct alignas(32) LeafNode {
  Vec3<std::int32_t> box_min{};
  Vec3<std::uint8_t> box_extent{};
  std::uint8_t flags = leaf_has_bbox;
  std::array<std::uint64_t, 8> mask{};
  Value minimum, maximum;
  float average = 0, deviation = 0;
  alignas(32) std::array<Value, 512> values{};
};

static_assert(sizeof(FileHeader) == 16 && sizeof(FileMetaData) == 176 && sizeof(Map) == 264);
static_assert(sizeof(GridData) == 672 && sizeof(TreeData) == 64 && sizeof(RootTile) == 32);
static_assert(sizeof(RootData<Rgba8>) == 64 && sizeof(RootData<UInt32>) == 64 && sizeof(RootData<Vec3f>) == 96);
static_assert(sizeof(UpperNode<Rgba8>) == 270400 && sizeof(UpperNode<Vec3f>) == 532544);
static_assert(sizeof(LowerNode<Rgba8>) == 33856 && sizeof(LowerNode<Vec3f>) == 66624);
static_assert(sizeof(LeafNode<Rgba8>) == 2144 && sizeof(LeafNode<UInt32>) == 2144 && sizeof(LeafNode<Vec3f>) == 6272);

}  // namespace gigabake::nanovdb_layout
