#include <utility>

#include <rfsmooth/cloud_file.h>

#include "pipeline/io/io.h"
#include "pipeline/io/mesh_file.h"

namespace rfsmooth {

namespace io = pipeline::io;

/// What a CloudFile hides: the cloud that the readers and writers of this folder work on.
struct CloudFile::Contents {
  io::Cloud cloud;

  static CloudFile file_of(io::Cloud cloud) {
    return CloudFile(std::make_unique<Contents>(Contents{std::move(cloud)}));
  }
};

namespace {

/// For what is over in no time and must not leave a cloud half changed.
Context to_the_end(Context context) {
  context.progress = nullptr;
  context.stop = nullptr;
  return context;
}

}  // namespace

CloudFile::CloudFile(std::unique_ptr<Contents> contents) : contents_(std::move(contents)) {}
CloudFile::CloudFile(const CloudFile& other) : contents_(std::make_unique<Contents>(*other.contents_)) {}
CloudFile& CloudFile::operator=(const CloudFile& other) {
  if (this != &other) contents_ = std::make_unique<Contents>(*other.contents_);
  return *this;
}
CloudFile::CloudFile(CloudFile&& other) noexcept = default;
CloudFile& CloudFile::operator=(CloudFile&& other) noexcept = default;
CloudFile::~CloudFile() = default;

Result<CloudFile> CloudFile::read(const std::filesystem::path& path, const ReadOptions& options,
                                  const Context& context) {
  return guarded([&] { return Contents::file_of(value_or_throw(io::read_cloud(path, options, context))); });
}

Result<CloudFile> CloudFile::parse(std::string_view bytes, const std::string& name,
                                   const ReadOptions& options, const Context& context) {
  return guarded(
      [&] { return Contents::file_of(value_or_throw(io::parse_cloud(bytes, name, options, context))); });
}

CloudFile CloudFile::of_points(const double* xyz, std::size_t n) {
  return Contents::file_of(io::make_cloud(xyz, n));
}

Result<Done> CloudFile::write(const std::filesystem::path& path, const WriteOptions& options,
                              const Context& context) const {
  return io::write_cloud(contents_->cloud, path, options, context);
}

Result<std::string> CloudFile::serialize(const WriteOptions& options, const Context& context) const {
  return io::serialize_cloud(contents_->cloud, options, context);
}

Format CloudFile::format() const {
  return contents_->cloud.format;
}
Encoding CloudFile::encoding() const {
  return contents_->cloud.encoding;
}
std::size_t CloudFile::size() const {
  return contents_->cloud.size();
}
std::array<std::size_t, 2> CloudFile::extent() const {
  return {contents_->cloud.width, contents_->cloud.height};
}

std::vector<double> CloudFile::positions(const Context& context) const {
  return io::positions(contents_->cloud, to_the_end(context));
}

void CloudFile::set_positions(const double* xyz, const Context& context) {
  io::set_positions(contents_->cloud, xyz, to_the_end(context));
}

std::vector<std::string> CloudFile::field_names() const {
  std::vector<std::string> names;
  for (const io::Field& field : contents_->cloud.points().fields) names.push_back(field.name);
  return names;
}

std::optional<std::vector<double>> CloudFile::field(std::string_view name, const Context& context) const {
  const auto which = io::find_plain_field(contents_->cloud, name);
  if (!which) return std::nullopt;
  return io::field_values(contents_->cloud, *which, to_the_end(context));
}

Result<Done> CloudFile::set_field(const std::string& name, const std::vector<double>& values,
                                  const Context& context) {
  return guarded([&] {
    io::set_field(contents_->cloud, name, io::Scalar::float32, values, to_the_end(context));
    return Done{};
  });
}

void CloudFile::select(const std::vector<std::size_t>& rows, const Context& context) {
  io::select_points(contents_->cloud, rows, to_the_end(context));
}

Result<std::vector<Face>> CloudFile::faces(const Context& context) const {
  return guarded([&] { return io::faces_of(contents_->cloud, context); });
}

void CloudFile::set_faces(const std::vector<Face>& faces) {
  io::set_faces(contents_->cloud, faces);
}

}  // namespace rfsmooth
