/// Clouds of random make: any field types, names, lists, arrays, elements, values (NaN, infinities, all
/// bits).
#pragma once

#include <random>

#include "pipeline/io/io.h"

namespace rfsmooth::pipeline::io {

inline std::size_t below(std::mt19937_64& engine, std::size_t n) {
  return std::size_t(engine() % n);
}

inline void append_random_value(Bytes& data, Scalar type, std::mt19937_64& engine, bool finite_text) {
  char p[8];
  const std::uint64_t bits = engine();
  for (std::size_t k = 0; k < 8; ++k) p[k] = char(bits >> (8 * k));
  // A NaN's payload has no text.
  if (finite_text && is_float(type)) store(type, p, double(std::int64_t(bits)) * 1e-12);
  data.insert(data.end(), p, p + size_of(type));
}

inline Table random_table(std::string name, std::size_t rows, bool points, Format format, bool finite_text,
                          std::mt19937_64& engine) {
  constexpr Scalar kTypes[] = {Scalar::int8,  Scalar::uint8,  Scalar::int16,   Scalar::uint16,
                               Scalar::int32, Scalar::uint32, Scalar::float32, Scalar::float64,
                               Scalar::int64, Scalar::uint64};
  const std::size_t types = format == Format::pcd ? 10 : 8;
  Table table;
  table.name = std::move(name);
  table.count = rows;
  const std::size_t extra = below(engine, 5) + (points ? 0 : 1);
  for (std::size_t f = 0; f < extra; ++f) {
    Field field{"field" + std::to_string(below(engine, 4)),
                kTypes[below(engine, types)]};  // names may repeat
    if (format == Format::ply && below(engine, 3) == 0) field.list_count = kTypes[below(engine, 6)];
    if (format == Format::pcd && below(engine, 3) == 0) field.count = 1 + below(engine, 4);
    table.fields.push_back(field);
  }
  if (points)
    for (const char* axis : {"x", "y", "z"})
      table.fields.insert(table.fields.begin() + std::ptrdiff_t(below(engine, table.fields.size() + 1)),
                          Field{axis, below(engine, 2) == 0 ? Scalar::float32 : Scalar::float64});
  const bool lists = table.has_lists();
  if (lists) table.start.push_back(0);
  for (std::size_t i = 0; i < rows; ++i) {
    for (const Field& field : table.fields) {
      std::size_t n = field.count;
      if (field.is_list()) {
        n = below(engine, 4);
        char p[8];
        store(*field.list_count, p, double(n));
        table.data.insert(table.data.end(), p, p + size_of(*field.list_count));
      }
      for (std::size_t k = 0; k < n; ++k) append_random_value(table.data, field.type, engine, finite_text);
    }
    if (lists) table.start.push_back(table.data.size());
  }
  return table;
}

/// `finite_text`: values that text can hold to the bit.
inline Cloud random_cloud(Format format, bool finite_text, std::mt19937_64& engine) {
  Cloud cloud;
  cloud.format = format;
  const std::size_t rows = below(engine, 20);
  if (format == Format::ply) {
    if (below(engine, 2) == 0)
      cloud.elements.push_back(random_table("camera", below(engine, 3), false, format, finite_text, engine));
    cloud.vertex = cloud.elements.size();
  }
  cloud.elements.push_back(random_table("vertex", rows, true, format, finite_text, engine));
  if (format == Format::ply && below(engine, 2) == 0)
    cloud.elements.push_back(random_table("face", below(engine, 10), false, format, finite_text, engine));
  cloud.width = rows;
  if (format == Format::pcd && rows % 2 == 0 && rows > 0) {
    cloud.width = rows / 2;
    cloud.height = 2;
    cloud.viewpoint = "1.50 0 0 0 1 0 0";
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t f = 0; f < cloud.points().fields.size(); ++f)
      if (cloud.points().fields[f].name == std::string(1, char('x' + char(axis)))) cloud.xyz[axis] = f;
  if (below(engine, 2) == 0) cloud.notes.push_back({format == Format::ply ? "comment a note" : "# a note"});
  return cloud;
}

}  // namespace rfsmooth::pipeline::io
