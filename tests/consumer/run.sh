#!/usr/bin/env bash
# run.sh SOURCE WORK WAY [BUILD]: builds and runs the examples in the folder WORK the way a user of the library would.
# WAY: installed (find_package), subdirectory (add_subdirectory), pkgconfig; pcl, open3d, cgal (find_package with that
# component); readme (the README's PCL example, copied out of it into an empty folder).
# What the build folder BUILD installs is used; without BUILD what is installed in the system.
set -euo pipefail
source=$1 work=$2 way=$3 build=${4:-}
launcher=$(command -v ccache || true)
rm -rf "$work"
mkdir -p "$work"
from=()
if [ -n "$build" ] && [ "$way" != subdirectory ]; then
  cmake --install "$build" --prefix "$work/prefix" > "$work/install.log"
  from=(-DCMAKE_PREFIX_PATH="$work/prefix")
  export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig:$(echo "$work"/prefix/lib/*/pkgconfig)"
fi

# build PROJECT OPTION...: configures and builds the project in a folder; the programs are in $work/build.
build() {
  local project=$1
  shift
  cmake -G Ninja -S "$project" -B "$work/build" -DCMAKE_BUILD_TYPE=Release \
    ${launcher:+-DCMAKE_CXX_COMPILER_LAUNCHER=$launcher} "${from[@]}" "$@" > "$work/configure.log" 2>&1 || { cat "$work/configure.log"; exit 1; }
  cmake --build "$work/build" > "$work/build.log" || { cat "$work/build.log"; exit 1; }
}

# scan PCD [POINTS]: a unit sphere of 20,000 points, or so many, with noise of half a spacing of 20,000.
scan() {
  local n=${2:-20000}
  printf 'VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH %d\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA ascii\n' "$n" "$n" > "$1"
  awk -v n="$n" 'BEGIN { srand(7)
    for (i = 0; i < n; ++i) {
      z = 1 - (2 * i + 1) / n; r = sqrt(1 - z * z); t = 2.399963 * i; s = 1 + 0.04 * (rand() - 0.5)
      print s * r * cos(t), s * r * sin(t), s * z } }' >> "$1"
}

# smooth FILE: fails unless the points of an ascii file (lines of three numbers) lie twice as close to the sphere as the
# scan's, whose rms error is 0.0115.
smooth() {
  awk 'NF == 3 && $1 ~ /^-?[0-9]/ { e = sqrt($1 * $1 + $2 * $2 + $3 * $3) - 1; sum += e * e; ++n }
    END { rms = sqrt(sum / n); print FILENAME ": " n " points, rms error " rms; exit !(n > 1000 && rms < 0.0058) }' "$1"
}

# written_in README FILE: the lines of the indented block after the mark of that name.
written_in() {
  awk -v mark="<!-- $2 -->" '$0 == mark { on = 1; next } on && /^ *$/ { print ""; next } on && !/^    / { exit } on { print substr($0, 5) }' "$1"
}

examples="$source/examples"
case "$way" in
  installed)
    build "$examples/core"
    "$work/build/example" ;;
  subdirectory)
    # Less optimised than a user's, and several sources as one: the whole library is compiled again here. That each source is
    # complete by itself, contract.alone shows.
    build "$source/tests/consumer/subdirectory" -DCMAKE_CXX_FLAGS_RELEASE="-O0 -DNDEBUG" -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=14 \
      -DRFSMOOTH_SOURCE_DIR="$source" -DRFSMOOTH_BUILD_CLI=OFF -DRFSMOOTH_WITH_CGAL=OFF
    "$work/build/example"
    scan "$work/scan.pcd" 2000  # which takes each program 9 s instead of 20, unoptimised as it is
    if [ -x "$work/build/pcl_example" ]; then
      "$work/build/pcl_example" "$work/scan.pcd" "$work/pcl.pcd"
      smooth "$work/pcl.pcd"
    fi
    if [ -x "$work/build/open3d_example" ]; then
      "$work/build/open3d_example" "$work/scan.pcd" "$work/open3d.xyz"
      smooth "$work/open3d.xyz"
    fi ;;
  pkgconfig)
    g++ -std=c++17 -O2 "$examples/core/example.cpp" -o "$work/example" $(pkg-config --cflags --libs rfsmooth)
    "$work/example" ;;
  pcl)
    build "$examples/pcl"
    scan "$work/scan.pcd"
    "$work/build/example" "$work/scan.pcd" "$work/cleaned.pcd"
    smooth "$work/cleaned.pcd"
    "$work/build/pipeline" "$work/scan.pcd" "$work/surface.ply"
    smooth "$work/surface.ply" ;;
  open3d)
    build "$examples/open3d"
    scan "$work/scan.pcd"
    "$work/build/example" "$work/scan.pcd" "$work/cleaned.xyz"
    smooth "$work/cleaned.xyz" ;;
  cgal)
    build "$examples/cgal"
    "$work/build/example" ;;
  readme)
    mkdir "$work/project"
    for file in CMakeLists.txt cleanup.cpp; do written_in "$source/README.md" "$file" > "$work/project/$file"; done
    build "$work/project"
    scan "$work/in.pcd"
    "$work/build/cleanup" "$work/in.pcd" "$work/out.pcd"
    smooth "$work/out.pcd" ;;
  *) echo "no such way: $way"; exit 2 ;;
esac
