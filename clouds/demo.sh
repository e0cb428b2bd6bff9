#!/usr/bin/env bash
# The main job on two clouds, from nothing: installs what the command needs, builds it, cleans a scan of ours and a scanned
# building (CGAL's, 100,000 points), and makes pictures of before and after: bash clouds/demo.sh
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/packages.sh
install_missing $core_packages libcgal-demo

cmake --preset release > /dev/null
cmake --build --preset release --target rfsmooth_command rfsmooth_render_program
bin=build/release/bin
out=clouds/out
mkdir -p "$out"

archive=$(dpkg -L libcgal-demo libcgal-dev 2> /dev/null | grep '/data\.tar\.gz$' | head -n 1)
tar -xzf "$archive" -C "$out" --strip-components=2 --wildcards '*/points_3/building.ply'

for cloud in clouds/l_part_scan.ply "$out/building.ply"; do
  name=$(basename "$cloud" .ply)
  "$bin/rfsmooth" denoise "$cloud" -o "$out/${name}_clean.ply" --force --report "$out/${name}_report.json"
  "$bin/rfsmooth" render "$cloud" "$out/${name}_clean.ply" -o "$out/$name.png" --labels before,after --title "$name" --force --quiet
  echo "  see $out/${name}_clean.ply and $out/$name.png"
done
