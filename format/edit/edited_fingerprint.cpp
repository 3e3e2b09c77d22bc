#include "format/edit/edited_fingerprint.h"

#include "core/io/bytes.h"
#include "format/system/hash_bytes.h"

namespace gigabake {
namespace {

/// Precedes an edit, so that it differs from other inputs.
constexpr std::uint32_t edit_mark = 0x74696465;

}  // namespace

Hash128 edited_fingerprint(const Hash128& fingerprint, const Hash128& edit) {
  ByteWriter w;
  w.put(edit_mark), w.put(fingerprint), w.put(edit);
  return hash_of_bytes(w.take());
}

}  // namespace gigabake
