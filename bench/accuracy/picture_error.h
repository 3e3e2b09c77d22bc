/// How far a picture of voxels is from the reference of the same camera.
#pragma once

#include "bench/accuracy/linear_picture.h"

namespace gigabake::bench {

/// Over all pixels of the picture, or over its *scene*: the pixels where either picture has anything.
struct PictureError {
  double psnr_black_db = 0, psnr_white_db = 0;  ///< of sRGB codes over the scene, before that background; at most 100
  double silhouette_iou = 0;                    ///< pixels that are at least half covered: in both, of those in either
  double coverage_bias = 0;                     ///< mean of alpha minus the reference's, over the scene
  double holes = 0;                             ///< mean of 1 - alpha where the reference is opaque
  double rms_colour = 0;                        ///< straight linear RGB, where both are at least half covered
  double delta_e = 0;                           ///< CIE76, mean over the same pixels
  double flip = 0;                              ///< mean over all pixels, before black or white: the worse
};

/// Colour is compared straight, where there is some in both, so that a hole counts once: as a hole.
/// Range  pictures of one size.
PictureError picture_error(const LinearPicture& reference, const LinearPicture& picture);

/// Each figure's mean; of the bias, the mean magnitude.
PictureError mean_error(const std::vector<PictureError>& errors);

}  // namespace gigabake::bench
