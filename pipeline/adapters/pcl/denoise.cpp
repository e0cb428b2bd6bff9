#include <algorithm>
#include <cstring>

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/impl/instantiate.hpp>
#include <pcl/point_types.h>

#include <rfsmooth/normals.h>
#include <rfsmooth/pcl/denoise.h>
#include <rfsmooth/pcl/impl/denoise.hpp>

#include "pipeline/viewpoint.h"

namespace rfsmooth::pcl {

bool DenoiseSettings::seen_from_origin(const double* xyz, std::size_t width, std::size_t height) const {
  return pipeline::seen_from(Eigen::Vector3d::Zero(), xyz, width, height, context_);
}

bool DenoiseSettings::fail(const std::string& why) {
  status_ = why;
  // What PCL_ERROR does; the macro itself cannot be used inside a namespace called pcl.
  ::pcl::console::print(::pcl::console::L_ERROR, "[rfsmooth::pcl::Denoise] %s\n", why.c_str());
  return false;
}

void DenoiseSettings::setOptions(const DenoiseOptions& options) {
  options_ = options;
  mistake_.clear();
}

void DenoiseSettings::setFlow(const std::string& name) {
  const auto flow = rfsmooth::find_flow(name);
  mistake_ = flow.ok() ? "" : flow.error().message;
  if (flow.ok()) options_.flow.flow = flow.value();
}

AutomaticOptions* DenoiseSettings::automatic(const char* option) {
  auto* const options = std::get_if<AutomaticOptions>(&options_.flow.flow);
  if (options == nullptr) mistake_ = std::string(option) + " has no meaning for the flow '" + getFlow() + "'";
  return options;
}

void DenoiseSettings::setStrength(double strength) {
  if (auto* const options = automatic("strength")) options->strength = strength;
}

void DenoiseSettings::setNoise(double sigma) {
  if (auto* const options = automatic("noise")) options->noise = Length{sigma, false};
}

bool DenoiseSettings::run(double* xyz, std::size_t n) {
  status_.clear();
  report_ = {};
  if (!mistake_.empty()) return fail(mistake_);
  try {
    Result<DenoiseReport> result = rfsmooth::denoise(xyz, n, options_, context_);
    if (!result.ok()) return fail(result.error().message);
    report_ = std::move(result).value();
    return true;
  } catch (const std::exception& exception) {
    return fail(exception.what());
  }
}

::pcl::Indices DenoiseSettings::removed(const ::pcl::Indices& indices) const {
  ::pcl::Indices gone;
  if (options_.outliers != Outliers::remove) return gone;
  for (std::size_t row = 0; row < report_.outlier.size(); ++row)
    if (report_.outlier[row] != 0) gone.push_back(indices[row]);
  std::sort(gone.begin(), gone.end());
  gone.erase(std::unique(gone.begin(), gone.end()), gone.end());
  return gone;
}

bool DenoiseSettings::run_normals(const double* xyz, std::size_t n,
                                  const std::optional<Eigen::Vector3d>& viewpoint, double* normals) {
  try {
    NormalsOptions options;
    options.viewpoint = viewpoint;
    const auto result = rfsmooth::estimate_normals(xyz, n, options, context_, normals);
    return result.ok() || fail(result.error().message);
  } catch (const std::exception& exception) {
    return fail(exception.what());
  }
}

namespace {

/// Where x, y, z lie in a PCLPointCloud2: reads and writes them in their own type.
struct Coordinates {
  std::size_t offset[3] = {0, 0, 0};
  std::uint8_t type = 0;  ///< one type for the three, else 0

  explicit Coordinates(const ::pcl::PCLPointCloud2& cloud) {
    static const char* const kNames[3] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const auto* field = find(cloud, kNames[axis]);
      const bool usable = field != nullptr && (field->datatype == ::pcl::PCLPointField::FLOAT32 ||
                                               field->datatype == ::pcl::PCLPointField::FLOAT64);
      const std::size_t size = usable && field->datatype == ::pcl::PCLPointField::FLOAT64 ? 8 : 4;
      if (!usable || field->offset + size > cloud.point_step || (axis > 0 && field->datatype != type)) {
        type = 0;
        return;
      }
      type = field->datatype;
      offset[axis] = field->offset;
    }
  }

