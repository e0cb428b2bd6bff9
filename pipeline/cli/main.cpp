/// The rfsmooth command.
#include "rfsmooth/pipeline/cli/program.h"

int main(int argc, char** argv) {
  return rfsmooth::cli::run_program(argc, argv, rfsmooth::cli::all_commands());
}
