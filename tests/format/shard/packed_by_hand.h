/// A packed shard that is made on the host. Its columns may be edited, to write shards that break rules.
#pragma once

#include <algorithm>
#include <functional>
#include <list>
#include <string>
#include <vector>

#include "core/codec/chunk_rows.h"
#include "format/shard/columns/shard_columns.h"
#include "format/shard/hdf5/chunk_codec.h"
#include "format/shard/packed_shard.h"

namespace gigabake::made {

/// Owner of the data that a PackedShard borrows.
class PackedByHand {
 public:
  enum class As { raw, stored };

  PackedByHand(const Shard& shard, As as, Codec codec) : as_(as), codec_(codec) {
    packed.header = shard.header;
    packed.above = shard.above;
    packed.nodes.resize(packed_nodes(shard.header).size());
    ShardColumns columns(shard.header);
    columns.add_nodes(shard.nodes);
    columns.add_levels(shard.nodes, shard.levels, callers_thread());
    for (const BrickLevel& level : shard.levels) packed.levels.push_back(of_level(level));
    for (const ColumnRows& column : columns.columns()) take(column);
    for (std::size_t n = 0; n < shard.nodes.kind.size(); ++n) {
      if (shard.nodes.kind[n] == NodeKind::brick) continue;
      packed.constants.kind.push_back(shard.nodes.kind[n]);
      packed.constants.lod.push_back(shard.nodes.lod[n]);
      packed.constants.value.push_back(shard.nodes.value[n]);
    }
  }

  PackedShard packed;

  using Bytes = std::vector<std::uint8_t>;

  /// Changes the bytes of a raw column. `change` may also change their number.
  /// Range   The columns are raw.
  void edit(int lod, LevelColumn which, const std::function<void(Bytes&)>& change) {
    PackedColumn& column = packed.levels.at(std::size_t(lod))[which];
    Bytes& bytes = kept_.emplace_back(column.raw.begin(), column.raw.end());
    change(bytes);
    column.raw = bytes;
    column.rows = bytes.size() / row_of(which).bytes;
  }

 private:
  static PackedLevel of_level(const BrickLevel& level) {
    PackedLevel out;
    for (std::size_t i = 3; i < level.rgba.size(); i += 4) ++out.alphas[level.rgba[i]];
    return out;
  }

  PackedColumn* place_of(const std::string& name) {
    for (std::size_t lod = 0; lod < packed.levels.size(); ++lod)
      for (const LevelColumn column : level_columns(packed.header, int(lod)))
        if (name == level_column(int(lod), column).name) return &packed.levels[lod][column];
    const std::vector<Hdf5Column> nodes = NodeColumns(shard_version).all(packed.header);
    const auto of_nodes = std::find_if(nodes.begin(), nodes.end(), [&](const auto& c) { return c.name == name; });
    return &packed.nodes.at(std::size_t(of_nodes - nodes.begin()));
  }

  void take(const ColumnRows& from) {
    PackedColumn* to = place_of(from.column.name);
    to->rows = from.rows;
    if (from.rows == 0) return;
    Bytes scratch;
    const auto rows = from.get(0, from.rows, scratch);
    Bytes& raw = kept_.emplace_back(rows.begin(), rows.end());
    if (as_ == As::raw) {
      to->raw = raw;
      return;
    }
    const std::size_t bytes = chunk_bytes(from.rows, from.column.row_bytes());
    raw.resize(bytes * chunk_count(from.rows, from.column.row_bytes()));
    const ChunkFilters filters = from.column.filters(codec_);
    for (std::size_t at = 0; at < raw.size(); at += bytes)
      to->stored.push_back(kept_.emplace_back(encode_chunk(std::span(raw).subspan(at, bytes), filters)));
  }

  As as_;
  Codec codec_;
  std::list<Bytes> kept_;
};

}  // namespace gigabake::made
