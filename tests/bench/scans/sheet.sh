#!/usr/bin/env bash
# Pictures of the clouds that `scans --write FOLDER` wrote: before, ours and MLS side by side, FOLDER/NAME.png each.
# Usage: sheet.sh FOLDER [RENDER_CLOUD]
set -euo pipefail
folder=$1 render=${2:-build/bench/bin/render_cloud}
for raw in "$folder"/*_raw.ply; do
  name=${raw%_raw.ply}
  "$render" "$raw" "${name}_ours.ply" "${name}_mls.ply" --label raw --label rfsmooth --label "MLS k 48" --neighbors 5 -o "$name.png" --force
done
