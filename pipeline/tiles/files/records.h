/// Files of records (a row of the cloud and its coordinates or its normal) that tell whether they are
/// complete.
///
/// The records, 32 or 40 bytes each, then 24 bytes: a mark, their number, and a hash of all their bytes.
/// Numbers are little-endian, as the machines that this runs on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>

#include "pipeline/io/stream/atomic_file.h"
#include "pipeline/io/stream/source.h"

namespace rfsmooth::pipeline::tiles {

/// A row of the cloud, over all its files, and where its point is, world units.
struct Record {
  std::uint64_t row = 0;
  double x = 0, y = 0, z = 0;
};
static_assert(sizeof(Record) == 32);

/// Where the point is.
inline Eigen::Vector3d place(const Record& r) {
  return {r.x, r.y, r.z};
}

/// Adds their places behind `xyz`, n x 3.
void append_places(const std::vector<Record>& points, std::vector<double>& xyz);

/// A row of the cloud and its normal, which is of a piece of the surface that a tile gave its side.
struct NormalRecord {
  std::uint64_t row = 0;
  double x = 0, y = 0, z = 0;
  std::uint64_t piece = 0;
};
static_assert(sizeof(NormalRecord) == 40);

/// Writes records; the file is there, complete, after commit().
template <class T>
class WriterOf {
 public:
  /// \throw Failure (cannot_write).
  WriterOf(const std::filesystem::path& path, const Context& context);
  void add(const T& record);
  void commit();

 private:
  void flush();
  io::AtomicFile file_;
  std::vector<T> held_;
  std::uint64_t count_ = 0, hash_;
};

/// Reads records in order, a buffer at a time.
template <class T>
class ReaderOf {
 public:
  /// \throw Failure (input_unreadable) if the file is missing or of a size that it cannot have.
  explicit ReaderOf(std::filesystem::path path, const Context& context);
  std::uint64_t size() const { return count_; }
  /// Moves on to the first record of that row or one behind it, where rows are ascending. O(log n) reads.
  void skip_to(std::uint64_t row);
  /// The next record, or null behind the last.
  const T* peek();
  void next() { ++at_; }

 private:
  std::filesystem::path path_;
  const Context& context_;
  std::vector<T> held_;
  std::uint64_t count_ = 0, from_ = 0, at_ = 0;
};

using RecordWriter = WriterOf<Record>;  ///< of coordinates
using RecordReader = ReaderOf<Record>;  ///< of coordinates

/// All of them. \throw Failure (input_unreadable).
std::vector<Record> read_records(const std::filesystem::path& path, const Context& context);

/// The number of records, if the file is there and every byte of it as it was written.
template <class T = Record>
std::optional<std::uint64_t> complete_records(const std::filesystem::path& path, const Context& context);

}  // namespace rfsmooth::pipeline::tiles
