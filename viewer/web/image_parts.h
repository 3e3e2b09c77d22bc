/// The bytes of a multipart/x-mixed-replace stream of JPEGs whose images reach clients behind proxies that buffer.
#pragma once

#include <random>
#include <string>
#include <string_view>

namespace gigabake {

/// Writes images as parts that replace each other. While no image follows, it writes comment segments of the next JPEG:
/// they push the end of the last image out of the buffers of a proxy, and later keep the connection from timing out.
/// Comments are random bytes, since a proxy that compresses would hold zeros back.
class ImageParts {
 public:
  /// Returns the rest of the current part, and the head of the next part: browsers show an image when they have read
  /// it.
  std::string add(std::string_view jpeg);
  /// Returns what to send when no image has come for a while, a quarter of a second or more; empty if nothing is due.
  std::string fill();

 private:
  std::string comment(int bytes);

  std::minstd_rand random_;
  bool has_started_ = false;  ///< the head of the current part is written
  bool has_comment_ = false;  ///< the start of the current part's JPEG is written
  int fills_ = 0;             ///< since the last image
};

}  // namespace gigabake
