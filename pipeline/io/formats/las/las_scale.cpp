#include "pipeline/io/formats/las/las_scale.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/parallel.h"
#include "pipeline/io/formats/las/las_header.h"

namespace rfsmooth::pipeline::io {
namespace las {
namespace {

// int32 holds all powers of ten up to this one.
constexpr int kMostPowers = 9;
constexpr double kMostSteps = std::numeric_limits<std::int32_t>::max();

struct Span {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

// Old and new coordinates of an axis in whole old steps.
Span span_in_steps(const Table& points, std::size_t axis, const double* xyz, const Context& context) {
  const Field& field = points.fields[axis];
  return reduce_blocks(
      context, points.count, Span{},
      [&](std::size_t begin, std::size_t end) {
        Span s;
        for (std::size_t i = begin; i < end; ++i) {
          const double old = las::number<std::int32_t>(points.row(i), 4 * axis);
          const double now = (xyz[3 * i + axis] - field.offset) / field.scale;
          s.low = std::min(s.low, std::isfinite(now) ? std::min(old, now) : old);
          s.high = std::max(s.high, std::isfinite(now) ? std::max(old, now) : old);
        }
        return s;
      },
      [](const Span& a, const Span& b) {
        return Span{std::min(a.low, b.low), std::max(a.high, b.high)};
      });
}

// The finest change of at most `power` whose integers fit. An offset that must move does so by a round number
// of steps.
ScaleChange finest(const Span& span, int power) {
  const auto fits = [&](double shift, double factor) {
    return (span.high - shift) * factor < kMostSteps && (span.low - shift) * factor > -kMostSteps;
  };
  for (; power > 0; --power) {
    const double factor = std::pow(10.0, power), unit = std::pow(10.0, std::max(0, kMostPowers - 1 - power));
    const double shift = std::nearbyint((span.low + span.high) / 2 / unit) * unit;
    if (fits(0, factor)) return {power, 0};
    if (fits(shift, factor)) return {power, shift};
  }
  return {};
}

// The change of an axis to steps of at most `step`.
ScaleChange finer_scale(const Field& field, double step, const Span& span) {
  if (!(step > 0) || std::abs(field.scale) <= step || !(span.low <= span.high)) return {};
  // Rounded up, but for what division adds to a power of ten.
  const int power = int(std::ceil(std::log10(std::abs(field.scale) / step) - 1e-9));
  return finest(span, std::clamp(power, 0, kMostPowers));
}

}  // namespace
}  // namespace las

double RefinedScale::coarsest() const {
  return std::max({std::abs(after[0]), std::abs(after[1]), std::abs(after[2])});
}

double times_power_of_ten(double value, int power) {
  char shortest[64];
  const auto written =
      std::to_chars(shortest, shortest + sizeof shortest, value, std::chars_format::scientific);
  const std::string_view digits(shortest, std::size_t(written.ptr - shortest));
  const std::size_t e = digits.find('e');
  int exponent = 0;
  const char* first = digits.data() + e + (digits[e + 1] == '+' ? 2 : 1);
  std::from_chars(first, digits.data() + digits.size(), exponent);
  const std::string moved = fmt::format("{}e{}", digits.substr(0, e), exponent + power);
  double out = value;
  std::from_chars(moved.data(), moved.data() + moved.size(), out);
  return out;
}

double decimal_scale(double extent, double steps) {
  if (!(extent > 0)) return 1e-3;
  const int power = int(std::ceil(std::log10(extent / steps)));
  return times_power_of_ten(1.0, power);
}

double with_rounding(double left, double step) {
  return std::hypot(left, step / std::sqrt(12.0));
}

double finest_needed(double noise, std::optional<double> left) {
  return (left && *left < noise ? *left : noise / 10) / 2;
}

double finest_asked(bool kept, double noise, std::optional<double> left) {
  return kept ? std::numeric_limits<double>::infinity() : finest_needed(noise, left);
}

ScaleChange refine_axis(Field& field, std::size_t axis, double step, double low, double high,
                        RefinedScale& done) {
  const ScaleChange change = las::finer_scale(field, step, {low, high});
  done.before[axis] = field.scale;
  done.shift[axis] = change.shift;
  if (change.power > 0) {
    const double scale = times_power_of_ten(field.scale, -change.power);  // first: memory may run out
    field.offset += change.shift * field.scale;
    field.scale = scale;
  }
  done.after[axis] = field.scale;
  return change;
}

void change_integer(char* at, const ScaleChange& change) {
  constexpr std::array<std::int64_t, las::kMostPowers + 1> kFactor = {
      1, 10, 100, 1'000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};
  std::int32_t value;
  std::memcpy(&value, at, sizeof value);
  value = std::int32_t((value - std::int64_t(change.shift)) * kFactor[std::size_t(change.power)]);
  std::memcpy(at, &value, sizeof value);
}

RefinedScale refine_scale(Cloud& las, double step, const double* xyz, const Context& context) {
  using namespace las;  // NOLINT(google-build-using-namespace)
  RefinedScale done;
  Table& points = las.points();
  const std::size_t size = points.row_size();
  Context to_the_end = context;  // in place: all rows or none
  to_the_end.stop = nullptr;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Field& field = points.fields[axis];
    const Span span =
        step > 0 && std::abs(field.scale) > step ? span_in_steps(points, axis, xyz, context) : Span{};
    context.check_stop();
    const ScaleChange change = refine_axis(field, axis, step, span.low, span.high, done);
    if (change.power > 0)
      for_each_index(to_the_end, points.count, [&](std::size_t i) {
        change_integer(points.data.data() + i * size + 4 * axis, change);
      });
  }
  return done;
}

}  // namespace rfsmooth::pipeline::io
