/// A picture on the screen, through OpenGL 2.1 and nothing newer.
#pragma once

#include "viewer/pictures/picture.h"

namespace gigabake {

/// Needs a current context, from construction to destruction.
class ScreenPicture {
 public:
  ScreenPicture();
  ~ScreenPicture();
  ScreenPicture(const ScreenPicture&) = delete;
  ScreenPicture& operator=(const ScreenPicture&) = delete;

  void set(const Picture& picture);
  /// Fills the framebuffer of that size; black before the first set().
  void draw(int width, int height) const;

 private:
  unsigned texture_ = 0;
  bool is_set_ = false;
};

}  // namespace gigabake
