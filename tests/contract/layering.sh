#!/usr/bin/env bash
# layering.sh ROOT: fails, naming file and line, where an include points upward, a heavy header leaves its place, a header
# has no #pragma once or the library prints.
set -uo pipefail
cd "$1"
wrong=0

# forbid WHAT PATTERN PATH...: no #include matching PATTERN (extended regex) in the files under PATH.
forbid() {
  local what=$1 pattern=$2
  shift 2
  local hits
  hits=$(grep -rnE --include='*.h' --include='*.hpp' --include='*.cpp' "^ *# *include *[<\"]($pattern)" "$@" 2>/dev/null)
  [ -z "$hits" ] && return
  wrong=1
  printf '%s:\n%s\n' "$what" "$hits"
}

# find_except DIR SUBDIR...: the files of DIR outside the SUBDIRs.
find_except() {
  local dir=$1
  shift
  local skip=()
  for d in "$@"; do skip+=(-not -path "$dir/$d/*"); done
  find "$dir" -type f \( -name '*.h' -o -name '*.hpp' -o -name '*.cpp' \) "${skip[@]}"
}

forbid "rfs_mesh knows nothing above it" 'rfsmooth/(smoothing|pipeline|pcl|open3d|cgal)/' rfs_mesh
forbid "smoothing knows only rfs_mesh" 'rfsmooth/(pipeline|pcl|open3d|cgal)/' smoothing
forbid "the library does not know its sample clouds" 'rfsmooth/clouds/' rfs_mesh smoothing pipeline
forbid "PCL, Open3D and CGAL stay in their adapters" '(pcl|open3d|CGAL)/' rfs_mesh smoothing $(find_except pipeline pcl open3d cgal)
forbid "each adapter sees its own library" '(open3d|CGAL)/' pipeline/pcl
forbid "each adapter sees its own library" '(pcl|CGAL)/' pipeline/open3d
forbid "each adapter sees its own library" '(pcl|open3d)/' pipeline/cgal
forbid "TBB is seen by parallel.cpp only" '(tbb|oneapi)/' $(find_except rfs_mesh | grep -v '^rfs_mesh/parallel.cpp$') smoothing pipeline
forbid "public headers include std and Eigen/Core only" '(Eigen/(Dense|Sparse|Eigen)|fmt|nlohmann|CLI|flann|tbb)' \
  $(find rfs_mesh smoothing pipeline/*.h pipeline/io -name '*.h')
once=$(find rfs_mesh smoothing pipeline clouds tests \( -name '*.h' -o -name '*.hpp' \) -exec grep -L '^#pragma once' {} +)
if [ -n "$once" ]; then
  wrong=1
  printf 'every header may be included twice:\n%s\n' "$once"
fi
hits=$(grep -rnE '(std::cout|std::cerr|[^fs]printf\(|fmt::print\()' rfs_mesh smoothing $(find_except pipeline cli pcl open3d cgal) 2>/dev/null)
if [ -n "$hits" ]; then
  wrong=1
  printf 'the library prints nothing:\n%s\n' "$hits"
fi

[ "$wrong" -eq 0 ] && echo "arrows point downward"
exit "$wrong"
