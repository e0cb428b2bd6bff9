#include "pipeline/tiles/files/row_file.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/detect.h"
#include "pipeline/io/formats/las/las_fields.h"
#include "pipeline/io/formats/las/las_header.h"
#include "pipeline/io/formats/pcd.h"
#include "pipeline/io/formats/ply.h"
#include "pipeline/io/point_fields.h"
#include "pipeline/io/table/rows.h"
#include "pipeline/viewpoint.h"

namespace rfsmooth::pipeline::tiles {

namespace {

[[noreturn]] void refuse_pieces(const std::string& name, const std::string& why) {
  fail(
      ErrorCode::usage,
      "{}: {}, so it cannot be read in pieces; write it as binary PLY (little-endian), binary PCD or LAS, or "
      "give the machine the memory for the whole",
      name, why);
}

}  // namespace

RowFile::RowFile(const std::filesystem::path& path, const Context& context) : source_(path, context) {
  open(context);
}

RowFile::RowFile(std::string_view bytes, std::string name, const Context& context)
    : source_(bytes, std::move(name)) {
  open(context);
}

void RowFile::open(const Context& context) {
  format_ = io::detect_format(source_, context);
  switch (format_) {
    case io::Format::ply:
    case io::Format::pcd: {
      io::HeaderLines lines(source_, context);
      io::Cloud cloud = format_ == io::Format::ply ? io::read_ply_header(lines) : io::read_pcd_header(lines);
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
  const io::Bytes head = source_.read(0, std::size_t(at_), context);
  head_.assign(head.data(), head.size());
}

void RowFile::open_table(io::Cloud cloud, std::uint64_t at, const Context& context) {
  if (cloud.encoding != io::Encoding::binary_little_endian)
    refuse_pieces(source_.name(), fmt::format("its encoding is {}", io::name_of(cloud.encoding)));
  header_bytes_ = std::size_t(at);
  if (cloud.format == io::Format::ply) io::find_vertex(cloud, source_);
  io::find_coordinates(cloud, source_, context);
  for (std::size_t e = 0; e <= cloud.vertex; ++e) {
    if (cloud.elements[e].has_lists()) refuse_pieces(source_.name(), "it has lists before or in its points");
    at_ = at;
    at = io::end_of_rows(cloud.elements[e], at, source_);
  }
  header_ = std::move(cloud);
  const io::Table& points = header_.points();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    field_[axis] = points.fields[header_.xyz[axis]];
    offset_[axis] = points.offset_of(header_.xyz[axis]);
  }
  rows_ = points.count;
  row_ = points.row_size();
}

std::optional<Eigen::Vector3d> RowFile::viewpoint(const Context& context) const {
  if (format_ != io::Format::pcd) return std::nullopt;
  constexpr std::size_t kLooked = 1 << 18;  // points
  io::Cloud top = header_;
  std::vector<double> xyz;
  if (top.width > kLooked / 2) top.height = 1;  // two rows are too many: the header alone has a say
  if (top.organised() && top.width > 0) {
    top.height = std::min(kLooked / top.width, top.height);
    const io::Bytes rows = read(0, top.width * top.height, context);
    for (std::size_t i = 0; i < top.width * top.height; ++i)
      for (const double x : get(rows, i)) xyz.push_back(x);
  }
  return recorded_viewpoint(top, xyz.data(), context);
}

bool RowFile::has_normals() const {
  return format_ != io::Format::las && io::has_normals(header_);
}

void RowFile::need_normals() {
  if (format_ == io::Format::las)
    fail(ErrorCode::usage, "{}: LAS gets no normals in tiles; write the cloud as PLY", source_.name());
  io::Table& points = header_.points();
  const auto take = [&](const io::NormalNames& names) {
    std::vector<std::size_t> there;
    for (const char* name : names) {
      io::check_field(header_, name, io::Scalar::float32);
      if (const auto field = io::find_field(header_, name)) there.push_back(*field);
    }
    if (there.size() < names.size()) return;
    const auto in_row = [&](std::size_t f) { return InRow{points.fields[f], points.offset_of(f)}; };
    normals_.push_back({in_row(there[0]), in_row(there[1]), in_row(there[2])});
  };
  for (const io::NormalNames& names : {io::kPlyNormal, io::kPcdNormal}) take(names);
  if (!normals_.empty()) return;
  const bool pcd = format_ == io::Format::pcd;
  const io::NormalNames& names = pcd ? io::kPcdNormal : io::kPlyNormal;
  for (const char* name : names)
    if (!io::find_field(header_, name)) {
      points.fields.push_back({name, io::Scalar::float32});
      added_ += io::size_of(io::Scalar::float32);
    }
  take(names);
  head_.replace(0, header_bytes_,
                pcd ? io::pcd_header(header_, header_.encoding) : io::ply_header(header_, header_.encoding));
}

void RowFile::put_normal(io::Bytes& rows, std::size_t i, const Eigen::Vector3d& normal) const {
  for (const auto& fields : normals_)
    for (std::size_t axis = 0; axis < 3; ++axis)
      io::store(fields[axis].field, rows.data() + i * (row_ + added_) + fields[axis].offset,
                normal[Eigen::Index(axis)]);
}

io::RefinedScale RowFile::refine_scale(double step, const Eigen::AlignedBox3d& box) {
  io::RefinedScale done;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    io::Field& field = field_[axis];
    const auto stored = [&](const Eigen::Vector3d& end) {
      return (end[Eigen::Index(axis)] - field.offset) / field.scale;
    };
    const double a = stored(box.min()), b = stored(box.max());
    change_[axis] = io::refine_axis(field, axis, step, std::min(a, b), std::max(a, b), done);
    if (change_[axis].power == 0) continue;
    io::las::put_number(head_, io::las::kScaleAt + 8 * axis, field.scale);
    io::las::put_number(head_, io::las::kOffsetAt + 8 * axis, field.offset);
  }
  return done;
}

io::Bytes RowFile::read(std::uint64_t first, std::size_t count, const Context& context) const {
  io::Bytes rows = source_.read(at_ + first * row_, count * row_, context);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; change_[axis].power > 0 && i < count; ++i)
      io::change_integer(rows.data() + i * row_ + offset_[axis], change_[axis]);
  if (added_ == 0) return rows;
  io::Bytes wide(count * (row_ + added_));
  for (std::size_t i = 0; i < count; ++i) {
    char* const at = wide.data() + i * (row_ + added_);
    std::copy_n(rows.data() + i * row_, row_, at);
    for (std::size_t added = 0; added < added_; added += io::size_of(io::Scalar::float32))
      io::store(io::Scalar::float32, at + row_ + added, std::nan(""));
  }
  return wide;
}

