/// Formats that are not read or written here, and what to do with a file in one.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace rfsmooth::pipeline::io {

/// A format of somebody else.
struct OtherFormat {
  const char* name;        ///< "OBJ"
  const char* extensions;  ///< ".glb .gltf", lower case
  const char* magic;       ///< what such a file begins with; "" if anything
  const char* advice;      ///< how to come by a file that is read here
  const char* instead = "write .ply, .pcd, .xyz, .off or .las and convert that";  ///< of writing it
};

/// The format of a file that begins with these bytes; null if it is none that we know of.
const OtherFormat* other_format_of_bytes(std::string_view first_bytes);

/// The format that the path's extension stands for; null if it is none that we know of.
const OtherFormat* other_format_of_extension(const std::filesystem::path& path);

}  // namespace rfsmooth::pipeline::io
