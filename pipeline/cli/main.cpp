/// The rfsmooth command.
#include "pipeline/cli/files/memory.h"
#include "pipeline/cli/program.h"

int main(int argc, char** argv) {
  rfsmooth::cli::give_memory_back();
  return rfsmooth::cli::run_program(argc, argv, rfsmooth::cli::all_commands());
}
