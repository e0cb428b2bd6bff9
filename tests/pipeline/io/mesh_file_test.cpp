#include "pipeline/io/mesh_file.h"

#include <gtest/gtest.h>

#include "pipeline/io/io.h"

using namespace rfsmooth;
using namespace rfsmooth::pipeline::io;
using rfsmooth::Edge;
using rfsmooth::Face;

namespace {

const Positions kPoints = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}, {5, 5, 5}};
const std::vector<Face> kFaces = {{0, 1, 2}, {0, 2, 3}};
const std::vector<Edge> kEdges = {{2, 4}, {3, 4}};

Cloud parsed_mesh_file(const std::string& text) {
  return parse_cloud(text, "test", {}, {}).value();
}

TEST(MeshFile, WhatIsWrittenReadsBackInEveryEncoding) {
  for (const Encoding encoding :
       {Encoding::ascii, Encoding::binary_little_endian, Encoding::binary_big_endian}) {
    const Cloud cloud = make_mesh_file(kPoints, kFaces, kEdges, {1, 0});
    WriteOptions options;
    options.encoding = encoding;
    const Cloud back = parsed_mesh_file(serialize_cloud(cloud, options, {}).value());
    const std::vector<double> xyz = positions(back);
    ASSERT_EQ(xyz.size(), 3 * kPoints.size());
    for (std::size_t i = 0; i < xyz.size(); ++i) EXPECT_EQ(xyz[i], kPoints[i / 3][Eigen::Index(i % 3)]);
    EXPECT_EQ(faces_of(back), kFaces);
    EXPECT_EQ(edges_of(back), kEdges);
    const Table& edges = *back.element("edge");
    EXPECT_EQ(gather(edges, {2}, {}), (std::vector<double>{1, 0})) << "what kind each edge is";
  }
}

TEST(MeshFile, PolygonsBecomeFansAndOtherPropertiesAreSkipped) {
  const Cloud cloud = parsed_mesh_file(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 3\nproperty uchar red\nproperty list uchar int vertex_indices\nproperty float "
      "area\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n"
      "7 4 0 1 2 3 0.5\n7 2 0 1 0.5\n7 3 4 1 0 0.5\n");
  EXPECT_EQ(faces_of(cloud), (std::vector<Face>{{0, 1, 2}, {0, 2, 3}, {4, 1, 0}}));
  EXPECT_TRUE(edges_of(cloud).empty());
}

TEST(MeshFile, ACloudHasNeither) {
  const Cloud cloud = make_cloud(kPoints.front().data(), kPoints.size());
  EXPECT_TRUE(faces_of(cloud).empty());
  EXPECT_TRUE(edges_of(cloud).empty());
}

TEST(MeshFile, MissingCornersAreNamed) {
  for (const char* bad : {"3 0 1 3", "3 0 -1 2"}) {
    const Cloud cloud = parsed_mesh_file(
        std::string(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n1 1 0\n") +
        bad + "\n");
    try {
      faces_of(cloud);
      FAIL() << bad;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.error.code, ErrorCode::input_unreadable);
      EXPECT_NE(failure.error.message.find("face 0"), std::string::npos) << failure.error.message;
    }
  }
}

}  // namespace
