#!/usr/bin/env bash
# before_after.sh [BIN [SCANS]]: three development shapes and three real scans before and after `rfsmooth denoise IN OUT`, one picture each in
# clouds/pictures/before_after. The shapes come from CGAL's data archive (Debian: libcgal-demo), sampled at 50,000 points with isotropic noise;
# the scans, of PCL's test data, from the folder SCANS (default: the environment variable RFSMOOTH_SCANS). What is absent is left out.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
bin=$(realpath "${1:-$here/../build/release/bin}")
scans=${2:-${RFSMOOTH_SCANS:-}}
pictures=$here/pictures/before_after
archive=$(dpkg -L libcgal-demo libcgal-dev 2> /dev/null | grep '/data\.tar\.gz$' | head -n 1)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$pictures"

picture() { # NAME CLOUD LABEL [options of rfsmooth render]: both clouds from the same place, small in bytes
  local name=$1 cloud=$2 label=$3 out="$work/$1_out.${2##*.}"
  shift 3
  "$bin/rfsmooth" denoise "$cloud" "$out" --force --quiet
  "$bin/rfsmooth" render "$cloud" "$out" -o "$pictures/$name.png" --width 360 --height 300 --levels 24 --labels "$label,after" --force --quiet "$@"
  echo "  $pictures/$name.png"
}
shape() { # NAME NOISE [options of rfsmooth render]: a mesh of the archive
  local name=$1 noise=$2
  shift 2
  tar -xzf "$archive" -C "$work" --strip-components=2 "data/meshes/$name.off" || return 0
  "$bin/virtual_scanner" sample "$work/$name.off" "$work/$name.ply" --points 50000 --noise "$noise" --encoding binary --seed 9 > /dev/null
  picture "$name" "$work/$name.ply" "noise of $noise spacings" "$@"
}
scan() { # NAME FILE [options of rfsmooth render]
  local name=$1 file=$2
  shift 2
  if [ -e "$file" ]; then picture "$name" "$file" before "$@"; else echo "  no $file: left out"; fi
}

shape anchor_dense 0.7 --direction -1,-0.6,-0.8
shape armadillo 0.7 --direction -0.3,-0.2,1 --up 0,1,0
shape ChineseDragon-10kv 0.7 --direction -0.3,-0.2,-1 --up 0,1,0
scan boxes "$scans/mOSD_learn0.pcd" --direction 0.1,0.3,1 --up 0,-1,0 --zoom 0.5,0.62,2.4
scan milk_carton "$scans/milk_cartoon_all_small_clorox.pcd" --direction 0.15,0.25,1 --up 0,-1,0 --zoom 0.54,0.72,2.6
scan table_scene "$scans/table_scene_mug_stereo_textured.pcd" --direction 0.15,0.25,1 --up 0,-1,0 --zoom 0.57,0.78,2.8
