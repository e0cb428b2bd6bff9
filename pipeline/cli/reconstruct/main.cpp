/// rfsmooth-reconstruct: what `rfsmooth reconstruct` becomes. The same options, with the methods that this
/// build has.
#include <array>
#include <csignal>
#include <iterator>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "pipeline/cli/commands/reconstruct_command.h"
#include "pipeline/cli/console/stop.h"
#include "pipeline/cli/program.h"
#ifdef RFSMOOTH_HAVE_CGAL
#include <rfsmooth/cgal/advancing_front.h>
#endif
#ifdef RFSMOOTH_HAVE_OPEN3D
#include <rfsmooth/open3d/surface.h>
#endif

namespace {

/// Where the handler below may write: standard error, even while it is silenced.
volatile std::sig_atomic_t messages = STDERR_FILENO;

extern "C" void cancel(int) {
  constexpr std::string_view kLine = "rfsmooth: error: cancelled\n";
  if (write(messages, kLine.data(), kLine.size()) < 0) _exit(130);  // nobody reads it
  _exit(130);
}

/// As long as this lives Ctrl-C ends the program: the libraries cannot be interrupted, and no file is open
/// yet. And standard error goes nowhere: the Poisson solver inside Open3D writes a line there for many a
/// vertex, past Open3D's own log.
class InsideLibrary {
 public:
  InsideLibrary() : kept_(dup(STDERR_FILENO)), nowhere_(open("/dev/null", O_WRONLY | O_CLOEXEC)) {
    if (kept_ >= 0) messages = kept_;
    struct sigaction action = {};
    action.sa_handler = cancel;
    sigemptyset(&action.sa_mask);
    auto before = before_.begin();
    for (const int signal : rfsmooth::cli::kCancelling)
      *before++ = rfsmooth::cli::handle_unless_ignored(signal, action);
    if (kept_ >= 0 && nowhere_ >= 0) dup2(nowhere_, STDERR_FILENO);
  }
  ~InsideLibrary() {
    auto before = before_.cbegin();
    for (const int signal : rfsmooth::cli::kCancelling) sigaction(signal, &*before++, nullptr);
    messages = STDERR_FILENO;
    if (kept_ >= 0) dup2(kept_, STDERR_FILENO);
    for (const int descriptor : {kept_, nowhere_})
      if (descriptor >= 0) close(descriptor);
  }
  InsideLibrary(const InsideLibrary&) = delete;
  InsideLibrary& operator=(const InsideLibrary&) = delete;

 private:
  int kept_, nowhere_;
  std::array<struct sigaction, std::size(rfsmooth::cli::kCancelling)> before_{};
};

rfsmooth::SurfaceMethod guarded(rfsmooth::SurfaceMethod method) {
  method.run = [run = std::move(method.run)](const auto& input, const auto& context) {
    context.check_stop();
    const InsideLibrary inside;
    return run(input, context);
  };
  return method;
}

std::vector<rfsmooth::SurfaceMethod> methods() {
  std::vector<rfsmooth::SurfaceMethod> all;
#ifdef RFSMOOTH_HAVE_CGAL
  all.push_back(guarded(rfsmooth::cgal::advancing_front_method()));
#endif
#ifdef RFSMOOTH_HAVE_OPEN3D
  for (auto& method : rfsmooth::open3d::surface_methods()) all.push_back(guarded(std::move(method)));
#endif
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  return rfsmooth::cli::run_program(argc, argv, rfsmooth::cli::reconstruct_command(methods()));
}
