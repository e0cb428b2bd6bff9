#!/usr/bin/env bash
# Formatting, clang-tidy over our own code and doxygen over the public headers, warnings as errors:
# bash tests/lint.sh [--format-only]
# Needs the dev build folder (compile_commands.json). Peers and adapters of heavy libraries are formatted, not tidied:
# clang-tidy would spend its time in their headers.
set -euo pipefail
cd "$(dirname "$0")/.."

git ls-files -z '*.h' '*.cpp' '*.hpp' | xargs -0 clang-format-14 --dry-run -Werror
echo "formatting: clean"
[ "${1:-}" = --format-only ] && exit 0

git ls-files -z 'rfs_mesh/*.cpp' 'smoothing/*.cpp' 'pipeline/*.cpp' 'clouds/*.cpp' \
    ':!pipeline/pcl/*' ':!pipeline/open3d/*' ':!pipeline/cgal/*' |
  xargs -0 -n 4 -P "$(nproc)" clang-tidy-14 -p build/dev --quiet 2> >(grep -v -E 'warnings? (generated|treated)|^Suppressed|^Use -header' >&2)
echo "clang-tidy: clean"

# Every class, enumeration and free function has a brief; accessors and fields whose name says all may go without.
mkdir -p build
undocumented=$(doxygen Doxyfile 2>&1 | grep -v -E 'Member .* of (struct|class) .* is not documented' || true)
if [ -n "$undocumented" ]; then
  echo "$undocumented"
  exit 1
fi
echo "doxygen: clean"
