// Answers that several kinds of saved data share.
#pragma once

#include <string>

#include "core/base/errors.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

DataReply TextReply(int status, const std::string& text);

// What a failed reading or writing of a file of the project means for the user: 507 (disk full), 409 (no permission), else 500, with the reason as
// text. name: of what is not saved, as people know it.
DataReply FailureReply(const base::InputError& failure, const std::string& name);

}  // namespace skyquilt::viewer