Eigen::Vector3d RowFile::get(const io::Bytes& rows, std::size_t i) const {
  const char* const row = rows.data() + i * (row_ + added_);
  const auto of_axis = [&](std::size_t axis) { return io::load(field_[axis], row + offset_[axis]); };
  return {of_axis(0), of_axis(1), of_axis(2)};
}

void RowFile::put(io::Bytes& rows, std::size_t i, const Eigen::Vector3d& xyz) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    char* const at = rows.data() + i * (row_ + added_) + offset_[axis];
    const double x = xyz[Eigen::Index(axis)];
    if (io::load(field_[axis], at) != x) io::store(field_[axis], at, x);
  }
}

void RowFile::set_box(const Eigen::AlignedBox3d& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    io::las::put_number(head_, io::las::kBoxAt + 16 * axis, box.max()[Eigen::Index(axis)]);
    io::las::put_number(head_, io::las::kBoxAt + 16 * axis + 8, box.min()[Eigen::Index(axis)]);
  }
}

void RowFile::copy_tail(io::Sink& to, const Context& context) const {
  constexpr std::uint64_t kBytes = std::uint64_t{4} << 20;
  for (std::uint64_t at = at_ + rows_ * row_; at < source_.size(); at += kBytes) {
    const io::Bytes part = source_.read(at, std::size_t(std::min(kBytes, source_.size() - at)), context);
    to.write({part.data(), part.size()});
  }
}

std::optional<Eigen::Vector3d> common_viewpoint(const std::vector<std::string>& paths,
                                                const Context& context) {
  std::optional<Eigen::Vector3d> common;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto of_file = RowFile(paths[i], context).viewpoint(context);
    if (i > 0 && of_file != common) return std::nullopt;
    common = of_file;
  }
  return common;
}

}  // namespace rfsmooth::pipeline::tiles
