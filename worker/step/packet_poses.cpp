#include "worker/step/packet_poses.h"

#include <algorithm>

namespace skyquilt::worker {

void PacketPoses::Add(const PacketSamples& s) {
  if (s.live == 0) return;
  const field::HashField& field = shared_.field;
  const encoding::Encoding& encoding = field.encoding();
  RayGradients& gradients = *s.step->ray_gradients;
  const size_t stride = s.packet->stride;
  by_position_.assign(3 * stride, 0.0F);
  const kernel::Positions at = s.step->batch.Positions(field.config()).From(s.packet->begin);
  for (int part = 0; part < encoding.parts(); ++part) {
    const float share = gradients.level_shares[static_cast<size_t>(part)];
    if (!(share > 0.0F)) continue;
    of_part_.assign(3 * stride, 0.0F);
    encoding.Slope(part, s.step->grid.data() + encoding.Offset(part), at, s.live,
                   s.Features() + static_cast<size_t>(encoding.FirstRow(part)) * stride, stride, of_part_.data(), stride);
    for (size_t i = 0; i < by_position_.size(); ++i) by_position_[i] += share * of_part_[i];
  }
  for (size_t k = 0; k < s.views.size(); ++k) {
    const PixelRay& ray = s.Ray(k).ray;
    const auto begin = static_cast<size_t>(s.views[k].begin), end = begin + static_cast<size_t>(s.views[k].count);
    RayGradient sum;
    for (size_t i = begin; i < end; ++i) {
      const auto t = static_cast<double>(s.Distances()[i]);
      const Eigen::Vector3d in_unit(static_cast<double>(by_position_[i]), static_cast<double>(by_position_[stride + i]),
                                    static_cast<double>(by_position_[2 * stride + i]));
      const Eigen::Vector3d in_enu = shared_.target.map.UnitPerEnu(ray.origin_enu + t * ray.direction_enu).transpose() * in_unit;
      sum.by_origin += in_enu;
      sum.by_direction += t * in_enu;
    }
    field.DirectionBackward(ray.direction_enu.data(), s.views[k].count, s.a.direction_gradient + begin, s.a.stride, sum.by_direction.data());
    gradients.rays[static_cast<size_t>(s.packet->first_ray) + k] = sum;
  }
}

}  // namespace skyquilt::worker
