// A test fixture with its own project folder, in which stages can be marked as finished.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "coordinator/project/stamp.h"
#include "core/base/file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::coordinator {

class ProjectFixture : public testing::Test {
 protected:
  void Touch(const std::filesystem::path& file, const std::string& text = "x") const {
    std::filesystem::create_directories(file.parent_path());
    base::WriteFileAtomically(file, text);
  }
  void Finish(const std::string& stage, const std::string& state = "done") const {
    SaveStamp(project_, {.stage = stage, .state = state, .options = options_, .inputs = inputs_});
  }

  TemporaryFolder folder_;
  Project project_ = Project::Create(folder_.path());
  FlatOptions options_ = {{"train.steps", "2000"}, {"train.levels", "8"}};
  FlatOptions inputs_ = {{"survey", "abc"}};
};

}  // namespace skyquilt::coordinator
