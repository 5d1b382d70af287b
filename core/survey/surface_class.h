// What the surfaces of a simulated survey are, as numbered in truth/classes/*.png and truth/surface.ply.
#pragma once

#include <array>
#include <cstdint>

namespace skyquilt::survey {

enum class SurfaceClass : uint8_t {
  kNone = 0,       // sky, or unknown
  kRoof = 1,       // decks and slopes, with what stands on them: parapets, stair housings, machines, chimneys; tops and sides; tables of solar panels
  kWall = 2,       // of buildings, gables included
  kGround = 3,     // everything else that one can walk on: gardens, fields, sand, pavements, paths, driveways, terraces, plazas
  kRoad = 4,       // carriageways of streets, car parks, and bridges with all their faces
  kTree = 5,       // crowns and trunks
  kParkedCar = 6,  // part of the static scene; trucks and containers too
  kMovingCar = 7,  // at another place in every photo
  kWater = 8,
  kPerson = 9,      // at another place in every photo
  kLamp = 10,       // street lamps: posts, arms and heads
  kVegetation = 11  // low plants of a salt marsh
};
inline constexpr int kSurfaceClasses = 12;

// Name of a class by its number.
inline constexpr std::array<const char*, kSurfaceClasses> kSurfaceClassNames = {"none",       "roof",       "wall",  "ground", "road", "tree",
                                                                                "parked car", "moving car", "water", "person", "lamp", "vegetation"};

}  // namespace skyquilt::survey
