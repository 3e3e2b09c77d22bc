/// How large a moving picture may be so that a frame takes as long as asked.
#pragma once

namespace gigabake {

/// A value: the same times give the same sizes. Takes a frame's time to grow with its pixels.
class FramePace {
 public:
  static constexpr double least_share = 1.0 / 32;

  /// Range  target_s > 0, else a twentieth of a second.
  explicit FramePace(double target_s);

  /// Of the full width and height; a multiple of 1/32 from least_share to 1.
  double share() const { return share_; }
  /// A frame of that share of the edge took so long. Ignored unless both are positive and finite.
  void took(double seconds, double share);

 private:
  double target_s_, full_s_ = 0;  ///< what a full frame takes, smoothed
  double share_ = 0.125;          ///< nothing is known yet: quick on any machine
};

}  // namespace gigabake
