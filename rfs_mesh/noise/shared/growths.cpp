#include "rfs_mesh/noise/shared/growths.h"

#include "rfs_mesh/noise/shared/signs_of_sharing.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kInARow = 2;  // the least that is a row
// Of the variance, from m to 2 m: noise that no other shape overtakes grows slower than m.
constexpr double kMostGrowthOfNoise = 2;
// The same of ground, whose roughness has no scale of its own: 2^H, H from 0.5 on (Mandelbrot 1982).
constexpr double kLeastGrowthOfGround = 1.414;
constexpr double kMostlyOwn = 0.5;  // of a variance

}  // namespace

bool Growths::enter(double at_m, double at_2m, double own) {
  const double growth = at_2m / at_m;
  const bool slow = !(growth > kLeastGrowthOfShape), overtakes = !slow && counts_;
  slow_ = slow ? slow_ + 1 : 0;
  if (own < kMostlyOwn * at_m) enter_ground((at_2m - own) / (at_m - own));
  overtaken_ = overtaken_ || overtakes;
  fast_ = fast_ || !slow;
  counts_ = terraces_ ? counts_ || slow : slow && (!fast_ || has_stopped(growth));
  return overtakes;
}

bool Growths::of_ground() const {
  return !terraces_ && hills_ >= kInARow && !stopped_ && !overtaken_;
}

bool Growths::has_stopped(double growth) const {
  return slow_ >= kInARow && (counts_ || growth < kLeastGrowthOfGround);
}

void Growths::enter_ground(double growth) {
  stopped_ = stopped_ || growth < (hills_ == 0 ? kMostGrowthOfNoise : kLeastGrowthOfGround);
  ++hills_;
}

}  // namespace rfsmooth::rfs_mesh
