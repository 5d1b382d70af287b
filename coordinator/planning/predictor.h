// Predicts how long each stage takes: from counts of the survey and rates of the machine, corrected by what earlier stages really took.
// It has no clock and no files of its own. Not thread-safe.
#pragma once

#include <array>
#include <string>

#include "coordinator/planning/rates.h"
#include "coordinator/planning/work_size.h"
#include "coordinator/project/settings.h"

namespace skyquilt::coordinator {

class Predictor {
 public:
  Predictor(const WorkSize& size, const Rates& rates) : size_(size), rates_(rates) {}

  const WorkSize& size() const { return size_; }
  WorkSize& size() { return size_; }
  const Rates& rates() const { return rates_; }
  Rates& rates() { return rates_; }

  // Seconds; 0 for a stage that these settings do not make. "train" takes its budget, or what its steps take, and before it the photos are decoded.
  double Seconds(const std::string& stage, const Settings& settings) const;
  // Of decoding the photos for training, which is part of stage "train".
  double DecodingSeconds(const Settings& settings) const;
  // A stage of `predicted_s` took `took_s`. Later predictions of work of the same kind (poses, maps, or what is rendered photo by photo) are changed
  // by most of the ratio, others by a part of it, as the machine may be faster or slower in all. Ignored for times below a second, which say little.
  void Correct(const std::string& stage, double predicted_s, double took_s);
  // Rays were measured in the scene itself: what other stages told of them is forgotten.
  void TakeRays(double rays_per_second);

 private:
  enum Kind { kPoses, kMaps, kRendering, kOther };
  static Kind KindOf(const std::string& stage);

  double PrepareSeconds(const Settings& settings) const;
  double TrainSeconds(const Settings& settings) const;
  double ProductsSeconds(const Settings& settings) const;
  double TrustSeconds(const Settings& settings) const;
  double SurfaceSeconds(const Settings& settings) const;
  double EvaluateSeconds(const Settings& settings) const;
  double MasksSeconds(const Settings& settings) const;
  double TourSeconds(const Settings& settings) const;
  double RaySeconds(double rays) const;

  WorkSize size_;
  Rates rates_;
  std::array<double, kOther + 1> factors_ = {1.0, 1.0, 1.0, 1.0};  // by kind
};

}  // namespace skyquilt::coordinator
