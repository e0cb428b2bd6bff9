/// Ctrl-C. A signal handler needs a global; this is the command's only one, and the library never sees it but
/// through Context::stop.
#pragma once

#include <atomic>

namespace rfsmooth::cli {

/// Set once SIGINT or SIGTERM has arrived.
const std::atomic<bool>& stop_flag();

/// From now on SIGINT and SIGTERM set the flag instead of killing the process; blocked reads return.
void catch_signals();

}  // namespace rfsmooth::cli
