#include "pipeline/cli/console/progress.h"

#include <algorithm>

namespace rfsmooth::cli {

std::vector<StageShare> connecting_stages() {
  return {{"read", 1},    {"prepare", 1},  {"index", 1},     {"neighbours", 5},
          {"noise", 3},   {"outliers", 2}, {"emst", 3},      {"local surfaces", 8},
          {"shadow", 12}, {"sdg", 6},      {"umbrellas", 7}, {"rfs-mesh", 8}};
}

std::vector<StageShare> denoising_stages(bool normals) {
  std::vector<StageShare> stages = connecting_stages();
  stages.push_back({"smooth", 80});
  if (normals) stages.push_back({"normals", 100});
  return stages;
}

void Progress::plan(std::vector<StageShare> stages) {
  stages_ = std::move(stages);
  stages_.push_back({"write", 2});
  total_ = 0;
  for (const StageShare& s : stages_) total_ += s.share;
}

void Progress::start_job(std::size_t job, std::size_t jobs) {
  job_ = job;
  jobs_ = jobs;
  stage_.clear();
  before_ = share_ = 0;
  job_start_ = Clock::now();
}

void Progress::note(std::string_view stage, double fraction) {
  fraction = std::clamp(fraction, 0.0, 1.0);
  if (stage != stage_) {
    stage_ = stage;
    stage_start_ = Clock::now();
    first_ = fraction;
    const auto at =
        std::find_if(stages_.begin(), stages_.end(), [&](const StageShare& s) { return s.stage == stage; });
    if (at != stages_.end()) {
      before_ = 0;
      for (auto s = stages_.begin(); s != at; ++s) before_ += s->share;
    } else {
      before_ += share_;
    }
    share_ = at == stages_.end() ? 0 : at->share;
  }
  in_stage_ = first_ < 1 ? std::max(0.0, (fraction - first_) / (1 - first_)) : 1;
  if (total_ <= 0) return;
  const double of_job = (before_ + share_ * in_stage_) / total_;
  done_ = std::max(done_, (double(job_) + std::min(1.0, of_job)) / double(jobs_));
}

double Progress::stage_seconds() const {
  return std::chrono::duration<double>(Clock::now() - stage_start_).count();
}

double Progress::seconds_left() const {
  const double before = std::chrono::duration<double>(stage_start_ - job_start_).count();
  const double here = in_stage_ > 0 ? stage_seconds() * (1 - in_stage_) / in_stage_ : 0;
  // Stages to come are as much slower than planned as those before were.
  const double after = std::max(0.0, total_ - before_ - share_);
  return here + (before_ > 0 ? before * after / before_ : 0);
}

}  // namespace rfsmooth::cli
