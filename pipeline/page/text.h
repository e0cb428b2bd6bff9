/// What goes into a page as text: escaped, packed, put in its place.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace rfsmooth::pipeline {

/// Any bytes as HTML text or attribute: & < > " ' escaped, what is no UTF-8 and control characters replaced
/// by U+FFFD.
std::string escaped(std::string_view text);

/// gzip of the bytes, always the same for the same bytes. \throw std::bad_alloc
std::string gzipped(std::string_view bytes);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

/// The bytes that hexadecimal digits stand for.
std::string bytes_of_hex(std::string_view digits);

/// `text` with every {{name}} replaced by what `values` has for it; what is put in is not looked at again.
/// \throw std::out_of_range for a name that is not there.
std::string filled(std::string_view text, const std::map<std::string, std::string, std::less<>>& values);

}  // namespace rfsmooth::pipeline
