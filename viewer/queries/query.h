// Questions about the field, answered in small steps so that rendering of views can go on between them.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/render/ray.h"
#include "core/survey/survey.h"
#include "core/trust/trust.h"
#include "viewer/protocol/messages.h"

namespace skyquilt::viewer {

// Renders rays of one project. Rays and results have the same length; frame: ENU of the MAIN project (the caster of the earlier survey converts).
using RayCaster = std::function<void(std::span<const render::Ray>, std::span<render::RayColor>)>;

struct FieldAccess {
  RayCaster main;       // empty: no field
  RayCaster before;     // empty: no earlier survey, or it has no field
  size_t batch = 2048;  // rays per call, so that a step takes about 10 ms
  // Of the main project's scene (or its survey): where surfaces are, metres ENU. Vertical rays start above it.
  Eigen::Vector3d min_enu = Eigen::Vector3d::Zero(), max_enu = Eigen::Vector3d::Zero();
  // The same of the earlier survey alone.
  Eigen::Vector3d before_min_enu = Eigen::Vector3d::Zero(), before_max_enu = Eigen::Vector3d::Zero();
  double gsd_m = 0.05;
};

class Query {
 public:
  virtual ~Query() = default;
  // Renders at most access.batch rays. Returns true when the answer is complete. Throws BadMessage when the question cannot be answered (text for the
  // user), base::Interrupted.
  virtual bool Step(const FieldAccess& access) = 0;
  virtual double fraction() const = 0;  // done, 0 to 1
  // The reply's text (protocol/replies.h); after Step returned true.
  virtual std::string Reply() const = 0;
};

std::unique_ptr<Query> MakePick(const PickRequest& request);
// survey: null when there is none. Without a field, no test for what stands between.
std::unique_ptr<Query> MakePhotosAt(const PhotosAtRequest& request, std::shared_ptr<const survey::Survey> survey);
std::unique_ptr<Query> MakeProfile(const ProfileRequest& request);
std::unique_ptr<Query> MakeVolume(const VolumeRequest& request);
// Receives the finished map as PNG and returns the URL (below /data/) under which browsers find it.
using PublishPicture = std::function<std::string(std::string png)>;
// Renders held-out photos at about 250 pixels of width (at most 200 of them, spread evenly), compares them with the photos and averages the error in
// a map of the ground. `exposure_of`: log gains for a photo's own exposure (scene::Appearance of the photo) are applied by photo_caster.
// photo_caster: as FieldAccess::main but with the brightness of photo `i`.
using PhotoCaster = std::function<void(int photo, std::span<const render::Ray>, std::span<render::RayColor>)>;
std::unique_ptr<Query> MakeErrorMap(const ErrorMapRequest& request, std::shared_ptr<const survey::Survey> survey, PhotoCaster photo_caster,
                                    PublishPicture publish);

// The errors to expect of the surfaces that are seen from above, at most MeanMap::kMaxSide cells along each side. Throws BadMessage without a picture
// to publish.
std::unique_ptr<Query> MakeTrustMap(const TrustMapRequest& request, trust::Trust trust, PublishPicture publish);

// Depth spread of a rendered ray: one standard deviation along the ray, metres; NaN without a surface. The depths where the transmittance falls below
// .85 and .15 are the +-1.04 sigma of a normal distribution.
double DepthSpread(const render::RayColor& color);

}  // namespace skyquilt::viewer
