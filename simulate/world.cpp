#include "simulate/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/building_material.h"
#include "simulate/flights/room.h"
#include "simulate/ground_material.h"
#include "simulate/noise.h"
#include "simulate/object_material.h"
#include "simulate/outline.h"
#include "simulate/solar_farm.h"
#include "simulate/tidal_material.h"

namespace skyquilt::simulate {

World::World(const PlaceSpec& place, double light_intensity, base::ThreadPool& threads)
    : seed_(HashCell(static_cast<int>(place.seed), 0, 4711U)),
      hillside_rise_(HillsideRise(place.hillside_deg)),
      sky_(place.sun_azimuth_deg, place.sun_elevation_deg, light_intensity, place.sky_clouds, seed_ + 5U),
      sun_azimuth_deg_(place.sun_azimuth_deg),
      sky_clouds_(place.sky_clouds),
      ambient_voxel_m_(static_cast<float>(place.ambient_voxel_m)),
      cloud_shadows_(place.cloud_shadows),
      clouds_(cloud_shadows_, sky_.sun_direction(), seed_ + 6U) {
  const Eigen::Vector2d surround = Eigen::Vector2d::Constant(place.surround_m);
  if (place.landscape == Landscape::kCity) {
    BuildCity(place, place.area_min - surround, place.area_max + surround);
  } else if (place.landscape == Landscape::kSolarFarm) {
    BuildSolarFarm(place, place.area_min - surround, place.area_max + surround);
  } else if (place.landscape == Landscape::kRoom) {
    BuildRoom(place, place.area_min - surround, place.area_max + surround);
  } else {
    BuildTidalFlat(place, place.area_min - surround, place.area_max + surround);
  }
  scene_ = std::make_unique<raytrace::TracedScene>(mesh_.position, mesh_.triangle);
  ambient_ = std::make_unique<AmbientVolume>(mesh_, *scene_, sky_, ambient_voxel_m_, threads);
}

void World::SetLight(double sun_elevation_deg, double light_intensity, base::ThreadPool& threads) {
  sky_ = Sky(sun_azimuth_deg_, sun_elevation_deg, light_intensity, sky_clouds_, seed_ + 5U);
  clouds_ = CloudShadows(cloud_shadows_, sky_.sun_direction(), seed_ + 6U);
  ambient_ = std::make_unique<AmbientVolume>(mesh_, *scene_, sky_, ambient_voxel_m_, threads);
}

const std::vector<Building>& World::buildings() const {
  static const std::vector<Building> none;
  return city_ ? city_->contents().buildings : none;
}

void World::BuildCity(const PlaceSpec& place, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max) {
  city_ = std::make_unique<CityLayout>(place.city, ground_min, ground_max, seed_);
  CityContents& contents = city_->contents();
  const Eigen::Vector2d middle = 0.5 * (place.area_min + place.area_max);
  const auto Rolling = [&](double east, double north) {
    return RollingHeight(east, north, place.terrain_amplitude_m, seed_ + 1U) + hillside_rise_.dot(Eigen::Vector2d(east, north) - middle);
  };
  // In units of the pond's radius. On a hillside it needs a broader dam.
  const bool level = place.hillside_deg == 0.0;
  const float shore_begin = level ? 1.5F : 1.6F;
  const float shore_end = level ? 1.05F : 1.25F;
  for (Pond& pond : contents.ponds) {
    pond.level_z_m = Rolling(pond.centre.x(), pond.centre.y()) - 0.5;
  }
  terrain_ = std::make_unique<Terrain>(ground_min, ground_max, place.terrain_step_m, [&](double east, double north) {
    double height = Rolling(east, north);
    for (const Pond& pond : contents.ponds) {
      const double r = pond.Radius(east, north);
      if (r > static_cast<double>(shore_begin)) continue;
      // A level shore, and the basin inside it.
      const auto shore = static_cast<double>(Smoothstep(shore_begin, shore_end, static_cast<float>(r)));
      const double basin = pond.level_z_m + (r - 1.0) * 1.6;
      height += shore * (basin - height);
    }
    return height;
  });
  terrain_->AddTo(mesh_);
  for (size_t i = 0; i < contents.ponds.size(); ++i) {
    const auto object = static_cast<uint32_t>(i);
    if (level) {
      AddWater(contents.ponds[i], 1.3, object);
    } else {
      AddRoundWater(contents.ponds[i], object);
    }
  }
  const auto Ground = [&](const Eigen::Vector2d& p) {
    return static_cast<double>(terrain_->Height(static_cast<float>(p.x()), static_cast<float>(p.y())));
  };
  for (const Outline& outline : FindOutlines(contents.buildings)) {
    const double ground_z_m = Ground(outline.centre);
    double below_m = 0.0;
    if (outline.n_parts > 1) {
      // Large compounds stand on ground that differs by metres.
      for (const Eigen::Vector2d& corner : outline.walls) below_m = std::max(below_m, ground_z_m - Ground(corner));
    }
    for (size_t i = outline.first; i < outline.first + outline.n_parts; ++i) {
      Building& building = contents.buildings[i];
      building.ground_z_m = ground_z_m;
      building.foundation_m += below_m + 0.5 * std::hypot(outline.length_m, outline.width_m) * hillside_rise_.norm();
    }
  }
  for (size_t i = 0; i < contents.buildings.size(); ++i) {
    const Building& building = contents.buildings[i];
    building_axis_.push_back(building.Axis().cast<float>());
    AddBuilding(building, static_cast<uint32_t>(i), mesh_);
  }
  for (size_t i = 0; i < contents.trees.size(); ++i) {
    contents.trees[i].ground_z_m = Ground(contents.trees[i].position);
    AddTree(contents.trees[i], static_cast<uint32_t>(i), place.city.tree_detail, mesh_);
  }
  for (size_t i = 0; i < contents.parked.size(); ++i) {
    contents.parked[i].ground_z_m = Ground(contents.parked[i].position);
    contents.parked[i].ground_rise = RiseUnderCar(contents.parked[i].position);
    AddCar(contents.parked[i], static_cast<uint32_t>(i), mesh_);
  }
  for (size_t i = 0; i < contents.lamps.size(); ++i) {
    contents.lamps[i].ground_z_m = Ground(contents.lamps[i].position);
    AddLamp(contents.lamps[i], static_cast<uint32_t>(i), mesh_);
  }
  if (contents.bridge) {
    contents.bridge->StandOn(Ground);
    AddBridge(*contents.bridge, mesh_);
  }
  base::Random random(seed_, 3);
  const Eigen::Vector2d beyond = Eigen::Vector2d::Constant(40.0);
  moving_ = city_->MakeMovingCars(place.moving_cars, place.area_min - beyond, place.area_max + beyond, random);
  base::Random walker_random(seed_, 10);
  walkers_ = city_->MakeWalkers(place.people, place.area_min - beyond, place.area_max + beyond, walker_random);
}

void World::PutOnRoad(const Eigen::Vector2d& direction, Car& car) const {
  const std::optional<Bridge>& bridge = city_->contents().bridge;
  if (const auto road = bridge ? bridge->RoadFor(car.position, direction) : std::nullopt) {
    car.ground_z_m = road->z_m;
    car.ground_rise = road->rise;
    return;
  }
  car.ground_z_m = static_cast<double>(terrain_->Height(static_cast<float>(car.position.x()), static_cast<float>(car.position.y())));
  car.ground_rise = RiseUnderCar(car.position);
}

Eigen::Vector2d World::RiseUnderCar(const Eigen::Vector2d& at) const {
  if (hillside_rise_.isZero()) return Eigen::Vector2d::Zero();
  const Eigen::Vector2f p = at.cast<float>();
  constexpr float kReach_m = 2.0F;
  const auto rise = [&](float east, float north) {
    return static_cast<double>((terrain_->Height(p.x() + east, p.y() + north) - terrain_->Height(p.x() - east, p.y() - north)) / (2.0F * kReach_m));
  };
  return {rise(kReach_m, 0.0F), rise(0.0F, kReach_m)};
}

void World::BuildSolarFarm(const PlaceSpec& place, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max) {
  const Eigen::Vector2d middle = 0.5 * (place.area_min + place.area_max);
  terrain_ = std::make_unique<Terrain>(ground_min, ground_max, place.terrain_step_m, [&](double east, double north) {
    return RollingHeight(east, north, place.terrain_amplitude_m, seed_ + 1U) + hillside_rise_.dot(Eigen::Vector2d(east, north) - middle);
  });
  terrain_->AddTo(mesh_);
  const auto ground = [this](float east, float north) { return terrain_->Height(east, north); };
  AddSolarTables(ground_min, ground_max, ground, mesh_);
}

void World::BuildRoom(const PlaceSpec& place, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max) {
  terrain_ = std::make_unique<Terrain>(ground_min, ground_max, place.terrain_step_m, [](double, double) { return kGroundAtRoom_m; });
  terrain_->AddTo(mesh_);
  AddRoom(mesh_);
}

void World::BuildTidalFlat(const PlaceSpec& place, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max) {
  channels_ = std::make_unique<TidalChannels>(place.area_min, place.area_max, place.terrain_amplitude_m, seed_);
  terrain_ = std::make_unique<Terrain>(ground_min, ground_max, place.terrain_step_m,
                                       [&](double east, double north) { return channels_->Height(east, north); });
  terrain_->AddTo(mesh_);
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.5);
  Pond sea;
  sea.centre = 0.5 * (ground_min + ground_max);
  sea.radii = 0.5 * (ground_max - ground_min) - margin;
  sea.level_z_m = channels_->water_z_m();
  AddWater(sea, 1.0, 0);
  if (!place.marsh) return;
  const auto ground_z = [this](const Eigen::Vector2d& at) {
    return static_cast<double>(terrain_->Height(static_cast<float>(at.x()), static_cast<float>(at.y())));
  };
  marsh_ = std::make_unique<SaltMarsh>(place.area_min, place.area_max, ground_z, channels_->water_z_m(), seed_);
  constexpr int kTreeDetail = 2;
  for (size_t i = 0; i < marsh_->trees().size(); ++i) AddTree(marsh_->trees()[i], static_cast<uint32_t>(i), kTreeDetail, mesh_);
}

