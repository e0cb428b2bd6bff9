/// The Python class of clouds. Their rows go to numpy and come back as one array of bytes.
#pragma once

#include <nanobind/nanobind.h>

namespace rfsmooth::python {

/// Adds the class Cloud: a cloud in memory, or a file with all that stands beside its points.
void bind_cloud(nanobind::module_& module);

}  // namespace rfsmooth::python
