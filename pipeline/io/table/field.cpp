#include "pipeline/io/table/field.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace rfsmooth::pipeline::io {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "rows are kept little-endian, in the machine's order");

template <class T>
double load_as(const char* p) {
  T v;
  std::memcpy(&v, p, sizeof v);
  return double(v);
}

template <class T>
void store_as(char* p, double value) {
  T v;
  if constexpr (std::numeric_limits<T>::is_integer) {
    const double r = std::nearbyint(value);
    // 2^digits is exact in double where max() of a 64-bit type is not.
    const double above = std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (!(r == r)) {
      v = 0;
    } else if (r >= above) {
      v = std::numeric_limits<T>::max();
    } else if (r < double(std::numeric_limits<T>::min())) {
      v = std::numeric_limits<T>::min();
    } else {
      v = T(r);
    }
  } else {
    static_assert(std::numeric_limits<T>::is_iec559);  // beyond the largest float: infinity
    v = T(value);
  }
  std::memcpy(p, &v, sizeof v);
}

}  // namespace

std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::int8:
    case Scalar::uint8:
      return 1;
    case Scalar::int16:
    case Scalar::uint16:
      return 2;
    case Scalar::int32:
    case Scalar::uint32:
    case Scalar::float32:
      return 4;
    case Scalar::int64:
    case Scalar::uint64:
    case Scalar::float64:
      return 8;
  }
  throw std::invalid_argument("size_of: not a Scalar");
}

bool is_float(Scalar type) {
  return type == Scalar::float32 || type == Scalar::float64;
}

std::string_view name_of(Scalar type) {
  switch (type) {
    case Scalar::int8:
      return "int8";
    case Scalar::uint8:
      return "uint8";
    case Scalar::int16:
      return "int16";
    case Scalar::uint16:
      return "uint16";
    case Scalar::int32:
      return "int32";
    case Scalar::uint32:
      return "uint32";
    case Scalar::int64:
      return "int64";
    case Scalar::uint64:
      return "uint64";
    case Scalar::float32:
      return "float32";
    case Scalar::float64:
      return "float64";
  }
  throw std::invalid_argument("name_of: not a Scalar");
}

double load(Scalar type, const char* p) {
  switch (type) {
    case Scalar::int8:
      return load_as<std::int8_t>(p);
    case Scalar::uint8:
      return load_as<std::uint8_t>(p);
    case Scalar::int16:
      return load_as<std::int16_t>(p);
    case Scalar::uint16:
      return load_as<std::uint16_t>(p);
    case Scalar::int32:
      return load_as<std::int32_t>(p);
    case Scalar::uint32:
      return load_as<std::uint32_t>(p);
    case Scalar::int64:
      return load_as<std::int64_t>(p);
    case Scalar::uint64:
      return load_as<std::uint64_t>(p);
    case Scalar::float32:
      return load_as<float>(p);
    case Scalar::float64:
      return load_as<double>(p);
  }
  throw std::invalid_argument("load: not a Scalar");
}

void store(Scalar type, char* p, double value) {
  switch (type) {
    case Scalar::int8:
      return store_as<std::int8_t>(p, value);
    case Scalar::uint8:
      return store_as<std::uint8_t>(p, value);
    case Scalar::int16:
      return store_as<std::int16_t>(p, value);
    case Scalar::uint16:
      return store_as<std::uint16_t>(p, value);
    case Scalar::int32:
      return store_as<std::int32_t>(p, value);
    case Scalar::uint32:
      return store_as<std::uint32_t>(p, value);
    case Scalar::int64:
      return store_as<std::int64_t>(p, value);
    case Scalar::uint64:
      return store_as<std::uint64_t>(p, value);
    case Scalar::float32:
      return store_as<float>(p, value);
    case Scalar::float64:
      return store_as<double>(p, value);
  }
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
