#include "pipeline/cli/files/cloud_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/files/memory.h"
#include "pipeline/cli/own_files.h"
#include "pipeline/io/convert/capacity.h"
#include "pipeline/io/convert/convert.h"
#include "pipeline/io/formats/las/las.h"
#include "pipeline/io/json_file.h"

namespace rfsmooth::cli {

namespace io = pipeline::io;
using nlohmann::ordered_json;

namespace {

io::WriteOptions write_options(const FileOptions& options) {
  io::WriteOptions out;
  if (options.format) out.format = io::format_by_name(*options.format);
  if (options.encoding) out.encoding = io::encoding_by_name(*options.encoding);
  out.force = options.force;
  out.drop_unsupported = options.drop_unsupported;
  return out;
}

/// One spelling for all names of a file, which need not exist.
std::string place_of(const std::string& path) {
  if (path == "-") return path;
  std::error_code unknown;
  const auto place = std::filesystem::weakly_canonical(std::filesystem::absolute(path, unknown), unknown);
  return unknown ? path : place.string();
}

ordered_json describe_las(const io::LasSummary& las) {
  auto records = ordered_json::array();
  for (const io::las::Record& r : las.records)
    records.push_back({{"user", r.user}, {"id", r.id}, {"bytes", r.size}, {"extended", r.extended}});
  return {{"version", fmt::format("1.{}", las.minor)},
          {"point_format", las.point_format},
          {"scale", las.scale},
          {"offset", las.offset},
          {"records", records}};
}

}  // namespace

void check_target(const std::string& output, const FileOptions& options) {
  if (output != "-") value_or_throw(io::check_output(output, write_options(options)));
}

void check_target(const Job& job, const FileOptions& options) {
  if (!in_folder_to_come(job, job.output)) return check_target(job.output, options);
  io::target_format(io::Cloud{}, job.output, write_options(options));
}

bool in_folder_to_come(const Job& job, const std::string& path) {
  std::error_code unknown;
  if (job.folder.empty() || std::filesystem::is_directory(job.folder, unknown)) return false;
  const auto folder_of = [](const std::string& file) {
    return std::filesystem::path(place_of(file)).parent_path();
  };
  return folder_of(path) == folder_of(job.output);
}

std::vector<Job> plan_cloud_jobs(const std::vector<std::string>& arguments, const FileOptions& options,
                                 std::optional<io::Format> makes) {
  const auto named = options.format ? io::format_by_name(*options.format) : std::nullopt;
  return plan_jobs(arguments, options.output, named ? named : makes);
}

void need_different_outputs(const std::vector<std::pair<std::string, std::string>>& outputs) {
  std::map<std::string, std::string> taken;
  for (const auto& [name, path] : outputs) {
    std::error_code unknown;
    if (std::filesystem::is_character_file(path, unknown)) continue;
    const auto [it, is_new] = taken.emplace(place_of(path), name);
    if (is_new) continue;
    fail(ErrorCode::usage, "{} and {} are the same file: {}", it->second, name,
         path == "-" ? "standard output (-)" : path);
  }
}

std::string name_of_input(const std::string& input) {
  return input == "-" ? "standard input" : input;
}

void need_one_standard_input(const std::vector<std::string>& inputs) {
  if (std::count(inputs.begin(), inputs.end(), "-") > 1)
    fail(ErrorCode::usage, "standard input (-) is given twice, and can be read once");
}

io::Cloud load_cloud(const std::string& input, const Context& context) {
  context.report("read", 0);
  const std::string standard_input = "/dev/stdin", path = input == "-" ? standard_input : input;
  std::error_code unknown;
  // The file's own size is the least that reading it takes.
  if (const auto bytes = std::filesystem::file_size(path, unknown); !unknown)
    io::naming(name_of_input(input), [&] {
      need_memory(bytes);
      return Done{};
    });
  auto cloud = io::read_cloud(path, {}, context);
  if (input != "-" || cloud.ok()) return value_or_throw(std::move(cloud));
  Error error = cloud.error();
  if (error.message.rfind(standard_input, 0) == 0)
    error.message.replace(0, standard_input.size(), name_of_input(input));
  throw Failure(std::move(error));
}

std::vector<std::string> store_cloud(const io::Cloud& cloud, const std::string& output,
                                     const FileOptions& options, const Context& context) {
  context.report("write", 0);
  std::vector<std::string> dropped;
  if (options.drop_unsupported) {
    const Target target = target_of(cloud, output, options);
    dropped = io::what_is_lost(cloud, target.format, target.encoding, context);
  }
  if (output == "-") {
    const std::string bytes = value_or_throw(io::serialize_cloud(cloud, write_options(options), context));
    if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size() || std::fflush(stdout) != 0)
      fail(ErrorCode::cannot_write, "standard output: cannot write");
  } else {
    value_or_throw(io::write_cloud(cloud, output, write_options(options), context));
    mark_as_own(output);
  }
  if (context.progress) context.progress("write", 1);  // too late to cancel: the file is there
  return dropped;
}

