#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: bash tests/run.sh [PRESET]   (dev by default; asan, tsan, no-cgal)
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/packages.sh
install_missing $core_packages $test_packages

export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$PWD} CCACHE_NOHASHDIR=1  # what several build folders compile alike is compiled once
preset=${1:-dev}
[ "$preset" != dev ] || install_python
cmake --preset "$preset" > /dev/null
cmake --build --preset "$preset"
ctest --preset "$preset" -j "$(nproc)"
