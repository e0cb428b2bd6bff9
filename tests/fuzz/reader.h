/// What every reader's fuzz target does: read; if that works, write, read again, and come to the same bytes;
/// move the points, convert, cut. What does not hold is thrown, with what it was: a finding of the fuzzer, a
/// failure of a test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "pipeline/io/io.h"
#include "pipeline/io/mesh_file.h"

namespace rfsmooth::fuzz {

/// \param format to read as; none: found by content
inline int read_write_read(std::optional<pipeline::io::Format> format, const std::uint8_t* data,
                           std::size_t size) {
  namespace io = pipeline::io;
  const Context context = [] {
    Context c;
    c.threads = 1;
    return c;
  }();
  io::ReadOptions options;
  options.format = format;
  auto cloud = io::parse_cloud({reinterpret_cast<const char*>(data), size}, "fuzz", options, context);
  if (!cloud.ok()) return 0;
  const std::string once = io::serialize_cloud(cloud.value(), {}, context).value();
  options.format = cloud.value().format;
  const auto again = io::parse_cloud(once, "again", options, context);
  if (!again.ok()) throw std::logic_error("written, then refused: " + again.error().message);
  if (io::serialize_cloud(again.value(), {}, context).value() != once)
    throw std::logic_error("written twice: not the same bytes");
  std::vector<double> xyz = io::positions(cloud.value(), context);
  for (double& v : xyz) v += 0.125;
  io::set_positions(cloud.value(), xyz.data(), context);
  for (const io::Format to :
       {io::Format::ply, io::Format::pcd, io::Format::xyz, io::Format::off, io::Format::las}) {
    io::WriteOptions target;
    target.format = to;
    target.drop_unsupported = true;
    const auto text = io::serialize_cloud(cloud.value(), target, context);
    io::ReadOptions back;
    back.format = to;
    const std::string name(io::name_of(to));
    // A record of LAS holds 65,535 bytes.
    if (!text.ok() && text.error().message.find("no room for so many fields") != std::string::npos) continue;
    if (!text.ok()) throw std::logic_error("not converted to " + name + ": " + text.error().message);
    // XYZ has no way to say "no points".
    if (to == io::Format::xyz && cloud.value().size() == 0) continue;
    const auto converted = io::parse_cloud(text.value(), "converted", back, context);
    if (!converted.ok())
      throw std::logic_error("converted to " + name + ", then refused: " + converted.error().message);
    // LAS has no points that are not finite.
    if (to != io::Format::las && converted.value().size() != cloud.value().size())
      throw std::logic_error("converted to " + name + ": not as many points");
  }
  try {
    io::faces_of(cloud.value(), context);
  } catch (const Failure&) {
    // Faces that name points that are not there.
  }
  std::vector<std::size_t> rows;
  for (std::size_t i = 1; i < cloud.value().size(); i += 2) rows.push_back(i);
  io::select_points(cloud.value(), rows, context);
  const auto cut = io::serialize_cloud(cloud.value(), {}, context);
  if (!cut.ok()) throw std::logic_error("cut, then not written: " + cut.error().message);
  return 0;
}

}  // namespace rfsmooth::fuzz
