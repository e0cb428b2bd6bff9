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

/// Where the rows of a PCLPointCloud2 begin. Rows may be padded (organised clouds from cameras): row_step,
/// where it is given, separates them.
class Rows {
 public:
  explicit Rows(const ::pcl::PCLPointCloud2& cloud)
      : width_(cloud.width),
        step_(cloud.point_step),
        padded_(cloud.row_step > cloud.width * cloud.point_step ? cloud.row_step : 0) {}

  std::size_t operator[](std::size_t i) const {
    return padded_ != 0 ? (i / width_) * padded_ + (i % width_) * step_ : i * step_;
  }
  bool are_padded() const { return padded_ != 0; }

 private:
  std::size_t width_, step_, padded_;
};

/// Why the cloud cannot be smoothed; null if it can.
const char* what_is_wrong_with(const ::pcl::PCLPointCloud2& cloud, const Coordinates& coordinates) {
  const std::size_t size = std::size_t(cloud.width) * cloud.height;
  if (coordinates.type == 0)
    return "the cloud needs fields x, y and z inside its point_step, all FLOAT32 or all FLOAT64";
  if (cloud.is_bigendian != 0 || cloud.data.size() < size * cloud.point_step)
    return "the cloud's data does not match its width, height and point_step";
  if (Rows(cloud).are_padded() && cloud.data.size() < std::size_t(cloud.row_step) * cloud.height)
    return "the cloud's data does not match its row_step and height";
  return nullptr;
}

/// Takes the rows `gone` (ascending) out: the others in order, without the padding of an organised cloud.
void close_up(::pcl::PCLPointCloud2& cloud, const ::pcl::Indices& gone) {
  const Rows rows(cloud);
  const std::size_t size = std::size_t(cloud.width) * cloud.height;
  std::size_t kept = 0, next = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (next < gone.size() && std::size_t(gone[next]) == i)
      ++next;
    else
      std::memmove(&cloud.data[kept++ * cloud.point_step], &cloud.data[rows[i]], cloud.point_step);
  }
  cloud.width = std::uint32_t(kept);
  cloud.height = 1;
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.resize(cloud.row_step);
}

}  // namespace

void Denoise<::pcl::PCLPointCloud2>::filter(PCLPointCloud2& output) {
  if (input_) {
    // PCL's own filter() clears an output that is also the input before it is read.
    const auto given = input_;
    if (given.get() == &output) input_.reset(new PCLPointCloud2(output));
    ::pcl::Filter<PCLPointCloud2>::filter(output);
    input_ = given;
    return;
  }
  fail("no input cloud: call setInputCloud first");
  output = PCLPointCloud2();
}

void Denoise<::pcl::PCLPointCloud2>::applyFilter(PCLPointCloud2& output) {
  const PCLPointCloud2& input = *input_;
  const auto give_up = [&](const char* why) {
    if (why != nullptr) fail(why);
    output = PCLPointCloud2();
    output.header = input.header;
  };
  const Coordinates coordinates(input);
  if (const char* const wrong = what_is_wrong_with(input, coordinates)) return give_up(wrong);
  const Rows rows(input);
  std::vector<double> xyz;
  const auto at = [&](std::size_t i, double* to) {
    for (int axis = 0; axis < 3; ++axis) to[axis] = coordinates.get(&input.data[rows[i]], axis);
  };
  removed_indices_->clear();
  if (!detail::gather(*indices_, std::size_t(input.width) * input.height, at, xyz))
    return give_up("an index is outside the cloud");
  const std::vector<double> before = xyz;
  if (!run(xyz.data(), indices_->size())) return give_up(nullptr);
  output = input;
  for (std::size_t row = 0; row < indices_->size(); ++row)
    for (int axis = 0; axis < 3; ++axis)
      if (const double value = xyz[3 * row + axis]; value != before[3 * row + axis] && std::isfinite(value))
        coordinates.set(&output.data[rows[std::size_t((*indices_)[row])]], axis, value);

  const ::pcl::Indices gone = removed(*indices_);
  if (extract_removed_indices_) *removed_indices_ = gone;
  if (gone.empty()) return;
  if (!keep_organized_) return close_up(output, gone);
  for (const auto i : gone)
    for (int axis = 0; axis < 3; ++axis)
      coordinates.set(&output.data[rows[std::size_t(i)]], axis, user_filter_value_);
  if (!std::isfinite(user_filter_value_)) output.is_dense = 0;
}

}  // namespace rfsmooth::pcl

PCL_INSTANTIATE(Denoise, PCL_XYZ_POINT_TYPES)
