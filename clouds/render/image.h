/// A picture in memory, and its PNG.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace rfsmooth::render {

/// Red, green, blue in [0, 1], as shown (sRGB).
using Color = Eigen::Vector3f;

struct Image {
  Image() = default;
  Image(int w, int h, const Color& fill)
      : width(w), height(h), pixels(std::size_t(w) * std::size_t(h), fill) {}
  Color& at(int x, int y) { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
  const Color& at(int x, int y) const { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }

  int width = 0, height = 0;
  std::vector<Color> pixels;  ///< row by row from the top
};

/// The mean of `factor` x `factor` pixels each: smooth edges.
Image shrink(const Image& image, int factor);

/// Copies `source` to (x, y) of `target`, cut at its borders.
void paste(Image& target, const Image& source, int x, int y);

/// Writes printable ASCII in a 5 x 7 font, `scale` pixels a dot, top left corner at (x, y); cut at the
/// borders.
void write_text(Image& image, int x, int y, std::string_view text, const Color& color, int scale);
int text_width(std::string_view text, int scale);
int text_height(int scale);

/// The picture as the bytes of a PNG (8 bits a channel), in so many levels of brightness. \throw
/// std::bad_alloc
std::string to_png(const Image& image, int levels = 256);

}  // namespace rfsmooth::render
