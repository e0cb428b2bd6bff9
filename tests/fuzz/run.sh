#!/usr/bin/env bash
# Fuzzes every target for SECONDS each (default 20), as many at a time as there are cores (or JOBS), with the committed corpus
# as a start. The inputs of findings are left in build/fuzz/findings; the exit code says whether there were any.
#   bash tests/fuzz/run.sh [SECONDS] [TARGET...]        bash tests/fuzz/run.sh 600: ten minutes each
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-20}
shift || true
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(cd build/fuzz/tests/fuzz && ls fuzz_*)
mkdir -p build/fuzz/findings

fuzz() { # TARGET
  local name=${1#fuzz_} log
  log="build/fuzz/$name.log"
  mkdir -p "build/fuzz/corpus/$name"
  local committed="tests/fuzz/corpus/${name#read_}"
  # libFuzzer ends in an error at its first finding.
  if nice -n 10 "build/fuzz/tests/fuzz/$1" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 -max_len=4096 -print_final_stats=1 \
      -verbosity=0 -artifact_prefix="build/fuzz/findings/$name-" "build/fuzz/corpus/$name" "$committed" > "$log" 2>&1; then
    echo "$1: $seconds s, $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs, no finding"
  else
    echo "$1: FOUND SOMETHING"
    tail -n 40 "$log"
    return 1
  fi
}
export -f fuzz
export seconds
printf '%s\n' "${targets[@]}" | xargs -P "${JOBS:-$(nproc)}" -I{} bash -c 'fuzz {}'
