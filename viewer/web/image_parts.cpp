#include "viewer/web/image_parts.h"

namespace gigabake {
namespace {

const std::string part_head = "--frame\r\nContent-Type: image/jpeg\r\n\r\n";
constexpr std::string_view jpeg_start = "\xff\xd8";
/// The maximum content of a JPEG's comment segment, and the number of such segments that fill a proxy's buffers.
constexpr int max_comment_bytes = 65533, large_comments = 4;
/// The number of fill() calls between keepalives; calls are about a second apart. Proxies close replies that send
/// nothing for 60 s (nginx) or 30 s.
constexpr int fills_between_keepalives = 5;

}  // namespace

std::string ImageParts::comment(int bytes) {
  const int length = bytes + 2;
  std::string out = has_comment_ ? "" : std::string(jpeg_start);
  has_comment_ = true;
  out += {'\xff', '\xfe', char(length >> 8), char(length & 255)};
  for (int i = 0; i < bytes; ++i) out += char(random_() >> 8);
  return out;
}

std::string ImageParts::add(std::string_view jpeg) {
  std::string out = has_started_ ? "" : part_head;
  out += has_comment_ ? jpeg.substr(jpeg_start.size()) : jpeg;
  out += "\r\n" + part_head;
  has_started_ = true;
  has_comment_ = false;
  fills_ = 0;
  return out;
}

std::string ImageParts::fill() {
  if (!has_started_) return "";
  const int number = fills_++;
  if (number < large_comments) return comment(max_comment_bytes);
  return number % fills_between_keepalives == 0 ? comment(0) : "";
}

}  // namespace gigabake
