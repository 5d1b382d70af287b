// Reads the maker notes of DJI's drones up to about 2016, which have the flight's speed there and not in XMP. Layout: a TIFF directory without
// header, as read by ExifTool (lib/Image/ExifTool/DJI.pm); checked with photos of a Phantom 3.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace skyquilt::survey {

// Ground speed in metres per second from the two horizontal components. Nothing when the bytes are not such a note, one component is missing or not
// finite, or the speed is impossible (200 m/s or more).
std::optional<double> DjiMakerNoteSpeed(std::span<const uint8_t> note, bool little_endian);

}  // namespace skyquilt::survey
