/// The version of these headers. Before 1.0 a new minor version may change the interface; a patch does not.
#pragma once

/// The first number.
#define RFSMOOTH_VERSION_MAJOR 0
/// The second number.
#define RFSMOOTH_VERSION_MINOR 1
/// The third number.
#define RFSMOOTH_VERSION_PATCH 0

namespace rfsmooth {

/// "major.minor.patch"
inline constexpr const char* kVersion = "0.1.0";

}  // namespace rfsmooth
