/// The columns of a packed shard, readable like the columns of a file.
#pragma once

#include <map>
#include <string>

#include "format/shard/columns/stored_rows.h"
#include "format/shard/packed_shard.h"

namespace gigabake {

/// Columns in memory. Borrows the shard, whose columns must have the layout of shard_version.
class PackedColumns : public ColumnSource {
 public:
  explicit PackedColumns(const PackedShard& shard);

  const std::filesystem::path& path() const override { return path_; }
  bool has(const Hdf5Column& column) const override { return columns_.contains(column.name); }
  std::unique_ptr<StoredRows> open(const Hdf5Column& column) const override;

 private:
  std::filesystem::path path_;
  std::map<std::string, const PackedColumn*> columns_;
};

}  // namespace gigabake
