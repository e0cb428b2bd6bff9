/// Files of clouds and meshes, PLY, PCD, XYZ, OFF and LAS, read and written without losing anything.
///
///     auto file = CloudFile::read("scan.ply");            // Result: the format is known by its content
///     std::vector<double> xyz = file.value().positions(); // n x 3
///     denoise(xyz.data(), xyz.size() / 3, {}, {});
///     file.value().set_positions(xyz.data());             // only what moved changes
///     file.value().write("clean.ply");                    // by extension; complete or not at all
///
/// Only what you set changes. Everything else comes back byte for byte: field order, types and names, rows
/// with NaN, other PLY elements, comments, width x height, viewpoint.
///
/// Reading and writing can be cancelled; what reads or changes the file in memory runs to its end, with the
/// threads and the log of the context that it is given.
///
/// Several threads may read one object; only one may change it, while no other reads. A moved-from object can
/// only be assigned to or destroyed.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/result.h>

namespace rfsmooth {

/// The kind of file.
enum class Format { ply, pcd, xyz, off, las };
/// How its numbers are written.
enum class Encoding { ascii, binary_little_endian, binary_big_endian, binary_compressed };

/// How to read.
struct ReadOptions {
  std::optional<Format> format;  ///< empty: known by the content
};

/// How to write.
struct WriteOptions {
  std::optional<Format> format;      ///< empty: known by the extension of the path, else the cloud's own
  std::optional<Encoding> encoding;  ///< empty: the cloud's own, or the target format's nearest to it
  bool force = false;                ///< replace an existing file
  bool drop_unsupported = false;     ///< leave out what the target format cannot carry, instead of refusing
  bool sync = true;                  ///< wait until the file is safe on the disk
};

/// A file in memory: n points and all that stands beside them.
class CloudFile {
 public:
  /// Reads a file; pipes and devices are read to their end. Errors: input_unreadable, and the message says
  /// the line or byte, what was expected and what was found; out_of_memory; cancelled. Needs memory for one
  /// copy of the file, and 8 bytes for each row of text or with lists; while it is read up to two copies of
  /// several large elements of that kind, of what comes through a pipe, and of what compressed points unpack
  /// to. O(bytes), as all below.
  static Result<CloudFile> read(const std::filesystem::path& path, const ReadOptions& options = {},
                                const Context& context = {});
  /// Reads a buffer; error messages call it `name`. Errors: as `read`.
  static Result<CloudFile> parse(std::string_view bytes, const std::string& name,
                                 const ReadOptions& options = {}, const Context& context = {});
  /// n x 3 row-major coordinates as float64, and nothing else.
  static CloudFile of_points(const double* xyz, std::size_t n);

  CloudFile(const CloudFile& other);
  CloudFile& operator=(const CloudFile& other);
  CloudFile(CloudFile&& other) noexcept;
  CloudFile& operator=(CloudFile&& other) noexcept;
  ~CloudFile();

  /// Writes a temporary file beside `path` and renames it, so that `path` is complete or unchanged. Errors:
  /// cannot_write (also for an existing file without `force`); usage if the format cannot carry what the
  /// cloud has.
  Result<Done> write(const std::filesystem::path& path, const WriteOptions& options = {},
                     const Context& context = {}) const;
  /// Writes to a buffer. Errors: usage as for `write`, out_of_memory, cancelled.
  Result<std::string> serialize(const WriteOptions& options = {}, const Context& context = {}) const;

  Format format() const;
  Encoding encoding() const;
  std::size_t size() const;                   ///< n
  std::array<std::size_t, 2> extent() const;  ///< width x height = n; height 1: not organised

  /// n x 3 row-major, as doubles whatever the file's type.
  std::vector<double> positions(const Context& context = {}) const;
  /// Sets n x 3 coordinates, each rounded to nearest in its field's type (LAS: to the file's scale; a warning
  /// is logged for what 32 bits cannot say). A coordinate that equals the present one keeps its bytes or
  /// text.
  void set_positions(const double* xyz, const Context& context = {});

  /// Names of the points' fields, in file order; names may repeat.
  std::vector<std::string> field_names() const;
  /// One double per point; none if there is no such field, or it is a list or an array.
  std::optional<std::vector<double>> field(std::string_view name, const Context& context = {}) const;
  /// Sets a field of the points. A field of that name keeps its place and type; else one is appended as
  /// float32. Errors: usage if the present field cannot take the values, or if there is none and the name is
  /// not one word, as headers ask for. \throw std::invalid_argument if there is not one value per point.
  Result<Done> set_field(const std::string& name, const std::vector<double>& values,
                         const Context& context = {});

  /// Keeps the points `rows`, in that order. Unless these are all in order, the cloud is no longer organised.
  /// Faces, and other elements that name points by index, stay where all of their points do, and get the new
  /// indices. \throw std::invalid_argument if there is no such row.
  void select(const std::vector<std::size_t>& rows, const Context& context = {});

  /// The file's polygons, split into triangles; empty without faces. Errors: input_unreadable if one names a
  /// vertex that does not exist.
  Result<std::vector<Face>> faces(const Context& context = {}) const;
  /// Replaces the faces by triangles (m x 3), corners below n. Only PLY and OFF can carry them: writing
  /// another format is an error then, unless `drop_unsupported`.
  void set_faces(const std::vector<Face>& faces);

 private:
  struct Contents;
  explicit CloudFile(std::unique_ptr<Contents> contents);
  std::unique_ptr<Contents> contents_;
};

}  // namespace rfsmooth
