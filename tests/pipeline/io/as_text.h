/// Clouds as the text that they are written as.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "pipeline/io/io.h"

namespace rfsmooth::pipeline::io {

inline std::string as(const Cloud& cloud, Format format, bool drop = false) {
  WriteOptions options;
  options.format = format;
  options.drop_unsupported = drop;
  const auto text = serialize_cloud(cloud, options, {});
  return text.ok() ? text.value() : "refused: " + text.error().message;
}

/// Moves the second of the points (1, 2, 3) and (4, 5, 6) to another y: the text changes there and nowhere
/// else.
inline void expect_that_y_comes_back(Cloud& cloud, const std::string& text, const std::string& y) {
  const double moved[] = {1, 2, 3, 4, std::stod(y), 6};
  set_positions(cloud, moved);
  std::string expected = text;
  expected.replace(expected.rfind('5'), 1, y);
  EXPECT_EQ(as(cloud, Format::xyz), expected);
}

}  // namespace rfsmooth::pipeline::io
