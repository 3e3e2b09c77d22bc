/// An image on the screen, rendered by OpenGL 2.1 only.
#pragma once

#include "viewer/pictures/picture.h"

namespace gigabake {

/// A texture that fills the window. An OpenGL context must be current from construction to destruction.
class ScreenImage {
 public:
  ScreenImage();
  ~ScreenImage();
  ScreenImage(const ScreenImage&) = delete;
  ScreenImage& operator=(const ScreenImage&) = delete;

  void set(const Picture& picture);
  /// Fills a framebuffer of this size with the image, or with black before the first set().
  void draw(int width, int height) const;

 private:
  unsigned texture_ = 0;
  bool is_set_ = false;
};

}  // namespace gigabake
