#include "format/source/image/image_check.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/base/error.h"
#include "format/source/image/encoding.h"
#include "format/source/image/image_size.h"

namespace gigabake {
namespace {

/// Bytes that are read to find the header of an image. If profiles or previews make the header longer, all bytes are
/// read.
constexpr std::uint64_t usual_head_bytes = std::uint64_t(1) << 20;
/// Max distance of a JPEG's end marker from the end of the file, because some writers append bytes.
constexpr std::uint64_t jpeg_tail_bytes = std::uint64_t(1) << 18;

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns whether every chunk of texels is whole. The last chunk, IEND, may be missing, because an image can be
/// decoded without it.
bool has_all_chunks(const SourceBytes& png) {
  constexpr std::uint64_t signature_bytes = 8, frame_bytes = 12;
  std::vector<std::uint8_t> buffer;
  bool has_texels = false;
  for (std::uint64_t at = signature_bytes; at + frame_bytes <= png.size();) {
    const std::span<const std::uint8_t> head = png.look(at, 8, buffer);
    const std::uint64_t bytes = std::uint64_t(head[0]) << 24 | head[1] << 16 | head[2] << 8 | head[3];
    const std::string_view type = text_of(head.subspan(4));
    if (type == "IEND") return has_texels;
    if (bytes > png.size() - at - frame_bytes) return false;
    has_texels |= type == "IDAT";
    at += frame_bytes + bytes;
  }
  return has_texels;
}

bool has_end_marker(const SourceBytes& jpeg) {
  std::vector<std::uint8_t> buffer;
  const std::uint64_t bytes = std::min(jpeg.size(), jpeg_tail_bytes);
  return text_of(jpeg.look(jpeg.size() - bytes, bytes, buffer)).find("\xff\xd9") != std::string_view::npos;
}

/// Returns whether the file has all bytes that its RIFF header states.
/// Source  WebP container: the length behind "RIFF" does not count the first 8 bytes.
bool has_all_of_riff(const SourceBytes& webp) {
  std::vector<std::uint8_t> buffer;
  const std::span<const std::uint8_t> head = webp.look(0, 8, buffer);
  const std::uint64_t bytes = head[4] | head[5] << 8 | head[6] << 16 | std::uint64_t(head[7]) << 24;
  return bytes + 8 <= webp.size();
}

bool is_whole(const SourceBytes& bytes, Encoding encoding) {
  if (encoding == Encoding::png) return has_all_chunks(bytes);
  return encoding == Encoding::jpeg ? has_end_marker(bytes) : has_all_of_riff(bytes);
}

void check_head(EncodedImage& head, const SourceBytes& bytes) {
  try {
    image_size(head);
  } catch (const InputError&) {
    if (head.bytes.size() == bytes.size()) throw;
    head.bytes = bytes.copy();
    image_size(head);
  }
}

}  // namespace

void check_image(const std::filesystem::path& file, const std::string& key, const SourceBytes& bytes) {
  if (bytes.empty()) throw InputError(file, key, "is empty");
  std::vector<std::uint8_t> buffer;
  const auto first = bytes.look(0, std::min(bytes.size(), usual_head_bytes), buffer);
  EncodedImage head{file.string() + ": " + key, {first.begin(), first.end()}};
  check_head(head, bytes);
  if (!is_whole(bytes, encoding_of(head))) throw InputError(file, key, "the image is cut short");
}

}  // namespace gigabake
