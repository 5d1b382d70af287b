// What simulate.flight changes of a place before it is built.
#pragma once

#include <string>
#include <vector>

#include "simulate/place_spec.h"

namespace skyquilt::simulate {

// Allowed values of simulate.flight, in the order of FlightKind.
std::vector<std::string> FlightNames();
std::string FlightName(FlightKind flight);

// The place of flight "room": one room (simulate/flights/room.h) on level ground.
PlaceSpec RoomPlace();

// Sets place.flight. A level flight has a phone's camera and exposure, one block, and no moving cars. Throws base::UsageError for options that the
// flight does not have, and for a place without houses or streets for it.
void ApplyFlight(const SimulateOptions& options, PlaceSpec& place);

}  // namespace skyquilt::simulate
