#include "pipeline/tiles/row_file.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pipeline/io/detect.h"
#include "pipeline/io/formats/las/las_fields.h"
#include "pipeline/io/formats/las/las_header.h"
#include "pipeline/io/formats/pcd.h"
#include "pipeline/io/formats/ply.h"

namespace rfsmooth::pipeline::tiles {

namespace {

[[noreturn]] void refuse_pieces(const std::string& name, const std::string& why) {
  throw Failure({ErrorCode::usage,
                 fmt::format("{}: {}, so it cannot be read in pieces; write it as binary PLY, binary PCD or "
                             "LAS, or give the machine the memory for the whole",
                             name, why)});
}

}  // namespace

RowFile::RowFile(const std::filesystem::path& path, const Context& context) : source_(path, context) {
  format_ = io::detect_format(source_, context);
  switch (format_) {
    case io::Format::ply: {
      io::HeaderLines lines(source_, context);
      io::Cloud cloud = io::read_ply_header(lines);
      open_table(std::move(cloud), lines.offset(), context);
      break;
    }
    case io::Format::pcd: {
      io::HeaderLines lines(source_, context);
      io::Cloud cloud = io::read_pcd_header(lines);
      open_table(std::move(cloud), lines.offset(), context);
      break;
    }
    case io::Format::las: {
      const io::las::Header header = io::las::read_header(source_, context);
      const io::Bytes head = source_.read(0, std::size_t(header.points), context);
      bool described = true;
      const std::vector<io::Field> fields = io::las::fields_of({head.data(), head.size()}, described);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        field_[axis] = fields[axis];
        offset_[axis] = 4 * axis;
      }
      at_ = header.points;
      rows_ = header.count;
      row_ = header.row_size;
      break;
    }
    default:
      refuse_pieces(source_.name(), "is text");
  }
  if (row_ == 0 || rows_ > (source_.size() - at_) / row_)
    source_.fail(fmt::format("byte {}: expected {} points of {} bytes each, found {} bytes", at_, rows_, row_,
                             source_.size() - at_));
  const io::Bytes head = source_.read(0, std::size_t(at_), context);
  head_.assign(head.data(), head.size());
}

void RowFile::open_table(io::Cloud cloud, std::uint64_t at, const Context& context) {
  if (cloud.encoding != io::Encoding::binary_little_endian)
    refuse_pieces(source_.name(), fmt::format("its encoding is {}", io::name_of(cloud.encoding)));
  std::size_t vertex = 0;
  while (vertex < cloud.elements.size() && cloud.format == io::Format::ply &&
         cloud.elements[vertex].name != "vertex")
    ++vertex;
  if (vertex == cloud.elements.size()) source_.fail("expected an element 'vertex', found none");
  cloud.vertex = vertex;
  io::find_coordinates(cloud, source_, context);
  for (std::size_t e = 0; e <= vertex; ++e)
    if (cloud.elements[e].has_lists()) refuse_pieces(source_.name(), "it has lists before or in its points");
  for (std::size_t e = 0; e < vertex; ++e) at += cloud.elements[e].count * cloud.elements[e].row_size();
  const io::Table& points = cloud.points();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    field_[axis] = points.fields[cloud.xyz[axis]];
    for (std::size_t f = 0; f < cloud.xyz[axis]; ++f)
      offset_[axis] += points.fields[f].count * io::size_of(points.fields[f].type);
  }
  at_ = at;
  rows_ = points.count;
  row_ = points.row_size();
}

io::RefinedScale RowFile::refine_scale(double step, const std::array<double, 3>& low,
                                       const std::array<double, 3>& high) {
  io::RefinedScale done;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    io::Field& field = field_[axis];
    const double a = (low[axis] - field.offset) / field.scale, b = (high[axis] - field.offset) / field.scale;
    done.before[axis] = field.scale;
    change_[axis] = io::finer_scale(field, step, std::min(a, b), std::max(a, b));
    if (change_[axis].power > 0) {
      io::change_scale(field, change_[axis]);
      io::las::put_number(head_, io::las::kScaleAt + 8 * axis, field.scale);
      io::las::put_number(head_, io::las::kOffsetAt + 8 * axis, field.offset);
    }
    done.after[axis] = field.scale;
    done.shift[axis] = change_[axis].shift;
  }
  return done;
}

io::Bytes RowFile::read(std::uint64_t first, std::size_t count, const Context& context) const {
  io::Bytes rows = source_.read(at_ + first * row_, count * row_, context);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; change_[axis].power > 0 && i < count; ++i)
      io::change_integer(rows.data() + i * row_ + offset_[axis], change_[axis]);
  return rows;
}

std::array<double, 3> RowFile::get(const io::Bytes& rows, std::size_t i) const {
  std::array<double, 3> xyz{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    xyz[axis] = io::load(field_[axis], rows.data() + i * row_ + offset_[axis]);
  return xyz;
}

void RowFile::put(io::Bytes& rows, std::size_t i, const std::array<double, 3>& xyz) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    char* const at = rows.data() + i * row_ + offset_[axis];
    if (io::load(field_[axis], at) != xyz[axis]) io::store(field_[axis], at, xyz[axis]);
  }
}

void RowFile::set_box(const std::array<double, 3>& low, const std::array<double, 3>& high) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    io::las::put_number(head_, io::las::kBoxAt + 16 * axis, high[axis]);
    io::las::put_number(head_, io::las::kBoxAt + 16 * axis + 8, low[axis]);
  }
}

void RowFile::copy_tail(io::Sink& to, const Context& context) const {
  constexpr std::uint64_t kBytes = std::uint64_t{4} << 20;
  for (std::uint64_t at = at_ + rows_ * row_; at < source_.size(); at += kBytes) {
    const io::Bytes part = source_.read(at, std::size_t(std::min(kBytes, source_.size() - at)), context);
    to.write({part.data(), part.size()});
  }
}

}  // namespace rfsmooth::pipeline::tiles
