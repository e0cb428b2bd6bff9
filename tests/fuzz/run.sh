#!/usr/bin/env bash
# Fuzzes every target for SECONDS each (default 20) with the committed corpus as a start; stops at the first finding,
# whose input is left in build/fuzz/findings. bash tests/fuzz/run.sh [SECONDS] [TARGET...]
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-20}
shift || true
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(cd build/fuzz/tests/fuzz && ls fuzz_*)
mkdir -p build/fuzz/findings
for target in "${targets[@]}"; do
  name=${target#fuzz_}
  mkdir -p "build/fuzz/corpus/$name"
  committed="tests/fuzz/corpus/${name#read_}"
  [ -d "$committed" ] || committed=""
  echo "== $target, $seconds s"
  "build/fuzz/tests/fuzz/$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=4096 -print_final_stats=0 \
    -verbosity=0 -artifact_prefix="build/fuzz/findings/$name-" "build/fuzz/corpus/$name" $committed
done
echo "no finding"
