/// Clouds in the files of a test.
#pragma once

#include <string>

#include "pipeline/io/io.h"

namespace rfsmooth::test {

/// \throw Failure saying why it cannot be read.
inline pipeline::io::Cloud read(const std::string& path) {
  return value_or_throw(pipeline::io::read_cloud(path, {}, {}));
}

}  // namespace rfsmooth::test
