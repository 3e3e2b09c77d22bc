#include "format/export/voxel_tiles/archive_3tz.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <libdeflate.h>
#include <limits>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/io/bytes.h"
#include "format/export/voxel_tiles/md5.h"
#include "format/system/output_file.h"
#include "format/system/publish.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

constexpr const char* index_name = "@3dtilesIndex1@";
constexpr std::uint16_t stored = 0, deflated = 8, plain_zip = 20, zip64 = 45;
constexpr std::uint16_t first_of_1980 = 0x21;  ///< the earliest date that ZIP supports
constexpr std::uint32_t regular_file = 0100644u << 16;

struct ZipEntry {
  std::string name;
  std::uint16_t method = stored;
  std::uint32_t crc = 0, packed_bytes = 0, bytes = 0;
  std::uint64_t at = 0;  ///< offset of the entry's local header

  /// Writes the fields that the local header and the central directory share.
  void put(ByteWriter& to, std::uint16_t extra_bytes) const {
    for (const std::uint16_t value : {std::uint16_t(1 << 11), method, std::uint16_t(0), first_of_1980}) to.put(value);
    for (const std::uint32_t value : {crc, packed_bytes, bytes}) to.put(value);
    to.put(std::uint16_t(name.size()));
    to.put(extra_bytes);
  }
};

void put_text(ByteWriter& to, const std::string& text) {
  for (const char c : text) to.put(c);
}

std::vector<std::uint8_t> local_header(const ZipEntry& entry) {
  ByteWriter header;
  header.put(std::uint32_t(0x04034b50));
  header.put(plain_zip);
  entry.put(header, 0);
  put_text(header, entry.name);
  return header.take();
}

/// Returns an entry of the central directory. An offset of 4 GiB or more is stored in an extra field.
std::vector<std::uint8_t> directory_entry(const ZipEntry& entry) {
  constexpr std::uint32_t elsewhere = std::numeric_limits<std::uint32_t>::max();
  const bool is_far = entry.at >= elsewhere;
  ByteWriter header;
  header.put(std::uint32_t(0x02014b50));
  header.put(std::uint16_t(3 << 8 | zip64));  // made on Unix
  header.put(is_far ? zip64 : plain_zip);
  entry.put(header, is_far ? 12 : 0);
  for (int field = 0; field < 3; ++field) header.put(std::uint16_t(0));  // no comment, disk 0, binary
  header.put(regular_file);
  header.put(is_far ? elsewhere : std::uint32_t(entry.at));
  put_text(header, entry.name);
  if (is_far) {
    header.put(std::uint16_t(1));
    header.put(std::uint16_t(8));
    header.put(entry.at);
  }
  return header.take();
}

std::vector<std::uint8_t> end_of_directory(std::uint64_t entries, std::uint64_t at, std::uint64_t bytes) {
  ByteWriter end;
  const bool is_large = entries >= 0xffff || at >= 0xffffffffu || bytes >= 0xffffffffu;
  if (is_large) {
    end.put(std::uint32_t(0x06064b50));
    end.put(std::uint64_t(44));
    end.put(zip64);
    end.put(zip64);
    end.put(std::uint64_t(0));  // two disk numbers
    for (const std::uint64_t value : {entries, entries, bytes, at}) end.put(value);
    end.put(std::uint32_t(0x07064b50));
    end.put(std::uint32_t(0));
    end.put(at + bytes);
    end.put(std::uint32_t(1));
  }
  end.put(std::uint32_t(0x06054b50));
  end.put(std::uint32_t(0));
  for (int twice = 0; twice < 2; ++twice) end.put(std::uint16_t(is_large ? 0xffff : entries));
  end.put(std::uint32_t(is_large ? 0xffffffffu : bytes));
  end.put(std::uint32_t(is_large ? 0xffffffffu : at));
  end.put(std::uint16_t(0));
  return end.take();
}

/// Returns the index, sorted by the hashes of the names. A hash is compared as two little-endian 64-bit numbers; the
/// first number is more significant.
std::vector<std::uint8_t> index_of(const std::vector<ZipEntry>& entries) {
  struct Row {
    std::array<std::uint64_t, 2> hash;
    std::uint64_t at;
  };
  std::vector<Row> rows;
  for (const ZipEntry& entry : entries) {
    const std::array<std::uint8_t, 16> hash = md5_of(entry.name);
    Row& row = rows.emplace_back(Row{{}, entry.at});
    std::memcpy(row.hash.data(), hash.data(), 16);
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.hash < b.hash; });
  ByteWriter index;
  for (const Row& row : rows) index.put(row);
  return index.take();
}

class ArchiveWriter {
 public:
  ArchiveWriter(const std::filesystem::path& archive, const std::filesystem::path& temporary)
      : out_(archive, temporary) {}

  void add(const std::string& name, const std::filesystem::path& file) {
    const std::vector<std::uint8_t> bytes = read_whole_file(file);
    constexpr std::size_t gzip_head = 10, gzip_end = 8;
    if (bytes.size() < gzip_head + gzip_end || bytes[0] != 0x1f || bytes[1] != 0x8b) return add(name, bytes);
    ZipEntry entry{name, deflated};
    std::memcpy(&entry.crc, bytes.data() + bytes.size() - 8, 4);
    std::memcpy(&entry.bytes, bytes.data() + bytes.size() - 4, 4);
    put(entry, std::span(bytes).subspan(gzip_head, bytes.size() - gzip_head - gzip_end));
  }

  void add(const std::string& name, std::span<const std::uint8_t> bytes) {
    ZipEntry entry{name, stored, libdeflate_crc32(0, bytes.data(), bytes.size())};
    entry.bytes = std::uint32_t(bytes.size());
    put(entry, bytes);
  }

  void finish() {
    add(index_name, index_of(entries_));
    const std::uint64_t directory_at = at_;
    for (const ZipEntry& entry : entries_) write(directory_entry(entry));
    write(end_of_directory(entries_.size(), directory_at, at_ - directory_at));
    out_.finish();
  }

 private:
  void put(ZipEntry entry, std::span<const std::uint8_t> packed) {
    if (packed.size() >= 0xffffffffu)
      throw InputError(entry.name, "", "takes 4 GiB or more; a file in an archive must be smaller");
    entry.packed_bytes = std::uint32_t(packed.size());
    entry.at = at_;
    write(local_header(entry));
    write(packed);
    entries_.push_back(std::move(entry));
  }
  void write(std::span<const std::uint8_t> bytes) {
    out_.write(bytes);
    at_ += bytes.size();
  }

  OutputFile out_;
  std::uint64_t at_ = 0;
  std::vector<ZipEntry> entries_;
};

}  // namespace

void write_archive_3tz(const std::filesystem::path& folder, const std::filesystem::path& archive,
                       const Progress& progress) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder).generic_string());
  std::sort(names.begin(), names.end());
  progress.step("packing the archive", names.size(), "file");
  Publication publication(archive, Leftovers::remove);
  ArchiveWriter writer(archive, publication.temporary());
  for (const std::string& name : names) {
    writer.add(name, folder / name);
    progress.advance();
  }
  writer.finish();
  publication.publish();
}

}  // namespace gigabake
