#include "pipeline/io/io.h"

#include "base/fail.h"
#include "pipeline/io/convert/capacity.h"
#include "pipeline/io/convert/convert.h"
#include "pipeline/io/detect.h"
#include "pipeline/io/formats/las/las.h"
#include "pipeline/io/formats/off.h"
#include "pipeline/io/formats/pcd.h"
#include "pipeline/io/formats/ply.h"
#include "pipeline/io/formats/xyz.h"
#include "pipeline/io/other_formats.h"
#include "pipeline/io/stream/atomic_file.h"

namespace rfsmooth::pipeline::io {
namespace {

Cloud read(const Source& source, const ReadOptions& options, const Context& context) {
  switch (options.format ? *options.format : detect_format(source, context)) {
    case Format::ply:
      return read_ply(source, context);
    case Format::pcd:
      return read_pcd(source, context);
    case Format::xyz:
      return read_xyz(source, context);
    case Format::off:
      return read_off(source, context);
    case Format::las:
      return read_las(source, context);
  }
  throw std::invalid_argument("read: not a Format");
}

void write_as_is(const Cloud& cloud, Encoding encoding, Sink& sink, const Context& context) {
  switch (cloud.format) {
    case Format::ply:
      return write_ply(cloud, encoding, sink, context);
    case Format::pcd:
      return write_pcd(cloud, encoding, sink, context);
    case Format::xyz:
      return write_xyz(cloud, sink, context);
    case Format::off:
      return write_off(cloud, sink, context);
    case Format::las:
      return write_las(cloud, sink, context);
  }
}

/// `cells`: what an XYZ file gets between them; none: as it comes.
void write(const Cloud& cloud, Format format, std::optional<Separators> cells, const WriteOptions& options,
           Sink& sink, const Context& context) {
  const Encoding encoding = target_encoding(cloud, format, options.encoding);
  if (!options.drop_unsupported)
    need_no_losses(what_is_lost(cloud, format, encoding, context), format, encoding);
  if (format == Format::xyz && cells) {
    const Cloud table =
        as_cells(cloud.format == format ? cloud : convert(cloud, format, context), *cells, context);
    return write_as_is(table, encoding, sink, context);
  }
  if (is_writable_as_is(cloud, format)) return write_as_is(cloud, encoding, sink, context);
  write_as_is(convert(cloud, format, context), encoding, sink, context);
}

}  // namespace

Result<Cloud> read_cloud(const std::filesystem::path& path, const ReadOptions& options,
                         const Context& context) {
  return guarded([&] { return read(Source(path, context), options, context); });
}

Result<Cloud> parse_cloud(std::string_view bytes, const std::string& name, const ReadOptions& options,
                          const Context& context) {
  return guarded([&] { return read(Source(bytes, name), options, context); });
}

Result<Done> write_cloud(const Cloud& cloud, const std::filesystem::path& path, const WriteOptions& options,
                         const Context& context) {
  return guarded([&] {
    const Format format = target_format(cloud, path, options);
    AtomicFile file(path, options.force, context);
    write(cloud, format, new_cells(cloud, path), options, file, context);
    file.commit(options.sync);
    return Done{};
  });
}

Result<std::string> serialize_cloud(const Cloud& cloud, const WriteOptions& options, const Context& context) {
  return guarded([&] {
    BufferSink sink;
    write(cloud, options.format.value_or(cloud.format), std::nullopt, options, sink, context);
    return std::move(sink.buffer);
  });
}

Format target_format(const Cloud& cloud, const std::filesystem::path& path, const WriteOptions& options) {
  if (options.format) return *options.format;
  if (const auto format = format_of_extension(path)) return *format;
  if (!path.has_extension()) return cloud.format;
  if (const OtherFormat* other = other_format_of_extension(path))
    fail(ErrorCode::usage, "{}: {} is not written; {}", path.string(), other->name, other->instead);
  fail(ErrorCode::usage,
       "{}: the extension '{}' stands for no format we write (ply, pcd, xyz, off, las); choose one with "
       "`format`",
       path.string(), path.extension().string());
}

Result<Done> check_output(const std::filesystem::path& path, const WriteOptions& options) {
  return guarded([&] {
    target_format(Cloud{}, path, options);
    check_target(path, options.force);
    return Done{};
  });
}

Result<Done> write_bytes(std::string_view bytes, const std::filesystem::path& path, bool force,
                         const Context& context) {
  return guarded([&] {
    AtomicFile file(path, force, context);
    file.write(bytes);
    file.commit(true);
    return Done{};
  });
}

std::optional<Format> format_of_extension(const std::filesystem::path& path) {
  const std::string e = extension_of(path);
  if (e == ".ply") return Format::ply;
  if (e == ".pcd") return Format::pcd;
  if (e == ".off") return Format::off;
  if (e == ".las") return Format::las;
  if (e == ".xyz" || e == ".txt" || e == ".asc" || e == ".csv" || e == ".tsv" || e == ".pts")
    return Format::xyz;
  return std::nullopt;
}

std::optional<Separators> new_cells(const Cloud& cloud, const std::filesystem::path& path) {
  const std::string e = extension_of(path);
  if (e != ".csv" && e != ".tsv") return std::nullopt;
  const Separators wanted = e == ".csv" ? Separators::comma : Separators::tab,
                   own = cloud.points().separators;
  // A .csv may have semicolons: programs write them where commas are decimal ones.
  const bool has = own == wanted || (wanted == Separators::comma && own == Separators::semicolon);
  return cloud.format == Format::xyz && has ? std::nullopt : std::optional(wanted);
}

std::optional<Format> format_by_name(std::string_view name) {
  for (const Format f : {Format::ply, Format::pcd, Format::xyz, Format::off, Format::las})
    if (name_of(f) == name) return f;
  return std::nullopt;
}

std::optional<Encoding> encoding_by_name(std::string_view name) {
  if (name == "binary") return Encoding::binary_little_endian;
  for (const Encoding e : {Encoding::ascii, Encoding::binary_little_endian, Encoding::binary_big_endian,
                           Encoding::binary_compressed})
    if (name_of(e) == name) return e;
  return std::nullopt;
}

}  // namespace rfsmooth::pipeline::io