Target target_of(const io::Cloud& cloud, const std::string& output, const FileOptions& options,
                 std::optional<io::Format> makes) {
  io::Format format = output_format(cloud, output, options);
  if (makes && !options.format && !io::format_of_extension(output)) format = *makes;
  return {format, io::target_encoding(cloud, format, write_options(options).encoding)};
}

io::Format output_format(const io::Cloud& cloud, const std::string& output, const FileOptions& options) {
  return io::target_format(cloud, output, write_options(options));
}

void warn_if_coarse(const io::Cloud& cloud, const std::vector<double>& xyz, double spacing,
                    const std::string& name, Console& console) {
  float largest = 0;
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    if (!std::isfinite(xyz[i]) || cloud.points().fields[cloud.xyz[i % 3]].type != io::Scalar::float32)
      continue;
    const auto value = float(xyz[i]);
    if (double(value) != xyz[i]) return;  // a text with more digits
    largest = std::max(largest, std::abs(value));
  }
  const double step =
      double(std::nextafter(largest, std::numeric_limits<float>::infinity())) - double(largest);
  const double rounding = step / std::sqrt(12.0);  // standard deviation of what is lost
  if (spacing > 0 && largest > 0 && rounding > spacing / 20)
    console.warn(
        fmt::format("{}: coordinates of {:.3g} have steps of {:.2g} in float32, at a spacing of {:.2g}: "
                    "that noise was made when the file was written; write it anew with double "
                    "coordinates, or shifted near the origin",
                    name, largest, step, spacing));
}

ordered_json describe(const io::Cloud& cloud) {
  ordered_json json = {{"format", io::name_of(cloud.format)},
                       {"encoding", io::name_of(cloud.encoding)},
                       {"points", cloud.size()},
                       {"organised", cloud.organised()}};
  if (cloud.organised()) {
    json["width"] = cloud.width;
    json["height"] = cloud.height;
  }
  auto fields = ordered_json::array();
  for (const io::Field& field : cloud.points().fields) {
    ordered_json entry = {{"name", field.name}, {"type", io::name_of(field.type)}};
    if (field.count != 1) entry["count"] = field.count;
    if (field.is_list()) entry["list"] = true;
    if (field.is_scaled()) {
      entry["scale"] = field.scale;
      entry["offset"] = field.offset;
    }
    fields.push_back(entry);
  }
  json["fields"] = fields;
  auto others = ordered_json::array();
  for (std::size_t e = 0; e < cloud.elements.size(); ++e)
    if (e != cloud.vertex)
      others.push_back({{"name", cloud.elements[e].name}, {"count", cloud.elements[e].count}});
  if (!others.empty()) json["elements"] = others;
  if (cloud.format == io::Format::las) json["las"] = describe_las(io::las_summary(cloud));
  return json;
}

ordered_json bytes_options(const FileOptions& options) {
  ordered_json json;
  json["format"] = io::or_null(options.format);
  json["encoding"] = io::or_null(options.encoding);
  json["drop-unsupported"] = options.drop_unsupported;
  return json;
}

}  // namespace rfsmooth::cli
