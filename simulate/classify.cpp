#include "simulate/classify.h"

namespace skyquilt::simulate {

using survey::SurfaceClass;

namespace {

// Driveways are ground: they are of concrete and brick as often as of asphalt.
SurfaceClass ClassOfGround(const GroundSample& ground) {
  const bool car_park = ground.kind == GroundKind::kPad && ground.pad->kind == PadKind::kParking;
  return ground.kind == GroundKind::kRoad || car_park ? SurfaceClass::kRoad : SurfaceClass::kGround;
}

}  // namespace

SurfaceClass ClassOf(const Tag& tag, const Eigen::Vector3f& position, const CityLayout* city, const SaltMarsh* marsh) {
  switch (tag.part) {
    case Part::kGround:
      if (marsh != nullptr && marsh->Covers(position)) return SurfaceClass::kVegetation;
      return city == nullptr ? SurfaceClass::kGround : ClassOfGround(city->Sample(position.x(), position.y()));
    case Part::kWater:
      return SurfaceClass::kWater;
    case Part::kRoomFloor:
      return SurfaceClass::kGround;
    case Part::kWall:
    case Part::kRoomWall:
    case Part::kRoomFurniture:
      return SurfaceClass::kWall;
    case Part::kFlatRoof:
    case Part::kPitchedRoof:
    case Part::kParapet:
    case Part::kRooftopBox:
    case Part::kChimney:
    case Part::kSolarPanel:
    case Part::kSolarFrame:
      return SurfaceClass::kRoof;
    case Part::kTrunk:
    case Part::kLeaves:
      return SurfaceClass::kTree;
    case Part::kCarBody:
    case Part::kCarGlass:
    case Part::kCarTyre:
      return SurfaceClass::kParkedCar;
    case Part::kBridgeRoad:
    case Part::kBridgeConcrete:
      return SurfaceClass::kRoad;
    case Part::kPerson:
      return SurfaceClass::kPerson;
    case Part::kLampPost:
    case Part::kLampHead:
      return SurfaceClass::kLamp;
  }
  return SurfaceClass::kNone;
}

SurfaceClass ClassOfMoving(const Tag& tag) {
  return tag.part == Part::kPerson ? SurfaceClass::kPerson : SurfaceClass::kMovingCar;
}

}  // namespace skyquilt::simulate
