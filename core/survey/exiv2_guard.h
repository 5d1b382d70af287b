// What the reader and the writer of tags need to know of Exiv2: a lock, as its XMP parser has process-wide tables and is not thread-safe, and the key
// of a tag that it does not know.
#pragma once

#include <mutex>

namespace skyquilt::survey {

// EXIF's GPSHPositioningError, for which Exiv2 0.27 has no name.
inline constexpr const char* kGpsHPositioningError = "Exif.GPSInfo.0x001f";

// Hold it during every use of the library. The first call also initialises the library: turns off its messages and registers the namespaces of DJI
// and Pix4D.
std::unique_lock<std::mutex> LockExiv2();

}  // namespace skyquilt::survey
