/// Names that both directions of conversion use: values of a few bits, colours.
#pragma once

#include <algorithm>
#include <string_view>

namespace rfsmooth::pipeline::io::las {

/// Bits of a byte that are a value of their own (LAS 1.4 R15, tables 8 and 15).
struct Part {
  std::string_view of, name;
  int shift, bits;
};
/// Of point formats 0 to 5.
inline constexpr Part kOldParts[] = {
    {"bit_fields", "return_number", 0, 3},          {"bit_fields", "number_of_returns", 3, 3},
    {"bit_fields", "scan_direction_flag", 6, 1},    {"bit_fields", "edge_of_flight_line", 7, 1},
    {"raw_classification", "classification", 0, 5}, {"raw_classification", "synthetic", 5, 1},
    {"raw_classification", "key_point", 6, 1},      {"raw_classification", "withheld", 7, 1}};
/// Of point formats 6 to 10.
inline constexpr Part kNewParts[] = {{"bit_fields", "return_number", 0, 4},
                                     {"bit_fields", "number_of_returns", 4, 4},
                                     {"classification_flags", "synthetic", 0, 1},
                                     {"classification_flags", "key_point", 1, 1},
                                     {"classification_flags", "withheld", 2, 1},
                                     {"classification_flags", "overlap", 3, 1},
                                     {"classification_flags", "scanner_channel", 4, 2},
                                     {"classification_flags", "scan_direction_flag", 6, 1},
                                     {"classification_flags", "edge_of_flight_line", 7, 1}};

inline constexpr std::string_view kColours[] = {"red", "green", "blue"};

/// Whether a field of that name is one of them.
inline bool is_colour(std::string_view name) {
  return std::find(std::begin(kColours), std::end(kColours), name) != std::end(kColours);
}

}  // namespace rfsmooth::pipeline::io::las
