// Exiv2's XMP parser keeps process-wide tables; every use of the library holds this lock.
#pragma once

#include <mutex>

namespace skyquilt::survey {

// Also sets the library up at the first call: quiet, and with DJI's namespace known.
std::unique_lock<std::mutex> LockExiv2();

}  // namespace skyquilt::survey
