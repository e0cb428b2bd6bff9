#include "clouds/scanner/scan_files.h"

#include <cmath>

namespace rfsmooth::clouds {

namespace io = pipeline::io;

namespace {

std::vector<Return> kept(const std::vector<Return>& returns, bool organised) {
  if (organised) return returns;
  std::vector<Return> hits;
  for (const Return& r : returns)
    if (r.kind != ReturnKind::none) hits.push_back(r);
  return hits;
}

io::Cloud with_positions(const std::vector<Return>& returns, const ScannerOptions& options, bool organised,
                         const Eigen::Vector3d Return::*member) {
  std::vector<double> xyz;
  xyz.reserve(3 * returns.size());
  for (const Return& r : returns)
    for (int axis = 0; axis < 3; ++axis)
      xyz.push_back(r.kind == ReturnKind::none ? std::nan("") : (r.*member)[axis]);
  io::Cloud cloud = io::make_cloud(xyz.data(), returns.size(), io::Scalar::float32);
  if (organised) {
    cloud.width = std::size_t(options.columns);
    cloud.height = std::size_t(options.rows) * std::size_t(options.views);
  }
  return cloud;
}

template <class Value>
void add_field(io::Cloud& cloud, const std::string& name, io::Scalar type, const std::vector<Return>& returns,
               Value&& value) {
  std::vector<double> values;
  values.reserve(returns.size());
  for (const Return& r : returns) values.push_back(value(r));
  io::set_field(cloud, name, type, values);
}

}  // namespace

io::Cloud measured_cloud(const std::vector<Return>& returns, const ScannerOptions& options, bool organised) {
  const std::vector<Return> rows = kept(returns, organised);
  io::Cloud cloud = with_positions(rows, options, organised, &Return::measured);
  add_field(cloud, "intensity", io::Scalar::float32, rows, [](const Return& r) { return r.intensity; });
  if (options.views > 1)
    add_field(cloud, "view", io::Scalar::uint8, rows, [](const Return& r) { return r.view; });
  return cloud;
}

io::Cloud true_cloud(const std::vector<Return>& returns, const ScannerOptions& options, bool organised) {
  const std::vector<Return> rows = kept(returns, organised);
  io::Cloud cloud = with_positions(rows, options, organised, &Return::truth);
  add_field(cloud, "kind", io::Scalar::uint8, rows, [](const Return& r) { return double(r.kind); });
  return cloud;
}

io::Cloud plain_cloud(const Positions& points) {
  return io::make_cloud(points.front().data(), points.size(), io::Scalar::float32);
}

}  // namespace rfsmooth::clouds
