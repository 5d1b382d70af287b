// Fields with known surfaces, and the text of a query's answer as JSON.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/json_text.h"
#include "viewer/queries/query.h"

namespace skyquilt::viewer {

// Distance along a ray to the surface; nothing: none.
using Surface = std::function<std::optional<double>(const render::Ray&)>;

inline RayCaster FieldOf(Surface surface, double spread_m = 0.0) {
  return [surface = std::move(surface), spread_m](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    for (size_t i = 0; i < rays.size(); ++i) {
      const std::optional<double> t = surface(rays[i]);
      const bool hit = t && *t >= rays[i].t_near && *t <= rays[i].t_far;
      const auto at = [&](double sigmas) { return hit ? static_cast<float>(*t + sigmas * spread_m) : std::numeric_limits<float>::quiet_NaN(); };
      out[i] = render::RayColor{};
      out[i].opacity = hit ? 1.0F : 0.0F;
      out[i].depth_median = out[i].depth = at(0.0);
      out[i].depth_front = at(-1.03643);
      out[i].depth_back = at(1.03643);
    }
  };
}

// A terrain for vertical rays: z of a place, nothing where there is none.
using Terrain = std::function<std::optional<double>(double x, double y)>;
inline Surface Above(Terrain terrain) {
  return [terrain = std::move(terrain)](const render::Ray& ray) -> std::optional<double> {
    const std::optional<double> z = terrain(ray.origin_enu.x(), ray.origin_enu.y());
    if (!z) return {};
    return (ray.origin_enu.z() - *z) / -ray.direction_enu.z();
  };
}

struct Box {
  Eigen::Array3d min, max;
};

// The ground z = 0 and boxes, for rays of any direction.
inline Surface GroundAndBoxes(std::vector<Box> boxes) {
  return [boxes = std::move(boxes)](const render::Ray& ray) -> std::optional<double> {
    double nearest = std::numeric_limits<double>::infinity();
    const double ground = -ray.origin_enu.z() / ray.direction_enu.z();
    if (ground > 0.0) nearest = ground;
    for (const Box& box : boxes) {
      const Eigen::Array3d a = (box.min - ray.origin_enu.array()) / ray.direction_enu.array(),
                           b = (box.max - ray.origin_enu.array()) / ray.direction_enu.array();
      const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
      if (enter <= leave && enter > 0.0) nearest = std::min(nearest, enter);
    }
    if (!std::isfinite(nearest)) return {};
    return nearest;
  };
}

inline FieldAccess AccessTo(RayCaster main, RayCaster before = {}) {
  FieldAccess access;
  access.main = std::move(main);
  access.before = std::move(before);
  access.batch = 1000;
  access.min_enu = {-100, -100, -20};
  access.max_enu = {100, 100, 30};
  access.gsd_m = 0.05;
  return access;
}

// Never more rays at once than the batch, and progress only forwards, to the end.
inline nlohmann::json AnswerOf(Query& query, FieldAccess access) {
  bool too_many = false;
  const auto watch = [&](RayCaster& caster) {
    if (!caster) return;
    caster = [inner = caster, &too_many, batch = access.batch](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
      too_many = too_many || rays.size() > batch || rays.size() != out.size();
      inner(rays, out);
    };
  };
  watch(access.main);
  watch(access.before);
  double fraction = 0.0;
  for (int step = 0; step < 100'000; ++step) {
    const bool done = query.Step(access);
    if (query.fraction() < fraction || query.fraction() > 1.0) throw std::logic_error("progress went back");
    fraction = query.fraction();
    if (!done) continue;
    if (too_many) throw std::logic_error("a batch was too large");
    if (fraction != 1.0) throw std::logic_error("an answer before the end: " + std::to_string(fraction));
    return base::ParseJson(query.Reply());
  }
  throw std::logic_error("no end");
}

}  // namespace skyquilt::viewer
