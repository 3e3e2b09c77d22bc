#include "scheduler/journal/journal_content.h"

#define XXH_INLINE_ALL
#include <algorithm>
#include <cstring>
#include <xxhash.h>

#include "core/io/bytes.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

constexpr std::uint32_t record_magic = 0x6c6c6563;  // "cell"
/// Max size of a payload in bytes. A report has a few hundred bytes, so a larger value means that the length is
/// damaged.
constexpr std::uint32_t max_payload_bytes = std::uint32_t(1) << 24;
constexpr std::uint64_t max_journal_bytes = std::uint64_t(1) << 40;

struct RecordHeader {
  std::uint32_t magic, bytes;
  std::uint64_t hash;
};
static_assert(sizeof(RecordHeader) == 16);

}  // namespace

std::string_view journal_header() { return "gigabake journal 3\n"; }

std::vector<std::uint8_t> journal_record(const JournalEntry& entry) {
  ByteWriter payload_writer;
  payload_writer.put(entry.fingerprint);
  payload_writer.put(entry.cell);
  payload_writer.put(to_bytes(entry.report));
  const std::vector<std::uint8_t> payload = payload_writer.take();
  const RecordHeader header{record_magic, std::uint32_t(payload.size()), XXH3_64bits(payload.data(), payload.size())};
  std::vector<std::uint8_t> record(sizeof header + payload.size());
  std::memcpy(record.data(), &header, sizeof header);
  std::memcpy(record.data() + sizeof header, payload.data(), payload.size());
  return record;
}

JournalContent::JournalContent(std::vector<std::uint8_t> file) : bytes_(std::move(file)) {
  const std::string_view header = journal_header();
  if (bytes_.size() < header.size() || !std::equal(header.begin(), header.end(), bytes_.begin())) return;
  whole_bytes_ = header.size();
  for (auto place = record_at(whole_bytes_); place && take(*place); place = record_at(whole_bytes_)) {
    ++records_;
    whole_bytes_ = place->at + place->bytes;
  }
}

std::optional<JournalContent::Place> JournalContent::record_at(std::size_t at) const {
  RecordHeader h{};
  if (bytes_.size() - at < sizeof h) return std::nullopt;
  std::memcpy(&h, bytes_.data() + at, sizeof h);
  const std::size_t payload = at + sizeof h;
  if (h.magic != record_magic || h.bytes > max_payload_bytes || h.bytes > bytes_.size() - payload) return std::nullopt;
  if (XXH3_64bits(bytes_.data() + payload, h.bytes) != h.hash) return std::nullopt;
  return Place{payload, h.bytes};
}

/// Adds a record. Returns false if the payload does not begin with a fingerprint and a name.
bool JournalContent::take(const Place& place) {
  Hash128 fingerprint;
  std::uint64_t name_bytes = 0;
  constexpr std::size_t before_name = sizeof fingerprint + sizeof name_bytes;
  if (place.bytes < before_name) return false;
  std::memcpy(&fingerprint, bytes_.data() + place.at, sizeof fingerprint);
  std::memcpy(&name_bytes, bytes_.data() + place.at + sizeof fingerprint, sizeof name_bytes);
  if (name_bytes > place.bytes - before_name) return false;
  cells_.insert({reinterpret_cast<const char*>(bytes_.data()) + place.at + before_name, name_bytes});
  payloads_[fingerprint] = place;
  return true;
}

std::optional<CellReport> JournalContent::find(const Hash128& fingerprint) const {
  const auto it = payloads_.find(fingerprint);
  return it == payloads_.end() ? std::nullopt : report_at(it->second);
}

std::optional<CellReport> JournalContent::report_at(const Place& place) const {
  try {
    ByteReader r(std::span<const std::uint8_t>(bytes_).subspan(place.at, place.bytes), "journal");
    JournalEntry entry;
    std::vector<std::uint8_t> report;
    r.get(entry.fingerprint);
    r.get(entry.cell);
    r.get(report);
    r.expect_end();
    return report_from_bytes(report);
  } catch (const InputError&) {
    return std::nullopt;  // complete, but written by another version of the program
  }
}

std::vector<std::pair<JournalContent::Place, Hash128>> JournalContent::in_file_order() const {
  std::vector<std::pair<Place, Hash128>> places;
  for (const auto& [fingerprint, place] : payloads_) places.emplace_back(place, fingerprint);
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first.at < b.first.at; });
  return places;
}

void JournalContent::for_each(const std::function<void(const Hash128&, const CellReport&)>& visit) const {
  for (const auto& [place, fingerprint] : in_file_order())
    if (const std::optional<CellReport> report = report_at(place)) visit(fingerprint, *report);
}

std::vector<std::uint8_t> JournalContent::compacted(const std::function<bool(const Hash128&)>& wanted) const {
  const std::string_view header = journal_header();
  std::vector<std::uint8_t> out(header.begin(), header.end());
  for (const auto& [place, fingerprint] : in_file_order())
    if (wanted(fingerprint))
      out.insert(out.end(), bytes_.begin() + std::ptrdiff_t(place.at - sizeof(RecordHeader)),
                 bytes_.begin() + std::ptrdiff_t(place.at + place.bytes));
  return out;
}

JournalContent read_journal(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::status(path, error).type() == std::filesystem::file_type::not_found) return {};
  return JournalContent(read_whole_file(path, max_journal_bytes));
}

}  // namespace gigabake
