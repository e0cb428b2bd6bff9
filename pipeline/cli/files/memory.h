/// The available memory: refusing a job that cannot fit before it starts, and returning what is freed.
#pragma once

#include <cstddef>
#include <optional>

namespace rfsmooth::cli {

/// Bytes that this process may still allocate: the least of the machine's free memory, the limit of its
/// control group and the limit of its address space. None if none of them is known.
std::optional<std::size_t> available_memory();

/// \throw Failure (out_of_memory) with both figures if fewer than `needed` bytes are available. It names no
/// file (io::naming does).
void need_memory(std::size_t needed);

/// From now on freed arrays return to the system at once. Call it before anything large is allocated.
void give_memory_back();

}  // namespace rfsmooth::cli
