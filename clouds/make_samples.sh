#!/usr/bin/env bash
# make_samples.sh [BIN [FOLDER]]: makes the committed sample clouds again, byte for byte. BIN holds virtual_scanner.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
bin=$(realpath "${1:-$here/../build/release/bin}")
cd "${2:-$here}"

scan() { "$bin/virtual_scanner" scan "$@" --force; }
scan sphere sphere_scan.ply --noise 0.008 --beam 0.5 --outliers 0.005 --columns 48 --rows 48 --encoding binary --seed 1
scan torus torus_scan.pcd --noise 0.008 --beam 0.5 --columns 48 --rows 48 --encoding binary_compressed --seed 2
scan cube cube_scan.ply --noise 0.008 --beam 0.5 --columns 48 --rows 48 --encoding binary --seed 3
scan l_part l_part_scan.ply --noise 0.006 --beam 0.5 --outliers 0.005 --columns 52 --rows 52 --encoding binary --seed 4
scan plate plate_scan.ply --noise 0.005 --elevation 50 --columns 48 --rows 48 --encoding binary --seed 5
scan wavy_sheet wavy_sheet_organised.pcd --organised --views 1 --elevation 60 --noise 0.008 --columns 120 --rows 90 --encoding binary_compressed --seed 6
scan two_density_sphere two_density_scan.pcd --noise 0.006 --dropout 0.8 --columns 52 --rows 52 --encoding binary_compressed --seed 7
"$bin/virtual_scanner" sample torus torus_isotropic.pcd --points 8000 --noise 0.5 --encoding binary --seed 8 --force
