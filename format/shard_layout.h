/// Names, types and widths of a shard's columns, in one place for reader and writer.
#pragma once

#include <string>

#include "format/hdf5_file.h"

namespace gigabake {

inline constexpr char shard_format[] = "gigabake-shard";
inline constexpr std::int32_t shard_version = 1;

struct NodeColumns {
  Hdf5Column key{"/nodes/key", H5T_STD_U64LE, 1, 8};
  Hdf5Column lod{"/nodes/lod", H5T_STD_U8LE, 1, 1};
  Hdf5Column kind{"/nodes/kind", H5T_STD_U8LE, 1, 1};
  Hdf5Column child_mask{"/nodes/child_mask", H5T_STD_U8LE, 1, 1};
  Hdf5Column first_child{"/nodes/first_child", H5T_STD_U32LE, 1, 4};
  Hdf5Column value{"/nodes/value", H5T_STD_U32LE, 1, 4};
  Hdf5Column normal{"/nodes/normal", H5T_STD_I8LE, 2, 1};
};

struct LevelColumns {
  explicit LevelColumns(int lod) : LevelColumns("/lod_" + std::to_string(lod)) {}
  explicit LevelColumns(std::string name)
      : group(std::move(name)),
        mask{group + "/mask", H5T_STD_U64LE, 8, 8},
        first{group + "/first", H5T_STD_U64LE, 1, 8},
        rgba{group + "/rgba", H5T_STD_U8LE, 4, 1},
        normal{group + "/normal", H5T_STD_I8LE, 2, 1} {}
  std::string group;
  Hdf5Column mask, first, rgba, normal;
};

}  // namespace gigabake
