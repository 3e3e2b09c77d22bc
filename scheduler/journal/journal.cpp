#include "scheduler/journal/journal.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/error.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

constexpr std::size_t max_unsynced = 64;
constexpr std::chrono::milliseconds max_unsynced_time(200);

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

Journal::Journal(std::filesystem::path path, const JournalContent& so_far)
    : path_(std::move(path)), bytes_(so_far.whole_bytes()) {
  if (so_far.is_wasteful()) rewrite(so_far.compacted([](const Hash128&) { return true; }));
}

Journal::~Journal() {
  if (file_.is_open() && unsynced_ != 0) ::fdatasync(file_.get());  // an error cannot be reported here
}

void Journal::open() {
  file_ = Descriptor(path_, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW);
  if (!file_.is_open()) give_up("open");
  // Bytes after the complete records would hide every later record.
  if (::ftruncate(file_.get(), off_t(bytes_)) != 0) give_up("cut");
  if (bytes_ != 0) return;
  const auto header = bytes_of(journal_header());
  if (!file_.write_all(header)) give_up("write");
  bytes_ = header.size();
}

void Journal::rewrite(const std::vector<std::uint8_t>& content) {
  publish_file(path_, {reinterpret_cast<const char*>(content.data()), content.size()});
  file_ = Descriptor();
  bytes_ = content.size();
  unsynced_ = 0;
}

void Journal::give_up(const char* what) {
  const int reason = errno;
  std::string more;
  if (file_.is_open() && ::ftruncate(file_.get(), off_t(bytes_)) != 0)
    more = "; its last record is incomplete";  // the next bake truncates it
  file_ = Descriptor();
  has_failed_ = true;
  throw InputError(path_, "",
                   std::string("cannot ") + what + ": " + std::strerror(reason) + more +
                       "; the next bake checks the cells that are finished from here on");
}

void Journal::append(const CellJob& job, const CellReport& report) {
  if (has_failed_ || report.outcome == CellOutcome::failed) return;
  if (!file_.is_open()) open();
  const std::vector<std::uint8_t> record = journal_record({job.fingerprint, job.name, report});
  if (!file_.write_all(record)) give_up("write");
  bytes_ += record.size();
  const auto now = Clock::now();
  if (unsynced_++ == 0) first_unsynced_ = now;
  if (unsynced_ >= max_unsynced || now - first_unsynced_ >= max_unsynced_time) sync();
}

void Journal::sync() {
  if (!file_.is_open() || unsynced_ == 0) return;
  if (::fdatasync(file_.get()) != 0) give_up("flush to disk");
  unsynced_ = 0;
}

void Journal::keep_only(const std::vector<CellJob>& jobs) {
  if (has_failed_) return;
  std::unordered_set<std::string> names;  // as hexadecimal text, as in names of shards
  for (const CellJob& job : jobs) names.insert(job.fingerprint.hex());
  rewrite(read_journal(path_).compacted([&](const Hash128& f) { return names.contains(f.hex()); }));
}

}  // namespace gigabake
