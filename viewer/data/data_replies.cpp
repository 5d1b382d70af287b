#include "viewer/data/data_replies.h"

#include <array>
#include <cerrno>
#include <system_error>

#include "core/base/log.h"

namespace skyquilt::viewer {

DataReply TextReply(int status, const std::string& text) {
  return {.status = status, .content_type = "text/plain; charset=utf-8", .body = text, .file = {}};
}

DataReply FailureReply(const base::InputError& failure, const std::string& name) {
  struct Kind {
    int code, status;
    const char* advice;
  };
  static constexpr const char* kFree = "Free some space on this disk, then save again";
  static constexpr const char* kAllow = "Allow this user to read and write in the project folder, then save again";
  // The limit of a process for the size of its files has the effect of a full disk.
  static constexpr std::array<Kind, 6> kKinds = {
      {{ENOSPC, 507, kFree}, {EDQUOT, 507, kFree}, {EFBIG, 507, kFree}, {EACCES, 409, kAllow}, {EPERM, 409, kAllow}, {EROFS, 409, kAllow}}};
  base::LogWarning("{}", failure.what());
  for (const Kind& kind : kKinds) {
    const std::string message = std::generic_category().message(kind.code);
    if (failure.finding().find(message) == std::string::npos) continue;
    return TextReply(kind.status, std::string(name).append(" is not saved: ").append(message).append(". ").append(kind.advice));
  }
  return TextReply(500, name + " is not saved: " + failure.finding());
}

}  // namespace skyquilt::viewer
