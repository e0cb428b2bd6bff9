/// Files in formats that are not read are named, and it is said what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"
#include "tests/support/las_bytes.h"

using ::testing::AllOf;
using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

struct Foreign {
  const char *file, *name, *advice;
  std::string bytes;
};

class OtherFormats : public InFolder {};

TEST_F(OtherFormats, AreNamedWithWhatToDo) {
  using namespace std::string_literals;
  const std::string binary("\x00\x01\x02\xff\n\x03", 6);
  std::string laz = las_bytes(4, 6, 2).bytes();
  laz[104] = char(laz[104] | 128);
  for (const Foreign& foreign :
       {Foreign{"a.laz", "LAZ", "python -m rfsmooth denoise in.laz out.laz", laz},
        Foreign{"unnamed", "LAZ", "python -m rfsmooth denoise in.laz out.laz", laz},
        Foreign{"odd.laz", "LAZ", "laszip", binary},
        Foreign{"a.e57", "E57", "convert it to PLY", "ASTM-E57" + binary},
        Foreign{"a.obj", "OBJ", "convert it to PLY", "# Blender\nmtllib a.mtl\no Cube\nv 1 2 3\n"},
        Foreign{"object.txt", "OBJ", "convert it to PLY", "v 1 2 3\nv 1 2 4\n"},
        Foreign{"a.stl", "STL", "convert it to PLY", binary + binary},
        Foreign{"text.stl", "STL", "convert it to PLY", "solid part\nfacet normal 0 0 1\n"},
        Foreign{"a.glb", "glTF", "convert it to PLY", "glTF" + binary},
        Foreign{"a.ptx", "PTX", "convert it to PLY", "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n"},
        Foreign{"a.ply.gz", "gzip", "unpack it", "\x1f\x8b" + binary},
        Foreign{"a.zip", "ZIP", "unpack it", "PK\x03\x04" + binary},
        Foreign{"a.dat", "raw binary", "save it as text", binary},
        Foreign{"a.npy", "NumPy", "save it as text", "\x93NUMPY" + binary},
        Foreign{"a.png", "picture", "no points", "\x89PNG" + binary}}) {
    put(foreign.file, foreign.bytes);
    const Ran ran = run({"denoise", foreign.file, "out.ply"});
    EXPECT_EQ(ran.code, 3) << foreign.file;
    EXPECT_THAT(ran.err, AllOf(HasSubstr(std::string(foreign.file) + ": "), HasSubstr(foreign.name),
                               HasSubstr("is not read; "), HasSubstr(foreign.advice)));
    EXPECT_FALSE(there("out.ply"));
  }
}

TEST_F(OtherFormats, WhatIsReadIsReadWhateverItIsCalled) {
  put("cloud.las", noisy_plane(10).bytes());
  EXPECT_EQ(run({"denoise", "cloud.las", "out.ply"}).code, 0);
}

TEST_F(OtherFormats, TextColumnsAreReadFromFilesCalledAsRawBytes) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += std::to_string(i / 10) + " " + std::to_string(i % 10) + " 0\n";
  for (const std::string name : {"a.dat", "a.raw", "a.bin"}) {
    put(name, text);
    const Ran ran = run({"denoise", name, name + ".xyz"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_TRUE(there(name + ".xyz"));
  }
}

TEST_F(OtherFormats, AreNotWrittenEither) {
  put("in.ply", noisy_plane(10).bytes());
  const Ran ran = run({"denoise", "in.ply", "out.e57"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, AllOf(HasSubstr("out.e57: E57 is not written"), HasSubstr(".las")));
  const Ran laz = run({"denoise", "in.ply", "out.laz"});
  EXPECT_EQ(laz.code, 2);
  EXPECT_THAT(laz.err,
              AllOf(HasSubstr("out.laz: LAZ is not written"), HasSubstr("laspy"), HasSubstr("LAS and a")));
  EXPECT_EQ(names(), std::vector<std::string>{"in.ply"});
}

}  // namespace
}  // namespace rfsmooth::test
