#include "clouds/render/image.h"

#include <algorithm>
#include <cmath>
#include <new>

#include <png.h>

namespace rfsmooth::render {

Image shrink(const Image& image, int factor) {
  Image out(image.width / factor, image.height / factor, Color::Zero());
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      Color sum = Color::Zero();
      for (int dy = 0; dy < factor; ++dy)
        for (int dx = 0; dx < factor; ++dx) sum += image.at(x * factor + dx, y * factor + dy);
      out.at(x, y) = sum / float(factor * factor);
    }
  return out;
}

void paste(Image& target, const Image& source, int x, int y) {
  for (int row = std::max(0, -y); row < source.height && y + row < target.height; ++row)
    for (int column = std::max(0, -x); column < source.width && x + column < target.width; ++column)
      target.at(x + column, y + row) = source.at(column, row);
}

std::string to_png(const Image& image, int levels) {
  std::vector<png_byte> bytes(3 * image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    Color color = image.pixels[i].cwiseMax(0.0F).cwiseMin(1.0F);
    // The brightest channel is rounded and the others go with it, so that no colour changes its hue.
    const float brightest = color.maxCoeff(), top = float(levels - 1);
    if (brightest > 0) color *= std::round(top * brightest) / top / brightest;
    for (int channel = 0; channel < 3; ++channel)
      bytes[3 * i + std::size_t(channel)] = png_byte(std::lround(255 * color[channel]));
  }
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = png_uint_32(image.width);
  header.height = png_uint_32(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (png_image_write_to_memory(&header, nullptr, &size, 0, bytes.data(), 0, nullptr) == 0)
    throw std::bad_alloc();
  std::string out(size, '\0');
  if (png_image_write_to_memory(&header, out.data(), &size, 0, bytes.data(), 0, nullptr) == 0)
    throw std::bad_alloc();
  out.resize(size);
  return out;
}

}  // namespace rfsmooth::render