  double get(const std::uint8_t* row, int axis) const {
    return type == ::pcl::PCLPointField::FLOAT64 ? load<double>(row + offset[axis])
                                                 : double(load<float>(row + offset[axis]));
  }
  void set(std::uint8_t* row, int axis, double value) const {
    if (type == ::pcl::PCLPointField::FLOAT64)
      store(row + offset[axis], value);
    else
      store(row + offset[axis], float(value));
  }

 private:
  static const ::pcl::PCLPointField* find(const ::pcl::PCLPointCloud2& cloud, const char* name) {
    for (const auto& field : cloud.fields)
      if (field.name == name && field.count <= 1) return &field;
    return nullptr;
  }
  template <typename T>
  static T load(const std::uint8_t* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
  }
  template <typename T>
  static void store(std::uint8_t* to, T value) {
    std::memcpy(to, &value, sizeof(T));
  }
};

}  // namespace

void Denoise<::pcl::PCLPointCloud2>::filter(PCLPointCloud2& output) {
  if (input_) {
    // PCL's own filter() clears an output that is also the input before it is read.
    if (input_.get() == &output) input_.reset(new PCLPointCloud2(output));
    ::pcl::Filter<PCLPointCloud2>::filter(output);
    return;
  }
  fail("no input cloud: call setInputCloud first");
  output = PCLPointCloud2();
}

void Denoise<::pcl::PCLPointCloud2>::applyFilter(PCLPointCloud2& output) {
  const PCLPointCloud2& input = *input_;
  const std::size_t size = std::size_t(input.width) * input.height;
  const auto give_up = [&] {
    output = PCLPointCloud2();
    output.header = input.header;
  };
  const Coordinates coordinates(input);
  if (coordinates.type == 0) {
    fail("the cloud needs fields x, y and z inside its point_step, all FLOAT32 or all FLOAT64");
    return give_up();
  }
  if (input.is_bigendian != 0 || input.data.size() < size * input.point_step) {
    fail("the cloud's data does not match its width, height and point_step");
    return give_up();
  }
  // Rows may be padded (organised clouds from cameras): row_step, where it is given, separates them.
  const std::size_t padded = input.row_step > input.width * input.point_step ? input.row_step : 0;
  const auto offset_of = [&](std::size_t i) {
    return padded != 0 ? (i / input.width) * padded + (i % input.width) * input.point_step
                       : i * input.point_step;
  };
  if (padded != 0 && input.data.size() < padded * input.height) {
    fail("the cloud's data does not match its row_step and height");
    return give_up();
  }
  std::vector<double> xyz;
  const auto at = [&](std::size_t i, double* to) {
    for (int axis = 0; axis < 3; ++axis) to[axis] = coordinates.get(&input.data[offset_of(i)], axis);
  };
  removed_indices_->clear();
  if (!detail::gather(*indices_, size, at, xyz)) {
    fail("an index is outside the cloud");
    return give_up();
  }
  const std::vector<double> before = xyz;
  if (!run(xyz.data(), indices_->size())) return give_up();
  output = input;
  for (std::size_t row = 0; row < indices_->size(); ++row)
    for (int axis = 0; axis < 3; ++axis)
      if (const double value = xyz[3 * row + axis]; value != before[3 * row + axis] && std::isfinite(value))
        coordinates.set(&output.data[offset_of(std::size_t((*indices_)[row]))], axis, value);

  const ::pcl::Indices gone = removed(*indices_);
  if (extract_removed_indices_) *removed_indices_ = gone;
  if (gone.empty()) return;
  if (keep_organized_) {
    for (const auto i : gone)
      for (int axis = 0; axis < 3; ++axis)
        coordinates.set(&output.data[offset_of(std::size_t(i))], axis, user_filter_value_);
    if (!std::isfinite(user_filter_value_)) output.is_dense = 0;
    return;
  }
  // Closes up: rows in order, without the padding of the organised cloud.
  std::size_t kept = 0, next = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (next < gone.size() && std::size_t(gone[next]) == i) {
      ++next;
      continue;
    }
    std::memmove(&output.data[kept++ * output.point_step], &output.data[offset_of(i)], output.point_step);
  }
  output.width = std::uint32_t(kept);
  output.height = 1;
  output.row_step = output.width * output.point_step;
  output.data.resize(output.row_step);
}

}  // namespace rfsmooth::pcl

PCL_INSTANTIATE(Denoise, PCL_XYZ_POINT_TYPES)
