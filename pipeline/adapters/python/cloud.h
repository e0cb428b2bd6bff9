/// Clouds between numpy and the library: rows of fields as a numpy array of bytes has them.
#pragma once

#include <nanobind/nanobind.h>

namespace rfsmooth::python {

/// Adds the class Cloud: a cloud in memory, or a file with all that stands beside its points.
void bind_cloud(nanobind::module_& module);

}  // namespace rfsmooth::python
