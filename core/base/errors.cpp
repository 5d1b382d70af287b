#include "core/base/errors.h"

#include <sstream>

namespace skyquilt::base {

InputError::InputError(const std::filesystem::path& file, const std::string& found, const std::string& fix)
    : InputError(file, found + (fix.empty() ? "" : ". " + fix)) {}

InputError::InputError(const std::filesystem::path& file, const std::string& finding)
    : std::runtime_error(file.string() + ": " + finding), file_(file), finding_(finding) {}

void ThrowCheckFailure(const char* condition, const char* file, int line, const std::string& detail) {
  std::ostringstream message;
  message << "check failed: " << condition << " at " << file << ":" << line;
  if (!detail.empty()) message << ": " << detail;
  throw std::logic_error(message.str());
}

}  // namespace skyquilt::base
