#include "format/shard/hdf5/chunk_table.h"

#include <sstream>
#include <stdexcept>
#include <utility>

namespace gigabake {
namespace {

constexpr std::uint64_t deflate_bit = 1, shuffle_bit = 2;
constexpr std::size_t numbers_of_column = 4, numbers_of_chunk = 2;

[[noreturn]] void fail_malformed() { throw std::invalid_argument("does not match the attribute 'columns'"); }

/// Takes the numbers of the next column.
ChunkedColumn taken_column(std::span<const std::uint64_t>& numbers) {
  if (numbers.size() < numbers_of_column) fail_malformed();
  ChunkedColumn column{numbers[0], numbers[1], numbers[2], Codec::lz4, (numbers[3] & shuffle_bit) != 0, {}};
  if ((numbers[3] & deflate_bit) != 0) column.codec = Codec::deflate;
  if (numbers[3] > (deflate_bit | shuffle_bit) || (column.rows != 0) != (column.chunk_rows != 0)) fail_malformed();
  numbers = numbers.subspan(numbers_of_column);
  const std::uint64_t chunks = column.chunk_count();
  if (chunks > numbers.size() / numbers_of_chunk) fail_malformed();
  for (std::uint64_t c = 0; c < chunks; ++c) column.chunks.push_back({numbers[2 * c], numbers[2 * c + 1]});
  numbers = numbers.subspan(numbers_of_chunk * chunks);
  return column;
}

}  // namespace

ChunkTable::ChunkTable(const Stored& stored) {
  std::span<const std::uint64_t> numbers = stored.numbers;
  std::istringstream names(stored.names);
  for (std::string name; names >> name;) {
    if (columns_.contains(name)) fail_malformed();
    add(name, taken_column(numbers));
  }
  if (!numbers.empty()) fail_malformed();
}

void ChunkTable::add(const std::string& name, ChunkedColumn column) {
  columns_.emplace(name, std::move(column));
  names_.push_back(name);
}

ChunkTable::Stored ChunkTable::stored() const {
  Stored out;
  for (const std::string& name : names_) {
    const ChunkedColumn& column = columns_.at(name);
    out.names += (out.names.empty() ? "" : " ") + name;
    const std::uint64_t filters =
        (column.codec == Codec::deflate ? deflate_bit : 0) | (column.is_shuffled ? shuffle_bit : 0);
    for (const std::uint64_t number : {column.rows, column.chunk_rows, column.row_bytes, filters})
      out.numbers.push_back(number);
    for (const ChunkPlace& chunk : column.chunks) {
      out.numbers.push_back(chunk.offset);
      out.numbers.push_back(chunk.bytes);
    }
  }
  return out;
}

const ChunkedColumn* ChunkTable::find(const std::string& name) const {
  const auto found = columns_.find(name);
  return found == columns_.end() ? nullptr : &found->second;
}

}  // namespace gigabake
