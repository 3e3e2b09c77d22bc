#include <hdf5.h>
#include <stdexcept>

#include "core/base/error.h"
#include "format/shard/hdf5/hdf5_file.h"
#include "format/shard/hdf5/hdf5_rows.h"

namespace gigabake {
namespace {

constexpr const char* names_attribute = "columns";
const Hdf5Column table_column{"/chunks", Hdf5Type::u64, 1, BytePlanes::of_elements};

/// Returns the address of the chunk that begins with `row`.
/// Cost    Proportional to the chunk's index: HDF5 visits all chunks before it.
std::uint64_t address_of_chunk(const Hdf5Call& call, const Hdf5Id& set, const hsize_t* row) {
  unsigned skipped_filters = 0;
  haddr_t address = 0;
  hsize_t bytes = 0;
  call("H5Dget_chunk_info_by_coord", H5Dget_chunk_info_by_coord(set.get(), row, &skipped_filters, &address, &bytes));
  return address;
}

}  // namespace

void Hdf5File::write_chunk(const Hdf5Id& set, const Hdf5Column& column, std::uint64_t first_row,
                           std::span<const std::uint8_t> bytes) {
  const Hdf5Call call{path_, column.name};
  const hsize_t row[2] = {first_row, 0};
  call("H5Dwrite_chunk", H5Dwrite_chunk(set.get(), H5P_DEFAULT, 0, row, bytes.size(), bytes.data()));
  const std::uint64_t address = image_ != nullptr ? image_->last_chunk() : address_of_chunk(call, set, row);
  table_->table.add_chunk({address, bytes.size()});
}

void Hdf5File::write_chunk_table(Codec codec) {
  const ChunkTable::Stored stored = table_->table.stored();
  write_attribute(names_attribute, stored.names);
  ColumnRows rows{"", table_column, stored.numbers.size(), {}};
  rows.get = [bytes = std::as_bytes(std::span(stored.numbers))](std::uint64_t first, std::uint64_t count, auto&) {
    const auto part = bytes.subspan(first * table_column.row_bytes(), count * table_column.row_bytes());
    return std::span(reinterpret_cast<const std::uint8_t*>(part.data()), part.size());
  };
  write_columns(std::span(&rows, 1), codec, callers_thread());
}

const ChunkTable* Hdf5File::chunk_table() const {
  if (!table_->is_read) {
    const Hdf5Turn turn;  // serves as the lock
    if (!table_->is_read) read_chunk_table();
  }
  return table_->exists ? &table_->table : nullptr;
}

void Hdf5File::read_chunk_table() const {
  configure_hdf5({path_, names_attribute});
  if (has_attribute(names_attribute)) {
    const Hdf5Rows rows(*this, table_column, IndexedColumn(*this, table_column));
    ChunkTable::Stored stored{read_text(names_attribute), std::vector<std::uint64_t>(rows.rows())};
    rows.read(0, rows.rows(), stored.numbers.data());
    try {
      table_->table = ChunkTable(stored);
    } catch (const std::invalid_argument& error) {
      fail(table_column.name, error.what());
    }
    table_->exists = true;
    file_.close();
  }
  table_->is_read = true;
}

}  // namespace gigabake
