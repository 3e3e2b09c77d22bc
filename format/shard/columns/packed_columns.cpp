#include "format/shard/columns/packed_columns.h"

#include <cstring>

#include "core/base/error.h"
#include "core/codec/chunk_rows.h"
#include "format/shard/shard_layout.h"

namespace gigabake {
namespace {

class PackedRows : public StoredRows {
 public:
  PackedRows(const std::filesystem::path& path, const Hdf5Column& column, const PackedColumn& packed)
      : path_(path), column_(column), packed_(packed) {}

  std::uint64_t rows() const override { return packed_.rows; }

  void read(std::uint64_t first, std::uint64_t count, void* to) const override {
    if (count == 0) return;
    const std::size_t row_bytes = column_.row_bytes();
    if (!packed_.raw.empty()) {
      std::memcpy(to, packed_.raw.subspan(first * row_bytes, count * row_bytes).data(), count * row_bytes);
      return;
    }
    read_chunked_rows(first, count, rows_per_chunk(packed_.rows, row_bytes), row_bytes, to,
                      [this](std::uint64_t index, std::span<std::uint8_t> raw) { unpack(index, raw); });
  }

 private:
  void unpack(std::uint64_t index, std::span<std::uint8_t> raw) const {
    if (index >= packed_.stored.size() || !decode_chunk(packed_.stored[index], column_.filters(Codec::deflate),
                                                        chunk_bytes(packed_.rows, column_.row_bytes()), raw))
      throw InputError(path_, column_.name, "is not packed as expected");
  }

  const std::filesystem::path& path_;
  const Hdf5Column column_;
  const PackedColumn& packed_;
};

}  // namespace

PackedColumns::PackedColumns(const PackedShard& shard) : path_(shard.header.cell) {
  const std::vector<Hdf5Column> nodes = NodeColumns(shard_version).all(shard.header);
  for (std::size_t c = 0; c < nodes.size(); ++c) columns_[nodes[c].name] = &shard.nodes.at(c);
  for (std::size_t lod = 0; lod < shard.levels.size(); ++lod)
    for (const LevelColumn column : level_columns(shard.header, int(lod)))
      columns_[level_column(int(lod), column).name] = &shard.levels[lod][column];
}

std::unique_ptr<StoredRows> PackedColumns::open(const Hdf5Column& column) const {
  const auto found = columns_.find(column.name);
  if (found == columns_.end()) throw InputError(path_, column.name, "is missing");
  return std::make_unique<PackedRows>(path_, column, *found->second);
}

}  // namespace gigabake
