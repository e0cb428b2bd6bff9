/// How much memory there is, so that a job that cannot fit is refused before it starts; and taking no more of
/// it than is used.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include <rfsmooth/result.h>

namespace rfsmooth::cli {

/// Bytes this process may still take: the least of what the machine has free, what its control group allows
/// and what the address-space limit leaves. Nothing if none is known.
std::optional<std::size_t> available_memory();

/// An Error (out_of_memory) with both figures if `needed` bytes are not there.
std::optional<Error> refuse_without_memory(std::string_view input, std::size_t needed);

/// From now on freed arrays go back to the system at once. Call before anything large is allocated.
void give_memory_back();

}  // namespace rfsmooth::cli
