#!/usr/bin/env bash
# alone.sh ROOT WORK COMPILER INCLUDE...: every source of the library is complete by itself: it includes what it names, which
# builds that compile several as one do not show. No code is made. Of what is included only Eigen/Core is read beforehand, once.
set -euo pipefail
cd "$1"
mkdir -p "$2"
compile=("$3" -std=c++17 -fPIC -I. -Iinclude)
for folder in "${@:4}"; do compile+=(-isystem "$folder"); done
echo '#include <Eigen/Core>' > "$2/first.h"
"${compile[@]}" -x c++-header "$2/first.h" -o "$2/first.h.gch"
# The adapters' sources are compiled by themselves anyway; no user compiles the command's otherwise than we do.
find base rfs_mesh smoothing pipeline -name '*.cpp' -not -path 'pipeline/adapters/*' -not -path 'pipeline/cli/*' \
    -not -path 'pipeline/page/*' -not -path 'pipeline/tiles/*' -print0 |
  xargs -0 -n 8 -P 2 "${compile[@]}" -fsyntax-only -include "$2/first.h"
