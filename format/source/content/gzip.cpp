#include "format/source/content/gzip.h"

#include <algorithm>
#include <limits>
#include <zlib.h>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr std::size_t first_bytes = std::size_t(1) << 16;

class Inflater {
 public:
  explicit Inflater(std::span<const std::uint8_t> packed) : rest_(packed) {
    constexpr int with_gzip_header = 16;
    ready_ = ::inflateInit2(&stream_, MAX_WBITS + with_gzip_header) == Z_OK;
  }
  ~Inflater() {
    if (ready_) ::inflateEnd(&stream_);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Unpacks bytes until `out` is full or the stream ends. Returns the number of unpacked bytes.
  std::size_t fill(std::span<std::uint8_t> out) {
    std::size_t done = 0;
    int state = ready_ ? Z_OK : Z_MEM_ERROR;
    while (state == Z_OK && done < out.size()) {
      const auto in = uInt(std::min<std::size_t>(rest_.size(), std::numeric_limits<uInt>::max()));
      const auto space = uInt(std::min<std::size_t>(out.size() - done, std::numeric_limits<uInt>::max()));
      stream_.next_in = const_cast<Bytef*>(rest_.data());  // zlib does not write to it
      stream_.avail_in = in;
      stream_.next_out = out.data() + done;
      stream_.avail_out = space;
      state = ::inflate(&stream_, Z_NO_FLUSH);
      rest_ = rest_.subspan(in - stream_.avail_in);
      done += space - stream_.avail_out;
    }
    ended_ = state == Z_STREAM_END;
    return done;
  }

  bool ended() const { return ended_; }  ///< the stream is complete and its checksum is correct
  std::span<const std::uint8_t> rest() const { return rest_; }

 private:
  std::span<const std::uint8_t> rest_;
  z_stream stream_{};
  bool ready_ = false, ended_ = false;
};

}  // namespace

bool is_gzip(std::span<const std::uint8_t> head) {
  return head.size() >= 3 && head[0] == 0x1f && head[1] == 0x8b && head[2] == 8;
}

std::vector<std::uint8_t> unpacked_gzip(const std::filesystem::path& file, std::span<const std::uint8_t> packed,
                                        std::uint64_t max_bytes) {
  Inflater inflater(packed);
  std::vector<std::uint8_t> out;
  for (std::size_t there = 0; !inflater.ended();) {
    // The buffer has one byte more than the limit, which shows whether the limit is exceeded.
    out.resize(std::size_t(std::min<std::uint64_t>(std::max(first_bytes, 2 * out.size()), max_bytes + 1)));
    const std::size_t more = inflater.fill(std::span(out).subspan(there));
    there += more;
    if (there > max_bytes)
      throw InputError(file, "",
                       "gzip unpacks to more than " + std::to_string(max_bytes) +
                           " bytes, the limit of a file or of `memory_bytes`");
    if (!inflater.ended() && there < out.size())
      throw InputError(file, "", "gzip ends early or is damaged", packed.size() - inflater.rest().size());
    if (inflater.ended()) out.resize(there);
  }
  if (!inflater.rest().empty())
    throw InputError(file, "", "bytes follow where the gzip content ends", packed.size() - inflater.rest().size());
  return out;
}

std::vector<std::uint8_t> unpacked_gzip_head(std::span<const std::uint8_t> packed_head, std::size_t max_bytes) {
  Inflater inflater(packed_head);
  std::vector<std::uint8_t> out(max_bytes);
  out.resize(inflater.fill(out));
  return out;
}

}  // namespace gigabake
