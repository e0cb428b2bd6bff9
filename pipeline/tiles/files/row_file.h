/// A cloud file as rows of bytes that are read and copied piece by piece, whatever its size.
///
/// Binary PLY (little-endian, points without lists), binary PCD, LAS. Text and compressed files have no row
/// whose place could be known; they are refused with what to do. Any number of threads may read.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "pipeline/io/formats/las/las_scale.h"
#include "pipeline/io/stream/sink.h"
#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::tiles {

/// An open file.
class RowFile {
 public:
  /// \throw Failure: input_unreadable, or usage for a file that cannot be read in pieces.
  RowFile(const std::filesystem::path& path, const Context& context);
  /// The same of a file's bytes, which must outlive it.
  RowFile(std::string_view bytes, std::string name, const Context& context);

  std::uint64_t rows() const { return rows_; }
  io::Format format() const { return format_; }
  const std::array<io::Field, 3>& coordinates() const { return field_; }  ///< the fields x, y, z

  /// Has LAS coordinates in steps of at most `step`, as io::refine_scale, from here on. `box`: of old and new
  /// coordinates.
  io::RefinedScale refine_scale(double step, const Eigen::AlignedBox3d& box);

  /// The scanner's place, as far as the header and the first rows tell (pipeline/viewpoint.h).
  std::optional<Eigen::Vector3d> viewpoint(const Context& context) const;

  /// Whether the file has a field of a normal.
  bool has_normals() const;
  /// Has fields for normals: those there are, else new ones behind the others, of NaN from here on. \throw
  /// Failure (usage) for LAS, and for fields that cannot take them.
  void need_normals();
  /// Sets the normal of row i of the bytes of some.
  void put_normal(io::Bytes& rows, std::size_t i, const Eigen::Vector3d& normal) const;

  /// The coordinates of row i of the bytes of some.
  Eigen::Vector3d get(const io::Bytes& rows, std::size_t i) const;
  /// Sets them; a coordinate equal to the present one keeps its bytes.
  void put(io::Bytes& rows, std::size_t i, const Eigen::Vector3d& xyz) const;

  /// Calls `visit(first, count, rows)` for all rows in order, with the bytes of some at once.
  template <class Visit>
  void for_each_piece(const Context& context, Visit&& visit) const {
    constexpr std::uint64_t kPiece = 1 << 16;  // rows
    for (std::uint64_t first = 0; first < rows_; first += kPiece) {
      const auto count = std::size_t(std::min<std::uint64_t>(kPiece, rows_ - first));
      io::Bytes rows = read(first, count, context);
      visit(first, count, rows);
    }
  }

  /// Copies the file, each piece of rows as `change(first, count, rows)` leaves it. The box in the header of
  /// a LAS file is what set_box made it. Memory: one piece.
  template <class Change>
  void copy(io::Sink& to, Change&& change, const Context& context) const {
    to.write(head_);
    for_each_piece(context, [&](std::uint64_t first, std::size_t count, io::Bytes& rows) {
      change(first, count, rows);
      to.write({rows.data(), rows.size()});
    });
    copy_tail(to, context);
  }

  /// Puts the box into the header of a LAS file, for `copy`.
  void set_box(const Eigen::AlignedBox3d& box);

 private:
  /// Bytes of rows [first, first + count).
  io::Bytes read(std::uint64_t first, std::size_t count, const Context& context) const;
  void copy_tail(io::Sink& to, const Context& context) const;
  void open(const Context& context);
  void open_table(io::Cloud cloud, std::uint64_t at, const Context& context);

  /// A field in a row.
  struct InRow {
    io::Field field;
    std::size_t offset;
  };

  io::Source source_;
  io::Cloud header_;  ///< of PLY and PCD: no rows
  std::array<io::Field, 3> field_;
  std::array<std::size_t, 3> offset_{};
  std::uint64_t at_ = 0, rows_ = 0;
  std::size_t row_ = 0;    ///< bytes
  std::size_t added_ = 0;  ///< bytes behind each row, of fields that the file does not have
  std::vector<std::array<InRow, 3>> normals_;
  std::size_t header_bytes_ = 0;
  io::Format format_{};
  std::array<io::ScaleChange, 3> change_;  ///< of LAS
  std::string head_;
};

/// Where the scanner stood, if all files tell the same place. \throw Failure.
std::optional<Eigen::Vector3d> common_viewpoint(const std::vector<std::string>& paths,
                                                const Context& context);

}  // namespace rfsmooth::pipeline::tiles
