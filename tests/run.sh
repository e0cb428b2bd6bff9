#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: bash tests/run.sh
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/packages.sh
install_missing $core_packages $test_packages

cmake --preset dev > /dev/null
cmake --build --preset dev
ctest --preset dev -j "$(nproc)"
