#!/usr/bin/env bash
# From nothing to weights: makes shapes, scans them, writes what the smoother knows there beside the truth, trains,
# and puts the weights into smoothing/automatic/learned/weights.cpp. About two and a half hours on two cores.
#   tests/bench/train/train.sh [CLOUDS] [EPOCHS]
# Needs what tests/packages.sh installs, and numpy, which it puts into a virtual environment of the build folder.
set -euo pipefail
cd "$(dirname "$0")/../../.."
clouds=${1:-4960} epochs=${2:-16}
cmake --preset bench
cmake --build --preset bench --target train_sites
work=build/bench/train
[ -x $work/venv/bin/python ] || python3 -m venv $work/venv
$work/venv/bin/pip install --quiet numpy
build/bench/bin/train_sites $work/sites --clouds "$clouds"
$work/venv/bin/python tests/bench/train/train.py $work/sites smoothing/automatic/learned/weights.cpp --epochs "$epochs"
cmake --build --preset bench
