/// rfsmooth-reconstruct: what `rfsmooth reconstruct` becomes. The same options, with the methods that this
/// build has.
#include <string_view>

#include "rfsmooth/pipeline/cli/program.h"
#include "rfsmooth/pipeline/cli/reconstruct_command.h"
#ifdef RFSMOOTH_HAVE_CGAL
#include "rfsmooth/cgal/advancing_front.h"
#endif

namespace {

std::vector<rfsmooth::pipeline::SurfaceMethod> methods() {
  std::vector<rfsmooth::pipeline::SurfaceMethod> all;
#ifdef RFSMOOTH_HAVE_CGAL
  all.push_back(rfsmooth::cgal::advancing_front_method());
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