void World::AddWater(const Pond& pond, double reach, uint32_t object) {
  const auto Corner = [&](double x, double y) {
    const Eigen::Vector2d at = pond.At(x * reach, y * reach);
    return Eigen::Vector3f(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(pond.level_z_m));
  };
  mesh_.AddQuad(Corner(-1, -1), Corner(1, -1), Corner(1, 1), Corner(-1, 1), {Part::kWater, object});
}

void World::AddRoundWater(const Pond& pond, uint32_t object) {
  constexpr int kSides = 48;
  constexpr double kReach = 1.02;
  const auto Point = [&](double reach, int side) {
    const double angle = 2.0 * std::numbers::pi * side / kSides;
    const Eigen::Vector2d at = pond.At(reach * std::cos(angle), reach * std::sin(angle));
    return Eigen::Vector3f(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(pond.level_z_m));
  };
  for (int side = 0; side < kSides; ++side) {
    mesh_.AddTriangle(Point(0.0, side), Point(kReach, side), Point(kReach, side + 1), {Part::kWater, object});
  }
}

double World::TakeoffHeight(const PlaceSpec& place) const {
  const Eigen::Vector2f middle = (0.5 * (place.area_min + place.area_max)).cast<float>();
  return static_cast<double>(terrain_->Height(middle.x(), middle.y()));
}

