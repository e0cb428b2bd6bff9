#include "pipeline/cli/console/stop.h"

#include <csignal>

namespace rfsmooth::cli {

namespace {
std::atomic<bool> stopped{false};
static_assert(std::atomic<bool>::is_always_lock_free, "the handler must not lock");

extern "C" void note_signal(int) {
  stopped.store(true, std::memory_order_relaxed);
}
}  // namespace

const std::atomic<bool>& stop_flag() {
  return stopped;
}

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = note_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // no SA_RESTART: a read that waits for standard input must return
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a failed write (exit code 5), not a death
}

}  // namespace rfsmooth::cli
