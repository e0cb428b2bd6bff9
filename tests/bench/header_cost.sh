#!/usr/bin/env bash
# What including a public header costs its user: processor seconds to compile each alone, dearest first. Fails where one
# outside the adapters takes 1.5 s or more (on a busy machine everything takes longer).
# bash tests/bench/header_cost.sh
set -euo pipefail
cd "$(dirname "$0")/../.."
TIMEFORMAT='%U %S'
for header in include/rfsmooth/*.h; do
  echo "#include <${header#include/}>" |
    { time g++ -std=c++17 -O2 -c -x c++ -I include -isystem /usr/include/eigen3 -o /dev/null -; } 2>&1 |
    awk -v header="$header" '{ printf "%.2f s  %s\n", $1 + $2, header }'
done | sort -rn | awk '{ print; if ($1 >= 1.5) dear = 1 } END { exit dear }'
