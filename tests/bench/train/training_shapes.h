/// Shapes to learn from, every one different: chairs, ribbed castings, open boxes, blocks with fillets,
/// chamfers and holes, rods, sheet metal with fins, bodies with limbs, wheels, bowls and lumps; half of them
/// bent and twisted.
#pragma once

#include <cstdint>
#include <string>

#include <rfsmooth/mesh.h>

namespace rfsmooth::bench {

struct TrainingShape {
  std::string kind;
  Mesh mesh;  ///< closed; about 1 in size
};

/// Same number, same bytes. Kinds follow each other.
TrainingShape make_training_shape(std::uint64_t number);

}  // namespace rfsmooth::bench
