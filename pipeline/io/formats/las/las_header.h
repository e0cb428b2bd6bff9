/// The header of a LAS file: where things stand in it (ASPRS LAS 1.4 R15, table 3; 1.0 to 1.3 are its
/// beginning), and the variable length records (VLRs) behind it.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/io/stream/source.h"

namespace rfsmooth::pipeline::io::las {

/// Bytes from the start of the file.
inline constexpr std::size_t kEncodingAt = 6, kMajorAt = 24, kMinorAt = 25, kSystemAt = 26, kSoftwareAt = 58,
                             kHeaderSizeAt = 94, kPointsAt = 96, kRecordsAt = 100, kPointFormatAt = 104,
                             kRowSizeAt = 105, kLegacyCountAt = 107, kLegacyReturnsAt = 111, kScaleAt = 131,
                             kOffsetAt = 155, kBoxAt = 179, kWaveformsAt = 227, kExtendedAt = 235,
                             kExtendedCountAt = 243, kCountAt = 247, kReturnsAt = 255;

/// Bytes in front of what a VLR holds, and an extended one (EVLR, behind the points).
inline constexpr std::size_t kRecordHeader = 54, kExtendedHeader = 60;

/// Records that the specification names.
inline constexpr std::string_view kSpecification = "LASF_Spec", kProjection = "LASF_Projection";
inline constexpr std::uint16_t kTextRecord = 3, kExtraBytesRecord = 4;

/// The number at byte `at`, little-endian.
template <class T>
T number(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Writes it there.
template <class T>
void put_number(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// What a header says.
struct Header {
  int minor = 4;                   ///< of the version, 1.minor
  int point_format = 0;            ///< 0 to 10
  bool compressed = false;         ///< LAZ
  std::size_t size = 0;            ///< of the header
  std::uint64_t points = 0;        ///< first byte of the points
  std::uint64_t records = 0;       ///< VLRs
  std::size_t row_size = 0;        ///< bytes of a point
  std::uint64_t count = 0;         ///< points
  std::uint64_t legacy_count = 0;  ///< as versions before 1.4 say it; 0 where they cannot
  std::array<double, 3> scale{}, offset{};
  bool waveforms_inside = false;                                  ///< in this file, not in one beside it
  std::uint64_t waveforms = 0, extended = 0, extended_count = 0;  ///< 0 where the version has none

  std::uint64_t end_of_points() const { return points + count * row_size; }
};

/// Bytes of the header of version 1.minor.
std::size_t header_size(int minor);

/// Reads a header that is complete; nothing is checked.
Header read_header(std::string_view bytes);

/// Reads and checks a header against the size of the file, before anything is allocated.
/// \throw Failure (input_unreadable) naming the byte, what was expected, what was found, what to do.
Header read_header(const Source& source, const Context& context);

/// A VLR or EVLR.
struct Record {
  std::size_t at = 0;    ///< its own first byte
  std::size_t size = 0;  ///< what it holds, behind its header
  bool extended = false;
  std::string user;  ///< "LASF_Projection", ...
  std::uint16_t id = 0;

  std::size_t body() const { return at + (extended ? kExtendedHeader : kRecordHeader); }
  std::size_t end() const { return body() + size; }
  bool is(std::string_view of, std::uint16_t with) const { return user == of && id == with; }
};

/// The VLRs in `head`, the file before its points; as many as are complete.
std::vector<Record> records_of(std::string_view head);

/// The EVLRs in `tail`, the file from byte `from` on; as many as are complete.
std::vector<Record> extended_records_of(const Header& header, std::string_view tail, std::uint64_t from);

/// Refuses VLRs that do not end before the points. \throw Failure.
void check_records(const Source& source, std::string_view head);

/// Refuses EVLRs and waveforms that do not end before the file. \throw Failure.
void check_extended(const Source& source, const Header& header, std::string_view tail);

}  // namespace rfsmooth::pipeline::io::las
