/// "Did you mean ...?" for misspelt options and values.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rfsmooth::cli {

/// The candidate with the least edit distance to `word` (insert, delete, replace, swap of neighbours; ties:
/// the first). None if the distance is more than a third of the letters (at least one is allowed).
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates);

/// "; did you mean 'x'?" or "".
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace rfsmooth::cli
