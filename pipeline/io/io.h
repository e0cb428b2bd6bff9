/// The front door of files: read and write clouds and meshes, PLY, PCD, XYZ, OFF and LAS, without losing
/// anything.
///
///     auto cloud = read_cloud("scan.ply", {}, context);             // the content tells the format
///     std::vector<double> xyz = positions(cloud.value());           // n x 3
///     ...                                                           // NaN rows stay where they are
///     set_positions(cloud.value(), xyz.data());                     // only what moved changes
///     write_cloud(cloud.value(), "out.ply", {}, context);           // by extension; complete or not at all
///
/// Errors: input_unreadable, with the line or byte, what was expected and what was found; cannot_write; usage
/// for a format that cannot carry what the cloud has. Memory: as CloudFile::read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <rfsmooth/result.h>

#include "base/fail.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

using rfsmooth::ReadOptions;
using rfsmooth::WriteOptions;

/// Reads a file. Pipes and devices ("/dev/stdin") are read to their end.
Result<Cloud> read_cloud(const std::filesystem::path& path, const ReadOptions& options,
                         const Context& context);

/// Reads a buffer, for example of standard input; error messages call it `name`.
Result<Cloud> parse_cloud(std::string_view bytes, const std::string& name, const ReadOptions& options,
                          const Context& context);

/// Writes a temporary file beside `path` and renames it. An existing file is refused without `force`. A
/// symbolic link is followed. A .csv has commas between its cells and names in its first line, a .tsv tabs; a
/// table that has cells already stays as it is. After an error or a cancel nothing has changed and no file is
/// left behind.
Result<Done> write_cloud(const Cloud& cloud, const std::filesystem::path& path, const WriteOptions& options,
                         const Context& context);

/// Writes to a buffer, for example for standard output.
Result<std::string> serialize_cloud(const Cloud& cloud, const WriteOptions& options, const Context& context);

/// Reports in advance what write_cloud would refuse about the path; creates nothing.
Result<Done> check_output(const std::filesystem::path& path, const WriteOptions& options);

/// The format that write_cloud writes to that path. \throw Failure (usage) for an extension of no format that
/// is written.
Format target_format(const Cloud& cloud, const std::filesystem::path& path, const WriteOptions& options);

/// Writes any bytes (a report, a picture) in the same way: complete or not at all.
Result<Done> write_bytes(std::string_view bytes, const std::filesystem::path& path, bool force,
                         const Context& context);

/// The format a path's extension stands for (.ply; .pcd; .xyz .txt .asc .csv .tsv .pts; .off; .las), if any.
std::optional<Format> format_of_extension(const std::filesystem::path& path);

/// What an XYZ file of that name gets between its cells, beside a line of names: commas a .csv, tabs a .tsv.
/// None: the rows stay as they are, since they have those already or the name does not say.
std::optional<Separators> new_cells(const Cloud& cloud, const std::filesystem::path& path);

/// The value of what was made of a file. \throw Failure with its error, which then begins with the file's
/// name.
template <class T>
T value_or_fail(Result<T> result, const std::string& file) {
  if (!result.ok()) fail(result.error().code, "{}: {}", file, result.error().message);
  return std::move(result).value();
}

/// What `work` returns. \throw Failure with its error, and the file's name in front unless it stands there.
template <class Work>
auto naming(const std::string& file, Work&& work) {
  auto done = guarded(std::forward<Work>(work));
  if (!done.ok() && done.error().message.rfind(file + ": ", 0) == 0) throw Failure(done.error());
  return value_or_fail(std::move(done), file);
}

/// The format of that name ("ply", "pcd", "xyz", "off", "las"), if any.
std::optional<Format> format_by_name(std::string_view name);
/// The encoding of that name, if any; "binary" is little-endian.
std::optional<Encoding> encoding_by_name(std::string_view name);

}  // namespace rfsmooth::pipeline::io
