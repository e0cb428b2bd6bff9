#include "pipeline/cli/console/stop.h"

#include <csignal>

namespace rfsmooth::cli {

namespace {
std::atomic<bool> stopped{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not lock");

extern "C" void set_stopped(int) {
  stopped.store(true, std::memory_order_relaxed);  // no other data hang on the flag
}
}  // namespace

const std::atomic<bool>& stop_flag() {
  return stopped;
}

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = set_stopped;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // not SA_RESTART: a read that waits for standard input is to return
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // writing to a closed pipe then fails: exit code 5
}

}  // namespace rfsmooth::cli
