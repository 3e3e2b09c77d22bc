/// A controller of the image size that keeps the time per frame near a target.
#pragma once

namespace gigabake {

/// A deterministic choice of the image size from measured frame times. It assumes that the time of a frame is
/// proportional to its number of pixels.
class FrameBudget {
 public:
  static constexpr double min_share = 1.0 / 32;

  /// Takes the target time of a frame.
  /// Range   target_s > 0; any other value is replaced by 0.05 s.
  explicit FrameBudget(double target_s);

  /// Returns the next image's width and height as a fraction of the full size: a multiple of 1/32 from min_share to 1.
  double share() const { return share_; }
  /// Records the time of a frame whose edges have the fraction `share` of the full size. Has no effect unless `seconds`
  /// and `share` are positive and finite.
  void took(double seconds, double share);

 private:
  double target_s_, full_s_ = 0;  ///< full_s_: smoothed time of a full-size frame; 0: unknown
  double share_ = 0.125;          ///< initial value, fast on any machine
};

}  // namespace gigabake
