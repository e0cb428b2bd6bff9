#!/usr/bin/env bash
# gallery.sh [BIN]: every flow of the registry on one noisy cloud: a picture each in clouds/pictures/flows, the page clouds/gallery.md, and
# the table of flows in docs/FLOWS.md. BIN holds rfsmooth, rfsmooth-render and virtual_scanner. A flow that is added needs no line here.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
bin=$(realpath "${1:-$here/../build/release/bin}")
pictures=$here/pictures/flows
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$pictures"

look=(--width 360 --height 270 --force --quiet)
number() { sed -n "s/.*\"$2\": \\([-0-9.e]*\\),*/\\1/p" "$1" | head -n 1; }
distance() { # of CLOUD to the true surface: root mean square, and how much the volume changed in percent
  "$bin/rfsmooth" compare "$1" "$work/truth.ply" --json > "$work/compare.json"
  rms=$(number "$work/compare.json" p2s_root)
  volume=$(awk -v s="$(number "$work/compare.json" shrinkage)" 'BEGIN { printf "%+.1f", 100 * s }')
}

"$bin/virtual_scanner" truth l_part "$work/truth.ply" > /dev/null
"$bin/virtual_scanner" sample l_part "$work/noisy.ply" --points 12000 --noise 0.5 --encoding binary --seed 9 > /dev/null
"$bin/rfsmooth" render "$work/noisy.ply" -o "$pictures/noisy.png" "${look[@]}"
distance "$work/noisy.ply"
noise=$rms

cells=("![the noisy cloud](pictures/flows/noisy.png)<br>**the noisy cloud**<br>volume $volume %")
"$bin/rfsmooth" flows --markdown > "$work/table.md"
while read -r flow summary; do
  if "$bin/rfsmooth" denoise --flow "$flow" "$work/noisy.ply" -o "$work/out.ply" --force --quiet 2> "$work/error"; then
    "$bin/rfsmooth" render "$work/out.ply" -o "$pictures/$flow.png" "${look[@]}"
    distance "$work/out.ply"
    left=$(awk -v a="$rms" -v b="$noise" 'BEGIN { printf "%.0f", 100 * a / b }')
    cells+=("![$flow](pictures/flows/$flow.png)<br>**$flow**: $summary<br>leaves $left % of the error, volume $volume %")
  else
    cells+=("**$flow**: $summary<br>refuses this cloud: $(sed 's/^rfsmooth: error: [^ ]* //' "$work/error" | head -n 1)")
  fi
  echo "  $flow"
done < <(sed -n 's/^| `\([^`]*\)` | \([^|]*\) |.*/\1 \2/p' "$work/table.md")

{
  echo "# Every flow on one noisy cloud"
  echo
  echo "An L-shaped part of 12,000 points with isotropic noise of half a spacing, smoothed by \`rfsmooth denoise --flow NAME IN OUT\` with each flow's"
  echo "defaults. *Error* is the root mean square distance to the true surface, beside the noisy cloud's; *volume* the mean signed distance times the"
  echo "area, over the true volume. Look at the flat parts, the sharp edges and the inner corner. Made by \`bash clouds/gallery.sh\` from the registry."
  echo
  echo "| | | |"
  echo "|---|---|---|"
  for ((i = 0; i < ${#cells[@]}; i += 3)); do
    echo "| ${cells[i]} | ${cells[i + 1]:-} | ${cells[i + 2]:-} |"
  done
} > "$here/gallery.md"

awk -v table="$work/table.md" '
  /^<!-- flows -->/ { print; while ((getline line < table) > 0) print line; skip = 1; next }
  /^<!-- end of flows -->/ { skip = 0 }
  !skip { print }' "$here/../docs/FLOWS.md" > "$work/FLOWS.md"
cat "$work/FLOWS.md" > "$here/../docs/FLOWS.md"
echo "clouds/gallery.md"
