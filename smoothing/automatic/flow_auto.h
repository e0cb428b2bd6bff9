/// The automatic smoother on a mesh: measures the noise, smooths as strongly as it asks for at every point
/// (automatic.h), evens the points out along the surface (equalize.h), or, where neighbours share their
/// noise all over the cloud, puts them back to where they were along it (slide_back.h).
///
/// Where a cloud has parts (rfs_mesh/noise/parts.h), all of this is done with each part by itself.
///
/// How far a point may move in a step: at most kNoiseReach (levels.h) times the noise around it, measured or
/// stated; strength times that where the strength is above one, and AutomaticFindings::tail_times that where
/// some points are much noisier than the others. Strays, which would go farther still (automatic.h), stay.
#pragma once

#include <memory>
#include <optional>

#include <rfsmooth/flow.h>

#include "smoothing/automatic/automatic.h"

namespace rfsmooth::smoothing {

/// The noise of the cloud as far as it can be told from shape, world units: its figure, or 0. Where most of
/// the scatter is shape, noise of less than detail() cannot be told from it either: better leave a clean
/// cloud alone, unless a part of it is clearly louder than that. The loudest tenth is of the sites, not of
/// the points as in `summary_of`: the sites are those of the whole cloud in each of its tiles, too, so that
/// all tiles decide alike. O(sites).
double told_noise(const rfs_mesh::NoiseField& noise);

/// The measured noise in a few figures. O(n).
NoiseSummary summary_of(const rfs_mesh::NoiseField& noise);

/// Whether anybody will read more of the mesh than its positions; if not, its faces and rings are used up,
/// which saves memory.
enum class Connectivity { kept, used_up };

/// One step: moves mesh.positions. What was measured and chosen; nothing for fewer than two points, which
/// stay. `options.iterations` is the caller's loop. `statistics`: what is there is taken, the rest entered.
/// `of_all`: the noise of the cloud that the mesh is a part of; null: it is all.
/// O(n log n), about 350 bytes a point. Parallel, the same bits for any number of threads. Thread safe on
/// distinct meshes.
std::optional<AutomaticFindings> smooth_automatically(Mesh& mesh, const AutomaticOptions& options,
                                                      const Context& context,
                                                      Connectivity connectivity = Connectivity::kept,
                                                      Statistics* statistics = nullptr,
                                                      LearnedInput* for_training = nullptr,
                                                      const NoiseModel* of_all = nullptr);

/// The same as the steps of a flow, for modifiers and constraints to go around. Each step writes `found`,
/// the first one alone takes and enters `statistics`; both must outlive the flow.
std::unique_ptr<Flow> make_automatic(const AutomaticOptions& options, std::optional<AutomaticFindings>& found,
                                     Statistics& statistics);

}  // namespace rfsmooth::smoothing
