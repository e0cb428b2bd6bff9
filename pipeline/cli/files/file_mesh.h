/// The working mesh of a mesh file, and what comes back from it.
#pragma once

#include <string>
#include <vector>

#include <rfsmooth/mesh.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::cli {

/// The mesh over the finite vertices, around a local origin.
struct FileMesh {
  Mesh mesh;
  Positions before;                                  ///< where its vertices were at the start
  std::vector<Index> of_row;                         ///< kNone for vertices that are not finite
  std::vector<double> xyz;                           ///< the rows, n x 3, as they were
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< file = origin + vertex

  /// The rows with every vertex's move added; a coordinate that did not move keeps its bits.
  std::vector<double> moved_rows(bool& any) const;
};

/// \throw Failure naming the file: it has no faces, no finite vertex, or a face names a point that is not
/// there. With `own_heights` the origin lies in the file's plane z = 0, for what is measured from there.
FileMesh file_mesh(const pipeline::io::Cloud& cloud, const std::string& name, const Context& context,
                   bool own_heights = false);

/// A refined mesh in place of the cloud: its rows first (at `rows`), then the new vertices of `fine`, whose
/// first vertices are those of `file`. Other fields and elements go.
void put_refined(pipeline::io::Cloud& cloud, const FileMesh& file, const std::vector<double>& rows,
                 const Mesh& fine);

}  // namespace rfsmooth::cli
