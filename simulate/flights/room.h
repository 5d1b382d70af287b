// The room of flight "room": a box with plain walls, a window, boards on the floor and a few boxes as furniture, on the ground floor of a house that
// has nothing else. It is turned a little, as nothing should stand along north and east.
#pragma once

#include "simulate/surface.h"
#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

inline constexpr double kRoomReach_m = 4.5;      // its corners outside are nearer to the origin than this
inline constexpr double kGroundAtRoom_m = -0.6;  // of the ground outside; the floor is at 0

// Adds the triangles. Object: which wall or piece of furniture.
void AddRoom(Mesh& mesh);
// Of a hit on a part of the room.
Surface RoomSurface(const Hit& hit);

}  // namespace skyquilt::simulate
