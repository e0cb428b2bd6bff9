#!/usr/bin/env bash
# Pictures of the clouds that `scans --write FOLDER` wrote: before, ours and MLS side by side, FOLDER/NAME.png each.
# Usage: sheet.sh FOLDER [RFSMOOTH]
set -euo pipefail
folder=$1 rfsmooth=${2:-build/bench/bin/rfsmooth}
for raw in "$folder"/*_raw.ply; do
  name=${raw%_raw.ply}
  "$rfsmooth" render "$raw" "${name}_ours.ply" "${name}_mls.ply" --labels "raw,rfsmooth,MLS k 48" --neighbors 5 -o "$name.png" --force --quiet
done
