/// The working mesh of a mesh file, and its way back into the file.
#pragma once

#include <string>
#include <vector>

#include <rfsmooth/mesh.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::cli {

/// The mesh over the finite vertices, around a local origin.
struct FileMesh {
  Mesh mesh;
  Positions before;                                  ///< positions of its vertices at the start
  std::vector<Index> of_row;                         ///< the vertex of each row; kNone if not finite
  std::vector<double> xyz;                           ///< n x 3: the original coordinates of the rows
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< file = origin + vertex

  /// The coordinates of the rows with the moves of the vertices added; `any`: whether one moved. A coordinate
  /// that did not move keeps its bits.
  std::vector<double> moved_rows(bool& any) const;
};

/// Makes the mesh. With `own_heights` the origin lies in the file's plane z = 0, for flows that measure
/// heights above it. \param name of the file, for a warning. \throw Failure if the file has no faces, no
/// finite vertex, or a face with a point that does not exist.
FileMesh file_mesh(const pipeline::io::Cloud& cloud, const std::string& name, const Context& context,
                   bool own_heights);

/// What `put_refined` drops of the cloud, in words: fields, elements, comments.
std::vector<std::string> lost_in_refined(const pipeline::io::Cloud& cloud);

/// Replaces the cloud by a refined mesh: first its rows, at `rows`, then the new vertices of `fine`, whose
/// first vertices are those of `file`. Other fields, elements and comments are dropped.
void put_refined(pipeline::io::Cloud& cloud, const FileMesh& file, const std::vector<double>& rows,
                 const Mesh& fine);

}  // namespace rfsmooth::cli
