#include "scheduler/journal/journal_tail.h"

#include <utility>

#include "format/system/read_file.h"

namespace gigabake {

void JournalTail::read_new(const std::function<void(const Hash128&, const CellReport&)>& visit) {
  FileTail tail = read_tail(path_, at_);
  if (tail.inode != inode_ || tail.size < at_) {
    inode_ = tail.inode;
    if (std::exchange(at_, 0) != 0) tail = read_tail(path_, 0);
  }
  if (tail.bytes.empty()) return;
  const std::string_view header = journal_header();
  if (at_ != 0) tail.bytes.insert(tail.bytes.begin(), header.begin(), header.end());
  const JournalContent content(std::move(tail.bytes));
  content.for_each(visit);
  if (content.whole_bytes() != 0) at_ += content.whole_bytes() - (at_ != 0 ? header.size() : 0);
}

}  // namespace gigabake
