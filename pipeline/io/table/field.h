/// A property of a point (or of a face, an edge): its name and type as in the file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rfsmooth::pipeline::io {

/// The number types of PLY and PCD.
enum class Scalar { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

/// All of them, in the order of their values.
inline constexpr std::array kScalars = {Scalar::int8,    Scalar::uint8,  Scalar::int16, Scalar::uint16,
                                        Scalar::int32,   Scalar::uint32, Scalar::int64, Scalar::uint64,
                                        Scalar::float32, Scalar::float64};

/// Calls `body` with a zero of the type of C++ that `type` stands for; returns what it returns.
/// \throw std::invalid_argument if `type` is none.
template <class Body>
auto with_type(Scalar type, Body&& body) {
  switch (type) {
    case Scalar::int8:
      return body(std::int8_t{});
    case Scalar::uint8:
      return body(std::uint8_t{});
    case Scalar::int16:
      return body(std::int16_t{});
    case Scalar::uint16:
      return body(std::uint16_t{});
    case Scalar::int32:
      return body(std::int32_t{});
    case Scalar::uint32:
      return body(std::uint32_t{});
    case Scalar::int64:
      return body(std::int64_t{});
    case Scalar::uint64:
      return body(std::uint64_t{});
    case Scalar::float32:
      return body(float{});
    case Scalar::float64:
      return body(double{});
  }
  throw std::invalid_argument("with_type: not a Scalar");
}

std::size_t size_of(Scalar type);       ///< bytes
bool is_float(Scalar type);             ///< float32 or float64
std::string_view name_of(Scalar type);  ///< "float32", "uint8", ...

/// A field's name as headers have it: '_' for each blank and control character.
std::string one_word(std::string name);

/// A column of a table.
struct Field {
  std::string name;
  Scalar type = Scalar::float32;
  std::size_t count = 1;                  ///< values per row (PCD COUNT); 1 for lists
  std::optional<Scalar> list_count = {};  ///< PLY list: the type of the count in front of each row's values
  std::string spelling = {};  ///< PLY: the type's words as the file has them ("float32" or "float",
                              ///< "list uchar int"); empty = the usual ones

  double scale = 1, offset = 0;  ///< a value is what is stored * scale + offset (LAS; 1 and 0 elsewhere)

  std::size_t bytes() const { return count * size_of(type); }  ///< in a row; of a list: of one of its values
  bool is_list() const { return list_count.has_value(); }
  bool is_plain() const { return !is_list() && count == 1; }  ///< one value per row
  bool is_scaled() const { return scale != 1 || offset != 0; }
  bool is_whole() const { return !is_float(type) && !is_scaled(); }  ///< its values are whole numbers
  /// Whether they are stored as whole numbers of 64 bits, which PLY does not have.
  bool is_wide() const { return type == Scalar::int64 || type == Scalar::uint64; }
  double step() const {
    return is_float(type) ? 0 : scale < 0 ? -scale : scale;
  }  ///< to the next value, or 0
};

/// Reads the `type` at `p` (unaligned, little-endian) as a double (64-bit integers are rounded to nearest).
double load(Scalar type, const char* p);

/// Writes `value` at `p` as `type`, rounded to nearest; for integers clamped to their range, NaN as 0.
void store(Scalar type, char* p, double value);

/// The value of `field` that is stored at `p`.
double load(const Field& field, const char* p);

/// Stores a value of `field` at `p`, as the nearest that its type and scale can say; where it is scaled, a
/// value that is not finite leaves what is there.
void store(const Field& field, char* p, double value);

/// Whether `store` would write a value within half a step: it is finite and not beyond the type's range.
/// Always true of fields that are not scaled.
bool can_hold(const Field& field, double value);

}  // namespace rfsmooth::pipeline::io
