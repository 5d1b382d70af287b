// A lock for Exiv2, whose XMP parser has process-wide tables and is not thread-safe. Hold it during every use of the library.
#pragma once

#include <mutex>

namespace skyquilt::survey {

// The first call also initialises the library: turns off its messages and registers DJI's namespace.
std::unique_lock<std::mutex> LockExiv2();

}  // namespace skyquilt::survey
