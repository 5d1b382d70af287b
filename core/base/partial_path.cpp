#include "core/base/partial_path.h"

#include <system_error>
#include <utility>

#include "core/base/file.h"

namespace skyquilt::base {

PartialPath::PartialPath(std::filesystem::path target, std::filesystem::path partial) : target_(std::move(target)), partial_(std::move(partial)) {
  std::error_code error;
  std::filesystem::remove_all(partial_, error);
  if (error) ThrowFileError(partial_, "is of an earlier call and cannot be removed", error.value());
}

PartialPath::~PartialPath() {
  std::error_code ignored;
  if (!published_) std::filesystem::remove_all(partial_, ignored);
}

void PartialPath::Publish() {
  base::Publish(partial_, target_);
  published_ = true;
}

}  // namespace skyquilt::base
