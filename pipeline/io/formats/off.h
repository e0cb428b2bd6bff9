/// OFF, the Object File Format of meshes: ascii, with the prefixes ST (texture), C (colour), N (normals).
#pragma once

#include "pipeline/io/stream/sink.h"
#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// Reads an OFF file: the points, and element 'face' with the list vertex_indices (colours behind it stay in
/// the text). \throw Failure (input_unreadable) naming the line, what was expected and what was found.
Cloud read_off(const Source& source, const Context& context);

/// Writes the whole file.
void write_off(const Cloud& cloud, Sink& sink, const Context& context);

/// The fields an OFF file of the points' kind would have, by index into the points' fields, in OFF's order: x
/// y z, nx ny nz, red green blue [alpha], s t; what is not there is left out.
std::vector<std::size_t> off_fields(const Cloud& cloud);

/// Whether `word` is OFF with any prefixes.
bool is_off_word(std::string_view word);

}  // namespace rfsmooth::pipeline::io
