/// rfsmooth-reconstruct: what `rfsmooth reconstruct` becomes. The same options, with the methods that this
/// build has.
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "rfsmooth/pipeline/cli/program.h"
#include "rfsmooth/pipeline/cli/reconstruct_command.h"
#ifdef RFSMOOTH_HAVE_CGAL
#include "rfsmooth/cgal/advancing_front.h"
#endif
#ifdef RFSMOOTH_HAVE_OPEN3D
#include "rfsmooth/open3d/surface.h"
#endif

namespace {

#ifdef RFSMOOTH_HAVE_OPEN3D
/// Standard error goes nowhere as long as this lives: the Poisson solver inside Open3D writes a line there
/// for many a vertex, past Open3D's own log.
class Silence {
 public:
  Silence() : kept_(dup(STDERR_FILENO)), nowhere_(open("/dev/null", O_WRONLY | O_CLOEXEC)) {
    if (kept_ >= 0 && nowhere_ >= 0) dup2(nowhere_, STDERR_FILENO);
  }
  ~Silence() {
    if (kept_ >= 0) dup2(kept_, STDERR_FILENO);
    for (const int descriptor : {kept_, nowhere_})
      if (descriptor >= 0) close(descriptor);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  int kept_, nowhere_;
};

rfsmooth::pipeline::SurfaceMethod silenced(rfsmooth::pipeline::SurfaceMethod method) {
  method.run = [run = std::move(method.run)](const auto& input, const auto& context) {
    const Silence silence;
    return run(input, context);
  };
  return method;
}
#endif

std::vector<rfsmooth::pipeline::SurfaceMethod> methods() {
  std::vector<rfsmooth::pipeline::SurfaceMethod> all;
#ifdef RFSMOOTH_HAVE_CGAL
  all.push_back(rfsmooth::cgal::advancing_front_method());
#endif
#ifdef RFSMOOTH_HAVE_OPEN3D
  for (auto& method : rfsmooth::open3d::surface_methods()) all.push_back(silenced(std::move(method)));
#endif
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<const char*> words(argv, argv + argc);
  const bool version = argc == 2 && std::string_view(argv[1]) == "--version";
  if (!version) words.insert(words.begin() + 1, "reconstruct");
  return rfsmooth::cli::run_program(int(words.size()), words.data(),
                                    {rfsmooth::cli::reconstruct_command(methods())});
}
