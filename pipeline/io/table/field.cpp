#include "pipeline/io/table/field.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace rfsmooth::pipeline::io {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "rows are kept little-endian, in the machine's order");

template <class T>
T nearest_of(double value) {
  if constexpr (std::numeric_limits<T>::is_integer) {
    const double r = std::nearbyint(value);
    // 2^digits is exact in double where max() of a 64-bit type is not.
    const double above = std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (!(r == r)) return 0;
    if (r >= above) return std::numeric_limits<T>::max();
    if (r < double(std::numeric_limits<T>::min())) return std::numeric_limits<T>::min();
    return T(r);
  } else {
    static_assert(std::numeric_limits<T>::is_iec559);  // beyond the largest float: infinity
    return T(value);
  }
}

}  // namespace

std::string one_word(std::string name) {
  const auto is_blank = [](char c) { return static_cast<unsigned char>(c) <= ' ' || c == '\x7f'; };
  std::replace_if(name.begin(), name.end(), is_blank, '_');
  return name;
}

std::size_t size_of(Scalar type) {
  return with_type(type, [](auto value) { return sizeof value; });
}

bool is_float(Scalar type) {
  return type == Scalar::float32 || type == Scalar::float64;
}

std::string_view name_of(Scalar type) {
  constexpr std::array<std::string_view, kScalars.size()> kNames = {
      "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"};
  return kNames.at(std::size_t(type));
}

double load(Scalar type, const char* p) {
  return with_type(type, [p](auto stored) {
    std::memcpy(&stored, p, sizeof stored);
    return double(stored);
  });
}

void store(Scalar type, char* p, double value) {
  with_type(type, [p, value](auto stored) {
    stored = nearest_of<decltype(stored)>(value);
    std::memcpy(p, &stored, sizeof stored);
  });
}

double load(const Field& field, const char* p) {
  const double stored = load(field.type, p);
  return field.is_scaled() ? stored * field.scale + field.offset : stored;
}

void store(const Field& field, char* p, double value) {
  if (!field.is_scaled()) return store(field.type, p, value);
  if (std::isfinite(value)) store(field.type, p, (value - field.offset) / field.scale);
}

bool can_hold(const Field& field, double value) {
  if (!field.is_scaled()) return true;
  const double wanted = std::nearbyint((value - field.offset) / field.scale);
  char stored[8];
  store(field.type, stored, wanted);
  return std::isfinite(value) && (is_float(field.type) || load(field.type, stored) == wanted);
}

}  // namespace rfsmooth::pipeline::io