MovingScene World::MovingAt(double time_s) const {
  std::vector<Car> cars;
  Mesh mesh;
  for (size_t i = 0; i < moving_.size(); ++i) {
    Car car = moving_[i].At(time_s);
    PutOnRoad(moving_[i].direction, car);
    AddCar(car, static_cast<uint32_t>(i), mesh);
    cars.push_back(car);
  }
  std::vector<Person> people;
  for (size_t i = 0; i < walkers_.size(); ++i) {
    Person person = walkers_[i].At(time_s);
    person.ground_z_m = static_cast<double>(terrain_->Height(static_cast<float>(person.position.x()), static_cast<float>(person.position.y())));
    AddPerson(person, static_cast<uint32_t>(i), mesh);
    people.push_back(person);
  }
  raytrace::TracedScene scene(mesh.position, mesh.triangle);
  return {std::move(cars), std::move(people), std::move(mesh), std::move(scene), clouds_.At(time_s)};
}

Surface World::GroundAt(const Hit& hit) const {
  Surface surface = city_       ? CityGround(*city_, hit, seed_)
                    : channels_ ? TidalSand(hit, static_cast<float>(channels_->water_z_m()), seed_)
                                : FarmGround(hit, seed_);
  if (marsh_) surface = marsh_->Over(surface, hit);
  paint_.Apply(hit, surface);
  return surface;
}

Surface World::SurfaceAt(const Hit& hit) const {
  switch (hit.tag.part) {
    case Part::kGround:
      return GroundAt(hit);
    case Part::kWater:
      return city_ ? PondWater(hit, seed_) : TidalWater(*terrain_, hit, seed_);
    case Part::kTrunk:
    case Part::kLeaves:
      return TreeSurface(marsh_ ? marsh_->trees()[hit.tag.object] : city_->contents().trees[hit.tag.object], hit);
    case Part::kCarBody:
    case Part::kCarGlass:
    case Part::kCarTyre:
      return CarSurface(city_->contents().parked[hit.tag.object], hit);
    case Part::kLampPost:
    case Part::kLampHead:
      return LampSurface(hit);
    case Part::kBridgeRoad:
    case Part::kBridgeConcrete:
      return BridgeSurface(*city_->contents().bridge, hit, seed_);
    case Part::kSolarPanel:
    case Part::kSolarFrame:
      return SolarTableSurface(hit);
    case Part::kRoomFloor:
    case Part::kRoomWall:
    case Part::kRoomFurniture:
      return RoomSurface(hit);
    default:
      return BuildingSurface(city_->contents().buildings[hit.tag.object], building_axis_[hit.tag.object], hit);
  }
}

Surface World::MovingSurfaceAt(const Hit& hit, const MovingScene& moving) {
  if (hit.tag.part == Part::kPerson) return PersonSurface(moving.people[hit.tag.object], hit);
  return CarSurface(moving.cars[hit.tag.object], hit);
}

}  // namespace skyquilt::simulate
