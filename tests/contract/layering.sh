#!/usr/bin/env bash
# layering.sh ROOT: fails, naming file and line, where an include names no file of the tree, points upward or brings a heavy
# header out of its place, a header has no #pragma once, a room has too many files or the library prints.
set -uo pipefail
cd "$1"
wrong=0
rooms="include base rfs_mesh smoothing pipeline clouds tests examples"

# complain WHAT LINES: notes that something is wrong, if there are lines.
complain() {
  [ -z "$2" ] && return
  wrong=1
  printf '%s:\n%s\n' "$1" "$2"
}

# forbid WHAT PATTERN PATH...: no #include matching PATTERN (extended regex) in the files under PATH.
forbid() {
  local what=$1 pattern=$2
  shift 2
  complain "$what" "$(grep -rnE --include='*.h' --include='*.hpp' --include='*.cpp' "^ *# *include *[<\"]($pattern)" "$@" 2>/dev/null)"
}

# find_except DIR SUBDIR...: the files of DIR outside the SUBDIRs.
find_except() {
  local dir=$1
  shift
  local skip=()
  for d in "$@"; do skip+=(-not -path "$dir/$d/*"); done
  find "$dir" -type f \( -name '*.h' -o -name '*.hpp' -o -name '*.cpp' \) "${skip[@]}"
}

# Every "..." is a file's path from the root, every <rfsmooth/...> a public header: an editor follows them before anything is
# built.
includes=$(grep -rnoE --include='*.h' --include='*.hpp' --include='*.cpp' '^ *# *include *("[^"]+"|<rfsmooth/[^>]+>)' $rooms)
complain "includes name a file by its path from the root, or <rfsmooth/...>" "$(
  sed -E 's/^([^:]*:[0-9]*):.*"(.*)"$/\1 \2/; s/^([^:]*:[0-9]*):.*<(.*)>$/\1 include\/\2/' <<< "$includes" |
    while read -r where file; do [ -e "$file" ] || echo "$where: $file"; done)"
complain "public headers include public headers only" "$(grep -rnE '^ *# *include *"' include)"

forbid "base knows nothing above it" '(rfs_mesh|smoothing|pipeline)/|rfsmooth/(mesh|connect|flow|denoise|normals|compare|reconstruct|cloud_file)' base
forbid "rfs_mesh knows nothing above it" '(smoothing|pipeline)/|rfsmooth/(flow|denoise|normals|compare|reconstruct|cloud_file)' rfs_mesh
forbid "smoothing knows only what is below it" 'pipeline/|rfsmooth/(denoise|normals|compare|reconstruct|cloud_file)' smoothing
forbid "the library does not know its sample clouds" 'clouds/' include base rfs_mesh smoothing $(find_except pipeline cli/render)
forbid "the library does not know its tests" 'tests/' include base rfs_mesh smoothing pipeline clouds examples
forbid "PCL, Open3D and CGAL stay in their adapters" '(pcl|open3d|CGAL|rfsmooth/(pcl|open3d|cgal))/' \
  include/rfsmooth/*.h base rfs_mesh smoothing $(find_except pipeline adapters cli/reconstruct)
forbid "each adapter sees its own library" '(open3d|CGAL)/' pipeline/adapters/pcl include/rfsmooth/pcl
forbid "each adapter sees its own library" '(pcl|CGAL)/' pipeline/adapters/open3d include/rfsmooth/open3d
forbid "each adapter sees its own library" '(pcl|open3d)/' pipeline/adapters/cgal include/rfsmooth/cgal
forbid "each adapter sees its own library" '(pcl|open3d|CGAL)/' pipeline/adapters/python
forbid "nanobind stays in its adapter" 'nanobind/' include base rfs_mesh smoothing $(find_except pipeline adapters/python)
forbid "TBB is seen by parallel.cpp only" '(tbb|oneapi)/' $(find_except base | grep -v '^base/parallel.cpp$') include rfs_mesh smoothing pipeline
forbid "public headers include std and Eigen/Core only" '(Eigen/(Dense|Sparse|Eigen)|fmt|nlohmann|CLI|flann|tbb)' include
complain "every header may be included twice" \
  "$(find $rooms \( -name '*.h' -o -name '*.hpp' \) -exec grep -L '^#pragma once' {} +)"
complain "a room has at most fifteen files side by side" \
  "$(find $rooms -type f \( -name '*.h' -o -name '*.hpp' -o -name '*.cpp' \) -printf '%h\n' | sort | uniq -c | awk '$1 > 15 { print $2 ": " $1 }')"
complain "the library prints nothing" \
  "$(grep -rnE '(std::cout|std::cerr|[^fs]printf\(|fmt::print\()' include base rfs_mesh smoothing $(find_except pipeline cli adapters) 2>/dev/null)"

[ "$wrong" -eq 0 ] && echo "arrows point downward"
exit "$wrong"
