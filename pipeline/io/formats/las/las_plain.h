/// LAS from and to what other formats have: plain fields, one value each.
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

/// Whether a field of that name and kind can be a field of a LAS file, standard or extra.
bool is_las_field(const Field& field);

/// A LAS 1.4 file of a cloud of binary rows with plain fields: point format 6, with colours 7, with nir 8.
/// `xyz`: its coordinates. Fields of the specification's names take their places if their values fit, the
/// others become extra bytes. The scale is the finest power of ten that gives the cloud at most 1e9 steps.
/// Points that are not finite are left out; comments become a text record.
Cloud las_of_plain(const Cloud& plain, const std::vector<double>& xyz, const Context& context);

}  // namespace rfsmooth::pipeline::io
