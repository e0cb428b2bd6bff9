/// Ctrl-C and its relatives: how the signals of the operating system reach the work.
///
/// A signal handler can only write to a global variable. This one stays in stop.cpp; the library sees it
/// through Context::stop.
#pragma once

#include <atomic>
#include <csignal>

namespace rfsmooth::cli {

/// What cancels the work: Ctrl-C, a polite kill, the end of the terminal.
inline constexpr int kCancelling[] = {SIGINT, SIGTERM, SIGHUP};

/// True once one of them has arrived; it never becomes false again. May be read by any thread.
const std::atomic<bool>& stop_flag();

/// From now on they set the flag instead of ending the process, and system calls that wait return with EINTR;
/// one that the caller has ignored, as nohup does, stays ignored. Signals of writing that fails (SIGPIPE,
/// SIGXFSZ) are ignored: it returns an error. Call it once, before other threads start.
void catch_signals();

}  // namespace rfsmooth::cli
