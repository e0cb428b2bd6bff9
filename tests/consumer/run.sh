#!/usr/bin/env bash
# run.sh SOURCE WORK WAY [BUILD]: builds and runs the examples in the folder WORK the way a user of the library would.
# WAY: installed (find_package), subdirectory (add_subdirectory), pkgconfig; pcl, cgal (find_package with that component).
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

# build EXAMPLE OPTION...: configures and builds tests/consumer/EXAMPLE; the program is $work/build/example.
build() {
  local example=$1
  shift
  cmake -G Ninja -S "$source/tests/consumer/$example" -B "$work/build" -DCMAKE_BUILD_TYPE=Release \
    ${launcher:+-DCMAKE_CXX_COMPILER_LAUNCHER=$launcher} "${from[@]}" "$@" > "$work/configure.log"
  cmake --build "$work/build" > "$work/build.log" || { cat "$work/build.log"; exit 1; }
}

case "$way" in
  installed)
    build core
    "$work/build/example" ;;
  subdirectory)
    build core -DRFSMOOTH_SOURCE_DIR="$source" -DRFSMOOTH_BUILD_CLI=OFF -DRFSMOOTH_WITH_PCL=OFF -DRFSMOOTH_WITH_OPEN3D=OFF -DRFSMOOTH_WITH_CGAL=OFF
    "$work/build/example" ;;
  pkgconfig)
    g++ -std=c++17 -O2 "$source/tests/consumer/core/example.cpp" -o "$work/example" $(pkg-config --cflags --libs rfsmooth)
    "$work/example" ;;
  pcl)
    build pcl
    {
      printf 'VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2500\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2500\nDATA ascii\n'
      awk 'BEGIN { for (i = 0; i < 2500; ++i) print i % 50, int(i / 50), 0.4 * sin(12.9898 * i) }'
    } > "$work/rough.pcd"
    "$work/build/example" "$work/rough.pcd" "$work/cleaned.pcd" 2> /dev/null
    test -s "$work/cleaned.pcd" ;;
  cgal)
    build cgal
    "$work/build/example" ;;
  *) echo "no such way: $way"; exit 2 ;;
esac
