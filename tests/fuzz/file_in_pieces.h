/// What must hold of a file's bytes that are read in pieces, as `rfsmooth tiles` does: the fuzz target
/// `read_rows` runs it on what libFuzzer finds, the test program on the committed corpus.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "base/fail.h"
#include "pipeline/io/io.h"
#include "pipeline/tiles/files/row_file.h"

namespace rfsmooth::fuzz {

/// The coordinates as the pieces have them.
inline std::vector<double> coordinates_in_pieces(const pipeline::tiles::RowFile& file, const Context& one) {
  std::vector<double> xyz;
  file.for_each_piece(one, [&](std::uint64_t, std::size_t count, const pipeline::io::Bytes& rows) {
    for (std::size_t i = 0; i < count; ++i)
      for (const double x : file.get(rows, i)) xyz.push_back(x);
  });
  return xyz;
}

/// Whoever reads the file as a whole finds the same points.
inline void compare_with_whole(std::string_view bytes, const std::vector<double>& xyz, const Context& one) {
  const auto cloud = pipeline::io::parse_cloud(bytes, "whole", {}, one);
  if (!cloud.ok()) return;  // what is behind the points may be broken
  const std::vector<double> whole = pipeline::io::positions(cloud.value(), one);
  if (whole.size() != xyz.size()) std::abort();
  if (!xyz.empty() && std::memcmp(whole.data(), xyz.data(), xyz.size() * sizeof(double)) != 0) std::abort();
}

/// Broken files are refused as such, and take no memory for what they only promise.
inline void check_refusal(const Error& error) {
  const bool right = error.code == ErrorCode::input_unreadable || error.code == ErrorCode::usage;
  if (!right || error.message.empty()) std::abort();
}

/// Aborts on a finding. Returns whether the file could be read.
inline bool file_in_pieces(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  Context one;
  one.threads = 1;
  const auto read = guarded([&] {
    pipeline::tiles::RowFile file(bytes, "fuzz", one);
    compare_with_whole(bytes, coordinates_in_pieces(file, one), one);
    file.viewpoint(one);
    pipeline::io::BufferSink same;
    file.copy(
        same, [](std::uint64_t, std::size_t, pipeline::io::Bytes&) {}, one);
    if (same.buffer != bytes) std::abort();
    return file.format();
  });
  if (!read.ok()) {
    check_refusal(read.error());
    return false;
  }
  const auto with_normals = guarded([&] {
    pipeline::tiles::RowFile file(bytes, "fuzz", one);
    file.need_normals();
    pipeline::io::BufferSink changed;
    file.copy(
        changed,
        [&](std::uint64_t, std::size_t count, pipeline::io::Bytes& rows) {
          for (std::size_t i = 0; i < count; ++i) file.put_normal(rows, i, {0, 0, 1});
        },
        one);
    const pipeline::tiles::RowFile again(changed.buffer, "again", one);
    if (again.rows() != file.rows() || !again.has_normals()) std::abort();
    return Done{};
  });
  if (!with_normals.ok()) check_refusal(with_normals.error());
  return true;
}

}  // namespace rfsmooth::fuzz
