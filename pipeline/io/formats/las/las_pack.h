/// LAS from what other formats have: plain fields, one value each. The way back is las_plain.h.
#pragma once

#include <vector>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// Whether a field of that name and kind can be a field of a LAS file, standard or extra.
bool is_las_field(const Field& field);

/// A LAS 1.4 file of a cloud of binary rows with plain fields: point format 6, with colours 7, with nir 8.
/// `xyz`: its coordinates. Fields of the specification's names take their places if their values fit, the
/// others become extra bytes. The scale is the finest power of ten that gives the cloud at most 1e9 steps.
/// Points that are not finite are left out; comments become text records, cut at the ends of lines.
Cloud las_of_plain(const Cloud& plain, const std::vector<double>& xyz, const Context& context);

}  // namespace rfsmooth::pipeline::io
