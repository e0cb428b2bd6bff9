/// Long work for Python: the interpreter is free meanwhile; progress and Ctrl-C reach it.
#pragma once

#include <functional>
#include <vector>

#include <nanobind/nanobind.h>

#include <rfsmooth/context.h>

#include "pipeline/cli/console/console.h"

namespace rfsmooth::python {

/// What is to be done. It must not touch Python.
using Work = std::function<void(const Context&, cli::Console&)>;

/// Does `work` on a thread of its own. The caller's thread waits without the interpreter's lock and takes it
/// twenty times a second, to look for signals and to call `progress` (None, or a callable of the stage's name
/// and the share done in [0, 1]) where there is something new. What is said in warnings becomes Python's
/// warnings, when the work is done. `threads`: 0 = all cores. `stages`: what there is to do, for the share.
/// \throw what `work` throws; nanobind::python_error with what a signal's handler, `progress` or a warnings
/// filter raised: the work has been cancelled and has ended by then.
void released(const nanobind::object& progress, int threads, std::vector<cli::StageShare> stages,
              const Work& work);

}  // namespace rfsmooth::python
