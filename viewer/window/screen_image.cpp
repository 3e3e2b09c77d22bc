#include "viewer/window/screen_image.h"

#include <GLFW/glfw3.h>

namespace gigabake {
namespace {

/// A constant of OpenGL 1.2, which headers of OpenGL 1.1 lack.
constexpr GLint clamp_to_edge = 0x812F;

}  // namespace

ScreenImage::ScreenImage() {
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, clamp_to_edge);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, clamp_to_edge);
}

ScreenImage::~ScreenImage() { glDeleteTextures(1, &texture_); }

void ScreenImage::set(const Picture& picture) {
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, picture.width, picture.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               picture.rgba.data());
  is_set_ = true;
}

void ScreenImage::draw(int width, int height) const {
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  if (!is_set_) return;
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  glDisable(GL_BLEND);
  glEnable(GL_TEXTURE_2D);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glColor4f(1, 1, 1, 1);
  glBegin(GL_TRIANGLE_STRIP);  // row 0 of the image is at the top
  for (const int corner : {0, 1, 2, 3}) {
    const float right = float(corner % 2), down = float(corner / 2);
    glTexCoord2f(right, down);
    glVertex2f(2 * right - 1, 1 - 2 * down);
  }
  glEnd();
  glDisable(GL_TEXTURE_2D);
}

}  // namespace gigabake
