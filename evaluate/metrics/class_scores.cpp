#include "evaluate/metrics/class_scores.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"

namespace skyquilt::evaluate::metrics {

namespace {

using survey::SurfaceClass;

// Degrees between two unit vectors of single precision; NaN if either is. Exact for small angles too, where the arc cosine is not.
double AngleDeg(const float* a, const float* b) {
  const Eigen::Vector3d u = Eigen::Map<const Eigen::Vector3f>(a).cast<double>();
  const Eigen::Vector3d v = Eigen::Map<const Eigen::Vector3f>(b).cast<double>();
  return 2.0 * std::atan2((u - v).norm(), (u + v).norm()) * 180.0 / std::numbers::pi;
}

void SetDepthScores(const std::vector<double>& errors_m, ClassScore* score) {
  if (errors_m.empty()) return;
  double squares = 0.0;
  for (const double error : errors_m) squares += error * error;
  score->depth_rmse_m = std::sqrt(squares / static_cast<double>(errors_m.size()));
  score->depth_bias_m = base::Median(errors_m);
  std::vector<double> apart(errors_m.size());
  std::transform(errors_m.begin(), errors_m.end(), apart.begin(), [](double error) { return std::abs(error); });
  score->depth_median_abs_m = base::Median(std::move(apart));
  score->depth_nmad_m = base::Nmad(errors_m);
}

}  // namespace

void ClassErrors::Add(const photos::HeldOutPhoto& task, const photos::PhotoResult& findings) {
  if (findings.true_class.Empty() || findings.true_depth.Empty()) return;
  SKYQUILT_CHECK(findings.true_class.width == findings.scored.width && findings.true_class.height == findings.scored.height,
                 "true classes must have the scored size");
  any_ = true;
  for (int y = 0; y < findings.scored.height; ++y) {
    for (int x = 0; x < findings.scored.width; ++x) {
      const uint8_t id = *findings.true_class.At(x, y);
      const double true_m = static_cast<double>(*findings.true_depth.At(x, y));
      if (*findings.scored.At(x, y) == 0 || id >= survey::kSurfaceClasses || !std::isfinite(true_m)) continue;
      Errors& errors = errors_[id];
      const double rendered_m = static_cast<double>(*findings.z_depth.At(x, y));
      if (!std::isfinite(rendered_m)) {
        ++errors.missing;
        continue;
      }
      errors.depth_m.push_back(static_cast<float>((rendered_m - true_m) / task.camera.RayFromImg({x + 0.5, y + 0.5}).z()));
      if (findings.true_normals.Empty()) continue;
      const auto add_angle = [&](const image::ImageF& normals, std::vector<float>* angles_deg) {
        if (normals.Empty()) return;
        const double angle_deg = AngleDeg(normals.At(x, y), findings.true_normals.At(x, y));
        if (std::isfinite(angle_deg)) angles_deg->push_back(static_cast<float>(angle_deg));
      };
      add_angle(findings.normals, &errors.normal_deg);
      add_angle(findings.density_normals, &errors.density_normal_deg);
      add_angle(findings.head_normals, &errors.head_normal_deg);
    }
  }
}

void ClassErrors::Save(base::BytePacker* out) const {
  for (const Errors& errors : errors_) {
    out->Add(errors.depth_m);
    out->Add(errors.normal_deg);
    out->Add(errors.density_normal_deg);
    out->Add(errors.head_normal_deg);
    out->Add(errors.missing);
  }
  out->Add(any_);
}

void ClassErrors::Load(base::ByteUnpacker* in) {
  for (Errors& errors : errors_) {
    in->Take(&errors.depth_m);
    in->Take(&errors.normal_deg);
    in->Take(&errors.density_normal_deg);
    in->Take(&errors.head_normal_deg);
    in->Take(&errors.missing);
  }
  in->Take(&any_);
}

std::vector<ClassScore> ClassErrors::Result() const {
  std::vector<ClassScore> scores;
  if (!any_) return scores;
  const auto add = [&](SurfaceClass name, std::initializer_list<SurfaceClass> members) {
    ClassScore score;
    score.name = survey::kSurfaceClassNames[static_cast<size_t>(name)];
    std::vector<double> depth_m, normal_deg, density_normal_deg, head_normal_deg;
    for (const SurfaceClass member : members) {
      const Errors& errors = errors_[static_cast<size_t>(member)];
      const auto append = [](const std::vector<float>& from, std::vector<double>* to) { to->insert(to->end(), from.begin(), from.end()); };
      append(errors.depth_m, &depth_m);
      append(errors.normal_deg, &normal_deg);
      append(errors.density_normal_deg, &density_normal_deg);
      append(errors.head_normal_deg, &head_normal_deg);
      score.missing_pixels += errors.missing;
    }
    score.pixels = static_cast<int64_t>(depth_m.size());
    SetDepthScores(depth_m, &score);
    score.normal_mean_deg = MeanOfMeasured(normal_deg);
    score.normal_median_deg = base::Median(std::move(normal_deg));
    score.density_normal_median_deg = base::Median(std::move(density_normal_deg));
    score.head_normal_median_deg = base::Median(std::move(head_normal_deg));
    scores.push_back(std::move(score));
  };
  add(SurfaceClass::kRoof, {SurfaceClass::kRoof});
  add(SurfaceClass::kWall, {SurfaceClass::kWall});
  add(SurfaceClass::kGround, {SurfaceClass::kGround, SurfaceClass::kRoad});
  add(SurfaceClass::kRoad, {SurfaceClass::kRoad});
  add(SurfaceClass::kTree, {SurfaceClass::kTree});
  return scores;
}

}  // namespace skyquilt::evaluate::metrics
