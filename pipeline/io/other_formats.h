/// Formats that are not supported, and what to do with a file in one of them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace rfsmooth::pipeline::io {

/// An unsupported format.
struct OtherFormat {
  const char* name;        ///< "OBJ"
  const char* extensions;  ///< ".glb .gltf", lower case
  const char* magic;       ///< what such a file begins with; "" if anything
  const char* advice;      ///< how to come by a file that is read here
  bool text = false;       ///< whether such a file is text, or may be
  const char* instead = "write .ply, .pcd, .xyz, .off or .las and convert that";  ///< of writing it
};

/// The path's extension in lower case, ".ply"; "" if it has none.
std::string extension_of(const std::filesystem::path& path);

/// The unsupported format of a file that begins with these bytes; null if unknown.
const OtherFormat* other_format_of_bytes(std::string_view first_bytes);

/// The unsupported format for the path's extension; null if unknown.
const OtherFormat* other_format_of_extension(const std::filesystem::path& path);

}  // namespace rfsmooth::pipeline::io
