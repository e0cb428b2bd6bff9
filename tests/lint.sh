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

# Twenty sources of a target are read as one: most of clang-tidy's time would go to the same headers again and again. Names in
# unnamed namespaces are unique within a target for that, as for the sanitized builds. The folder's name tells the analyzer
# that such a source is many.
units=build/UnifiedSource
cmake --preset tidy > /dev/null
mapfile -t read < <(sed -n 's/.*"file": "\(.*\)".*/\1/p' $units/compile_commands.json)
tidy() { # BUILD FILE...
  printf '%s\0' "${@:2}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy-14 -p "$1" --quiet --checks=-bugprone-suspicious-include \
    2> >(grep -v -E 'warnings? (generated|treated)|^Suppressed|^Use -header' >&2)
}
tidy $units "${read[@]}"
if git grep -n '^#include .*\.cpp"' -- '*.h' '*.cpp'; then exit 1; fi  # which bugprone-suspicious-include would have found
# Our sources that no such target has (rfsmooth-reconstruct's main), by themselves: with the dev build's flags.
mapfile -t alone < <(git ls-files 'base/*.cpp' 'rfs_mesh/*.cpp' 'smoothing/*.cpp' 'pipeline/*.cpp' 'clouds/*.cpp' \
    ':!pipeline/adapters/*' |
  grep -v -x -F -f <(sed -n "s|^#include \"$PWD/\(.*\)\"|\1|p" "${read[@]}"))
[ ${#alone[@]} -eq 0 ] || tidy build/dev "${alone[@]}"
echo "clang-tidy: clean"

# Every class, enumeration and free function has a brief; accessors, fields and constants whose name says all may go without.
mkdir -p build
undocumented=$(doxygen Doxyfile 2>&1 | grep -v -E 'Member .* (of (struct|class)|\(variable\) of namespace) .* is not documented' || true)
if [ -n "$undocumented" ]; then
  echo "$undocumented"
  exit 1
fi
echo "doxygen: clean"
