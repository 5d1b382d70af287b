#include "core/base/errors.h"

#include <sstream>

namespace skyquilt::base {

void ThrowCheckFailure(const char* condition, const char* file, int line, const std::string& detail) {
  std::ostringstream message;
  message << "check failed: " << condition << " at " << file << ":" << line;
  if (!detail.empty()) message << ": " << detail;
  throw std::logic_error(message.str());
}

}  // namespace skyquilt::base
