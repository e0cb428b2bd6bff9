/// Which of several predictions of a height to believe, at every point: an average of all of them with
/// weights
///
///     w_s(i) ~ pi_s exp(E_s(i))
///
/// E_s(i) is the evidence for scale s at point i, cumulative over the comparisons that lead to it
/// (automatic.h), pi_s the share of the cloud that scale s serves best, found from the weights themselves by
/// expectation maximisation (Dempster, Laird and Rubin 1977) from equal shares. Evidence from a single
/// neighbourhood is mostly chance: on a smooth shape one place in ten looks as if it had detail. The rest of
/// the cloud tells which: without the shares a tenth of a noisy torus keeps half of its noise.
/// One thread at a time for each object.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

namespace rfsmooth::smoothing {

/// Mean square error of averaged heights, at most the noise of every point, world units squared.
///
/// A prediction that averages twice as many points keeps half of the variance, whoever shares the noise, and
/// differs from the one before by somewhat less than that; shape that it does not follow comes to it. So two
/// scales tell what the wider one has left. Only of the data and of the narrowest patches, before which there
/// is none, the noise says it.
struct Left {
  double own = 0;    ///< of the data and the narrowest patches: own times the variance of the noise
  double wider = 0;  ///< of all wider ones: told by what they differ by from the one before
};

/// Candidate heights, mixed by their evidence.
class Mixture {
 public:
  /// \param first n: the first candidate, the data or what stands for them: all its own, with evidence 0.
  explicit Mixture(std::vector<float> first);

  /// A further candidate, of at most 15. \param height n, own n: what it says, and of that the share that is
  /// the point's own noise. \param gain n: its evidence over the candidate before it, nats; NaN: no
  /// prediction here (the evidence stays for the next). \throw std::length_error.
  void add(std::vector<float> height, std::vector<float> own, std::vector<float> gain,
           const Context& context);

  /// Replaces `height` and `own` (n) by the averages; the mixture is used up. O(n) times the number of
  /// candidates; parallel, the same bits for any number of threads. \param shares pi_s, taken if there is one
  /// for each candidate, else found and entered. \param say n: how much each point counts for the shares.
  /// \param sigma n: the noise, world units. \return what the averages are off by.
  Left average(std::vector<float>& height, std::vector<float>& own, std::vector<double>& shares,
               const std::vector<float>& say, const std::vector<double>& sigma, const Context& context);

 private:
  struct Candidate {
    std::vector<float> height, own, evidence;  ///< n; evidence -inf: no prediction
  };
  std::vector<float> evidence_;  ///< n: of the last candidate
  std::vector<Candidate> candidates_;
};

}  // namespace rfsmooth::smoothing
