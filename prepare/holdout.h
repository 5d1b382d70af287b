// Which photos are kept for testing.
#pragma once

#include <filesystem>
#include <string>

#include "core/survey/survey.h"

namespace skyquilt::prepare {

struct Holdout {
  int every = 0;               // 0: not by index
  int offset = 0;              // in [0, every)
  std::filesystem::path list;  // empty: not by name
};

// "none", "every:N", "every:N:offset", "list:FILE". Throws base::UsageError.
Holdout ParseHoldout(const std::string& text);
// Sets is_test. The index counts the registered photos in name order (index % every == offset), as the field's benchmarks do.
// Throws base::InputError for a list that cannot be read or names a photo the survey has never seen, base::UsageError if nothing remains to train on.
void MarkHoldout(const Holdout& holdout, survey::Survey& survey);

}  // namespace skyquilt::prepare
