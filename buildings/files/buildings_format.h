// Names in buildings.json that its writer and its reader share.
#pragma once

#include <array>
#include <utility>

#include "buildings/files/building_files.h"

namespace skyquilt::buildings {

inline constexpr const char* kBuildingsFormat = "skyquilt buildings";
inline constexpr int kBuildingsVersion = 1;

inline constexpr std::array<std::pair<const char*, Measure Measures::*>, 11> kMeasureNames = {{{"ground_m", &Measures::ground_m},
                                                                                               {"eave_m", &Measures::eave_m},
                                                                                               {"ridge_m", &Measures::ridge_m},
                                                                                               {"height_m", &Measures::height_m},
                                                                                               {"length_m", &Measures::length_m},
                                                                                               {"width_m", &Measures::width_m},
                                                                                               {"yaw_deg", &Measures::yaw_deg},
                                                                                               {"footprint_m2", &Measures::footprint_m2},
                                                                                               {"roof_m2", &Measures::roof_m2},
                                                                                               {"volume_m3", &Measures::volume_m3},
                                                                                               {"pitch_deg", &Measures::pitch_deg}}};

inline constexpr std::array<FaceKind, 3> kFaceKinds = {FaceKind::kGround, FaceKind::kWall, FaceKind::kRoof};
inline const char* FaceKindName(FaceKind kind) {
  return kind == FaceKind::kGround ? "ground" : kind == FaceKind::kRoof ? "roof" : "wall";
}

}  // namespace skyquilt::buildings
