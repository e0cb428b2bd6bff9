#!/usr/bin/env bash
# The main job on two noisy clouds, from nothing: installs what the command needs, builds it, cleans a torus with known noise and a
# piece of a building as a laser saw it, and makes of each a picture and a page of before and after: bash clouds/demo.sh
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/packages.sh
install_missing $core_packages

cmake --preset release > /dev/null
cmake --build --preset release --target rfsmooth_command rfsmooth_render_program
bin=build/release/bin
out=clouds/out
mkdir -p "$out"

for cloud in clouds/torus_isotropic.pcd clouds/scans/laser_building.pcd; do
  name=$(basename "$cloud" .pcd)
  "$bin/rfsmooth" denoise "$cloud" -o "$out/${name}_clean.pcd" --force --report "$out/${name}_report.json" --html "$out/$name.html"
  "$bin/rfsmooth" render "$cloud" "$out/${name}_clean.pcd" -o "$out/$name.png" --labels before,after --title "$name" --without-outliers --force --quiet
  echo "  see $out/$name.html in a browser, $out/$name.png, and the cloud $out/${name}_clean.pcd"
done
