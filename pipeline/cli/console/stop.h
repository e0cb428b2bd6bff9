/// Ctrl-C and its relatives: how the signals of the operating system reach the work.
///
/// A signal handler can only write to a global variable. This one stays in stop.cpp; the library sees it
/// through Context::stop.
#pragma once

#include <atomic>

namespace rfsmooth::cli {

/// True once SIGINT or SIGTERM has arrived; it never becomes false again. May be read by any thread.
const std::atomic<bool>& stop_flag();

/// From now on SIGINT and SIGTERM set the flag instead of ending the process, and system calls that wait
/// return with EINTR. SIGPIPE is ignored. Call it once, before other threads start.
void catch_signals();

}  // namespace rfsmooth::cli
