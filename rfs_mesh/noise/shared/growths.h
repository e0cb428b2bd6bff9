/// How the scatter about a quadric grows with its points m, and what that tells: noise that neighbours share,
/// bumps, or ground.
///
/// All of them grow at first. Noise stops where the neighbourhood is wider than it reaches. Bumps grow at
/// least 2.38 times from m to 2 m (kLeastGrowthOfShape), and have a size, too, beyond which they do not grow.
/// Ground, hills upon hills, has no size, never stops growing, and no other shape overtakes it.
#pragma once

#include <cstddef>

namespace rfsmooth::rfs_mesh {

/// The growths of the variance from each m to 2 m, entered one after the other.
class Growths {
 public:
  /// \param terraces whether calm points scatter no farther than steps of their depths (shared_noise.h). A
  /// neighbourhood within one step sees nothing of it, so that all growths from the first slow one on count,
  /// and ground in steps is not told from noise
  explicit Growths(bool terraces) : terraces_(terraces) {}

  /// Returns whether other shape overtakes what counted until then. \param own the variance that points have
  /// of their own, about
  bool enter(double at_m, double at_2m, double own);

  /// Whether the last growth is one of noise.
  bool counts() const { return counts_; }
  /// Whether they are those of ground, told by two m or more of which less than half is of points on their
  /// own.
  bool of_ground() const;

 private:
  /// Whether scatter that grew as shape does has stopped: one slow growth may be the end of a bump, so it is
  /// the second in a row that tells, and only one that is slower than those of ground begins.
  bool has_stopped(double growth) const;
  /// Ground doubles and more at first, and never grows less than 1.41 times later. \param growth of what is
  /// not the points' own
  void enter_ground(double growth);

  bool terraces_, counts_ = false, fast_ = false, stopped_ = false, overtaken_ = false;
  std::size_t slow_ = 0;   ///< growths in a row that noise may have
  std::size_t hills_ = 0;  ///< growths that ground was looked for in
};

}  // namespace rfsmooth::rfs_mesh
