/// What several stages mean by "around a point", "the same sheet", "noise" and "a whole cloud": one number
/// each.
#pragma once

#include <cstddef>

namespace rfsmooth::rfs_mesh {

/// Neighbours that show what is around a point, as its plane, its normal or its side: about two and a half
/// rings of a surface mesh.
constexpr std::size_t kNeighbourhood = 24;

/// Nearest neighbours that are the ring around a point: how dense it is there, and on which side.
constexpr std::size_t kRing = 8;

/// Points that a quadric is fitted to at least: two more than its six coefficients.
constexpr std::size_t kFewestOfQuadric = 8;

/// Points of the narrowest patches: a quadric through them leaves more than half of the noise.
constexpr std::size_t kNarrowestPatch = 16;

/// Cosine of the angle between two normals, 60 degrees, beyond which they are of different sheets, or of two
/// sides of an edge.
constexpr double kSameSheet = 0.5;

/// Standard deviations within which points show the noise: what is beyond may be something else.
constexpr double kScatterWindow = 3;

/// Standard deviations that noise carries a point: a normal variable goes beyond in one case of 16,000.
constexpr double kNoiseReach = 4;

/// Standard deviations beyond which a point is a stray and does not belong to the surface.
constexpr double kStray = 5;

/// Of the distance to the farthest neighbour, or of its square: as far as weights (1 - d^2 / r^2)^2 reach, so
/// that it keeps a little.
constexpr double kBeyond = 1.1;

/// The same of its square, half as far beyond: where the farthest of a few neighbours shall count for less.
constexpr double kJustBeyond = (1 + kBeyond) / 2;

/// The most sigma over radius of a ball of neighbours that holds the slab of noisy points, and is not inside
/// of it: a radius of 5.5 sigma.
constexpr double kFlatSlab = 0.18;

/// The most of a ball that tells anything of a slab: in a narrower one any quadric lies within it.
constexpr double kThickSlab = 2 * kFlatSlab;

/// Times: by so much at most grows what is seen of noise, from m to 2 m points: it does where the ball of
/// them is inside a slab of noisy points, as the radius does. The cube root of 2; faster growth is shape.
constexpr double kGrowthOfNoise = 1.26;

/// Most points of a fit: the blotches of depth cameras are that large, and where noise is six times the side
/// of the square that has one point, its slab is flat in no smaller ball.
constexpr std::size_t kWidestFit = 4096;

/// Of the places or of their area: less does not stand for all of them.
constexpr double kLeastPart = 0.1;

/// Points that stand for all of a cloud in a mean or a median over it, which they give to half a per cent:
/// a bound of the work.
constexpr std::size_t kSampleOfCloud = 50000;

/// Places of a cloud at which something costly is measured for a median.
constexpr std::size_t kPlacesOfCloud = 1000;

}  // namespace rfsmooth::rfs_mesh
