/// What a point of a LAS file holds: fields by point format, and the extra bytes that a record names.
#pragma once

#include <string_view>
#include <vector>

#include "pipeline/io/formats/las/las_header.h"
#include "pipeline/io/table/field.h"

namespace rfsmooth::pipeline::io::las {

inline constexpr int kNewestPoints = 10;

/// Bytes of a point of that format without extra bytes.
std::size_t row_size(int point_format);

/// Formats 6 to 10: return numbers up to 15, angles in steps of 0.006 degrees.
bool is_extended(int point_format);
/// Formats 4, 5, 9 and 10: each point says where its waveform is.
bool has_waveforms(int point_format);

/// Its fields, named as laspy names what is stored: x, y, z (scaled), intensity, bit_fields, ...
std::vector<Field> standard_fields(int point_format);

/// All fields of the points: the standard ones, those that the record LASF_Spec 4 describes, and
/// 'extra_bytes' for what it does not. `described`: whether that record, if there is one, fits the points.
std::vector<Field> fields_of(std::string_view head, bool& described);

/// Describes `fields`, which stand behind the others of every point, in the record LASF_Spec 4 of `head`,
/// which is made if it is not there; sizes and places in the header follow. Extra bytes nobody described get
/// a description as such. \throw Failure (usage) if that record is full or does not fit the points.
void describe_extra_bytes(std::string& head, const std::vector<Field>& fields);

/// The most bytes that the name of an extra field may have.
inline constexpr std::size_t kLongestName = 32;

/// Appends a VLR behind the others and moves the points.
void append_record(std::string& head, std::string_view user, std::uint16_t id, std::string_view body);

}  // namespace rfsmooth::pipeline::io::las
