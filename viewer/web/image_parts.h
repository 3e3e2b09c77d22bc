/// An image stream (multipart/x-mixed-replace, JPEG) that passes through buffering proxies without delay.
#pragma once

#include <random>
#include <string>
#include <string_view>

namespace gigabake {

/// A writer of images as parts that replace each other. While there is no new image, it writes comment segments of the
/// next JPEG. These segments push the end of the last image out of a proxy's buffers, and later keep the connection
/// alive. The comments are random bytes, because a compressing proxy would shrink zeros and keep them in its buffer.
class ImageParts {
 public:
  /// Returns the rest of the current part and the head of the next part. Browsers show an image when they have read the
  /// next head.
  std::string add(std::string_view jpeg);
  /// Returns filler bytes; empty if none are due. Call fill() after each period of at least a quarter of a second
  /// without a new image.
  std::string fill();

 private:
  std::string comment(int bytes);

  std::minstd_rand random_;
  bool has_started_ = false;  ///< the head of the current part is written
  bool has_comment_ = false;  ///< the start of the current part's JPEG is written
  int fills_ = 0;             ///< calls of fill() since the last image
};

}  // namespace gigabake
