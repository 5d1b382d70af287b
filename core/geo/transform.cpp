#include "core/geo/transform.h"

namespace skyquilt::geo {

Rigid3d TransformCameraWorld(const Rigid3d& cam_from_a, const Similarity3d& b_from_a) {
  // With c the camera and s the scale: s x_c = R_ca R_ba^T (x_b - t_ba) + s t_ca.
  Rigid3d cam_from_b;
  cam_from_b.rotation = (cam_from_a.rotation * b_from_a.rotation.conjugate()).normalized();
  cam_from_b.translation = b_from_a.scale * cam_from_a.translation - cam_from_b.rotation * b_from_a.translation;
  return cam_from_b;
}

}  // namespace skyquilt::geo
