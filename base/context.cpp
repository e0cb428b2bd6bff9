#include <rfsmooth/context.h>
#include <rfsmooth/result.h>

namespace rfsmooth {

namespace {
[[noreturn]] void cancel() {
  throw Failure({ErrorCode::cancelled, "cancelled"});
}
}  // namespace

void Context::report(std::string_view stage, double fraction) const {
  check_stop();
  if (progress && !progress(stage, fraction)) cancel();
}

void Context::check_stop() const {
  if (stop != nullptr && stop->load(std::memory_order_relaxed)) cancel();
}

}  // namespace rfsmooth
