// A simulated place, ready to be rendered: geometry, light and surfaces, built from a PlaceSpec. Thread-safe once built, while its ground
// is not painted.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/raytrace/traced_scene.h"
#include "simulate/ambient_volume.h"
#include "simulate/city_layout.h"
#include "simulate/cloud_shadows.h"
#include "simulate/place_spec.h"
#include "simulate/salt_marsh.h"
#include "simulate/sky.h"
#include "simulate/surface.h"
#include "simulate/target_paint.h"
#include "simulate/terrain.h"
#include "simulate/tidal_channels.h"

namespace skyquilt::simulate {

// The moving cars, people and shadows of clouds at one moment.
struct MovingScene {
  std::vector<Car> cars;
  std::vector<Person> people;
  Mesh mesh;
  raytrace::TracedScene scene;
  CloudShadows clouds = {};
};

class World {
 public:
  World(const PlaceSpec& place, double light_intensity, base::ThreadPool& threads);

  const Mesh& mesh() const { return mesh_; }
  const raytrace::TracedScene& scene() const { return *scene_; }
  const Sky& sky() const { return sky_; }
  const AmbientVolume& ambient() const { return *ambient_; }
  const Terrain& terrain() const { return *terrain_; }
  const CityLayout* city() const { return city_.get(); }   // null without a city
  const SaltMarsh* marsh() const { return marsh_.get(); }  // null without one
  // Empty without a city.
  const std::vector<Building>& buildings() const;

  // ENU height of the ground in the middle of the surveyed area, where the drone takes off.
  double TakeoffHeight(const PlaceSpec& place) const;

  // Puts targets on the ground, in place of earlier ones. Not while other threads use this world.
  void PaintTargets(std::vector<PaintedTarget> targets) { paint_ = TargetPaint(std::move(targets)); }

  // The same place in another light. Not while other threads use this world.
  void SetLight(double sun_elevation_deg, double light_intensity, base::ThreadPool& threads);

  MovingScene MovingAt(double time_s) const;
  // Surface of the static scene at a hit; of what moves, given its MovingScene.
  Surface SurfaceAt(const Hit& hit) const;
  static Surface MovingSurfaceAt(const Hit& hit, const MovingScene& moving);

 private:
  Surface GroundAt(const Hit& hit) const;
  // Sets a car on the ground, or on the bridge if it drives along it.
  void PutOnRoad(const Eigen::Vector2d& direction, Car& car) const;
  // Of the ground under a car on a hillside, per metre to the east and to the north; otherwise 0, as cars stand level on rolling ground.
  Eigen::Vector2d RiseUnderCar(const Eigen::Vector2d& at) const;
  void BuildCity(const PlaceSpec& place, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max);
  void BuildSolarFarm(const PlaceSpec& place, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max);
  void BuildRoom(const PlaceSpec& place, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max);
  void BuildTidalFlat(const PlaceSpec& place, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max);
  // A rectangle whose half sides are `reach` radii; the ground covers it where there is no water.
  void AddWater(const Pond& pond, double reach, uint32_t object);
  // Not beyond the shore, as the ground beside a pond on a hillside may be lower than the water.
  void AddRoundWater(const Pond& pond, uint32_t object);

  uint32_t seed_;
  Eigen::Vector2d hillside_rise_;
  std::unique_ptr<CityLayout> city_;
  std::unique_ptr<TidalChannels> channels_;  // of a tidal flat
  std::unique_ptr<SaltMarsh> marsh_;
  std::unique_ptr<Terrain> terrain_;
  std::vector<MovingCar> moving_;
  std::vector<Walker> walkers_;
  std::vector<Eigen::Vector2f> building_axis_;
  Mesh mesh_;
  std::unique_ptr<raytrace::TracedScene> scene_;
  Sky sky_;
  double sun_azimuth_deg_, sky_clouds_;
  float ambient_voxel_m_;
  CloudShadowSpec cloud_shadows_;
  CloudShadows clouds_;
  TargetPaint paint_;
  std::unique_ptr<AmbientVolume> ambient_;
};

}  // namespace skyquilt::simulate
