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

/// Gives a signal that handler, unless it is ignored, as the caller may have asked for (nohup). Returns what
/// it did before.
struct sigaction handle_unless_ignored(int signal, const struct sigaction& handler);

/// From now on what cancels the work sets the flag instead of ending the process, and system calls that wait
/// return with EINTR. Signals of writing that fails (SIGPIPE, SIGXFSZ) are ignored: it returns an error. Call
/// it once, before other threads start.
void catch_signals();

}  // namespace rfsmooth::cli
