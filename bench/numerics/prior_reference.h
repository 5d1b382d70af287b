// The losses of a step's priors in double, one ray after the other, to check their gradients by differences. What the trainer takes as given during a
// step is held at its values for the first parameters: the planes, where samples stop the light, ground sampling distances, positions of normals.
// Which rays have a loss is decided as in the trainer; the arithmetic of distances, weights and slopes is written independently of it.
#pragma once

#include <optional>
#include <vector>

#include "bench/numerics/reference_trainer.h"
#include "worker/planes/plane_fit.h"
#include "worker/step/step_priors.h"

namespace skyquilt::bench {

class PriorReference {
 public:
  // All must outlive this. For box fields without normal head, whose samples have one position at most.
  PriorReference(const render::TrainedField& target, const ReferenceField& field, const worker::RayBatch& batch, const worker::StepPriors& priors,
                 const ReferenceState& state);

  // The sum of the losses, as a mean over the rays.
  double Loss(const ReferenceState& state) const;
  // Rays and planes that have a loss of distance, rays that have one of normals.
  int pulls() const { return pulls_; }
  int normals() const { return normals_; }

 private:
  struct Sample {
    ReferenceField::Place place;
    double unit_length = 0.0, stop_m = 0.0;
  };
  // Towards a plane.
  struct Pull {
    double weight = 0.0, width_m = 0.0;
    worker::Plane plane;
  };
  struct Ray {
    const worker::BatchRay* ray = nullptr;
    std::vector<Sample> samples;
    double opacity = 0.0, mean_m = 0.0, depth_m = 0.0;
    std::vector<Pull> pulls;
    std::optional<ReferenceField::Place> end;  // where its normal has a loss
    std::optional<Eigen::Vector3d> known;      // normal of a plane of points there
    bool Opaque() const { return opacity > worker::kOpaqueWeight; }
    bool Sharp(double voxel_m) const { return Opaque() && depth_m < worker::kSharpVoxels * voxel_m; }
    Eigen::Vector3d At(double t) const { return ray->ray.origin_enu + t * ray->ray.direction_enu; }
  };

  double Tau(const ReferenceState& state, const Sample& sample) const;
  std::vector<double> Weights(const ReferenceState& state, const Ray& ray) const;
  // Gradient of the log density by position, ENU.
  Eigen::Vector3d Slope(const ReferenceState& state, const ReferenceField::Place& place) const;
  double LossOf(const ReferenceState& state, const Ray& ray) const;

  Ray Start(const worker::RayBatch& batch, const worker::BatchRay& ray, const ReferenceState& state) const;
  void AddPull(Ray& ray, double weight, const worker::Plane& plane);
  void AddKnownPlane(Ray& ray);
  void AddSegment(size_t first, size_t end);
  void AddNormal(const ReferenceState& state, Ray& ray);

  const render::TrainedField& target_;
  const ReferenceField& field_;
  worker::StepPriors priors_;
  std::vector<Ray> rays_;
  int pulls_ = 0, normals_ = 0;
};

}  // namespace skyquilt::bench
