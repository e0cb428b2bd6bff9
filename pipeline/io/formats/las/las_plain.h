/// LAS to what other formats have: plain fields, one value each. The way back is las_pack.h.
#pragma once

#include <string>
#include <vector>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// The fields of the points of a LAS cloud as `plain_of_las` gives them; only names and types count.
std::vector<Field> plain_fields(const Cloud& las);

/// What a LAS file holds that no other format has a place for, in words: coordinate system, other records,
/// waveforms. Not counted: names of program and system, dates, GUID.
std::vector<std::string> las_losses(const Cloud& las);

/// The cloud with plain fields, as a PLY file holds them: bits on their own (return_number, classification,
/// ...), scaled values as float64 (coordinates, angles in degrees), colours as uint8 where they are 8 bits
/// (alone, or times 256); texts as comments.
Cloud plain_of_las(const Cloud& las, const Context& context);

}  // namespace rfsmooth::pipeline::io
