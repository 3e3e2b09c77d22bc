/// The errors of an image of voxels relative to the reference image from the same camera.
#pragma once

#include "bench/accuracy/linear_picture.h"

namespace gigabake::bench {

/// The errors over all pixels, or over the *scene*: the pixels in which at least one of the two images is not empty.
struct PictureError {
  double psnr_black_db = 0, psnr_white_db = 0;  ///< of sRGB codes over the scene, per background; max 100
  double silhouette_iou = 0;                    ///< intersection over union of pixels with alpha ≥ ½
  double coverage_bias = 0;                     ///< mean of alpha minus the reference's, over the scene
  double holes = 0;                             ///< mean of 1 - alpha where the reference is opaque
  double rms_colour = 0;                        ///< straight linear RGB, where both are at least half covered
  double delta_e = 0;                           ///< CIE76, mean over the same pixels
  double flip = 0;                              ///< mean over all pixels; the larger of black and white background
};

/// Compares an image with its reference. Straight colours are compared only where both images are at least half
/// covered, so that a hole counts only as a hole.
/// Range   Both images have the same size.
PictureError picture_error(const LinearPicture& reference, const LinearPicture& picture);

/// Returns the mean of each number; for the bias, the mean magnitude.
PictureError mean_error(const std::vector<PictureError>& errors);

}  // namespace gigabake::bench
