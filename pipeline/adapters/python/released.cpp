#include "pipeline/adapters/python/released.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <nanobind/stl/string.h>

namespace rfsmooth::python {

namespace nb = nanobind;

namespace {

constexpr auto kGlance = std::chrono::milliseconds(50);

/// The work, and what its thread and the caller's know of each other.
class Worker {
 public:
  Worker(int threads, std::vector<cli::StageShare> stages, const Work& work)
      : console_({}, [this](LogLevel level, const std::string& text) { note(level, text); }) {
    progress_.plan(std::move(stages));
    context_.threads = threads;
    context_.stop = &stop_;
    context_.log = [this](LogLevel level, const std::string& text) { note(level, text); };
    context_.progress = [this](std::string_view stage, double fraction) {
      const std::lock_guard lock(mutex_);
      progress_.note(stage, fraction);
      news_ = {progress_.stage(), progress_.done()};
      return true;  // a cancel arrives through `stop`
    };
    thread_ = std::thread([this, &work] {
      try {
        work(context_, console_);
      } catch (...) {
        failure_ = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      over_ = true;
      ended_.notify_one();
    });
  }
  ~Worker() {
    if (thread_.joinable()) thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void stop() { stop_ = true; }

  /// Waits a moment. \return whether the work is over.
  bool wait() {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, kGlance, [this] { return over_; });
  }

  /// The stage and the share done, if they changed since the last call.
  std::optional<std::pair<std::string, double>> news() {
    const std::lock_guard lock(mutex_);
    return std::exchange(news_, std::nullopt);
  }

  /// When the work is over: its warnings. \throw what it threw.
  std::vector<std::string> result() {
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
    return warnings_;
  }

 private:
  void note(LogLevel level, const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (level == LogLevel::warning) warnings_.push_back(text);
  }

  Context context_;
  cli::Console console_;
  cli::Progress progress_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::optional<std::pair<std::string, double>> news_;
  std::vector<std::string> warnings_;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it uses the others
};

/// Lets signals' handlers run, and tells `progress`. \throw nb::python_error.
void glance(Worker& worker, const nb::object& progress) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  if (progress.is_none()) return;
  if (const auto news = worker.news()) progress(news->first, news->second);
}

}  // namespace

void released(const nb::object& progress, int threads, std::vector<cli::StageShare> stages,
              const Work& work) {
  Worker worker(threads, std::move(stages), work);
  std::exception_ptr raised;
  for (bool over = false; !over;) {
    {
      const nb::gil_scoped_release release;
      over = worker.wait();
    }
    if (raised) continue;
    try {
      glance(worker, progress);
    } catch (...) {
      raised = std::current_exception();
      worker.stop();
    }
  }
  if (raised) std::rethrow_exception(raised);
  for (const std::string& warning : worker.result())
    if (PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 3) != 0) throw nb::python_error();
}

}  // namespace rfsmooth::python
