#include "coordinator/ranks/shared_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::coordinator {
namespace {

namespace fs = std::filesystem;

TEST(SharedFolder, IsFoundByItsProofAndLeavesNothing) {
  const TemporaryFolder folder;
  {
    const SharedFolder shared(folder.path());
    EXPECT_NO_THROW(RequireSharedFolder(shared.Proof()));
    const SharedFolder other(folder.path());
    EXPECT_NE(shared.Proof(), other.Proof()) << "two jobs at once";
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SharedFolder, AnotherFolderUnderTheSamePathIsNamed) {
  const TemporaryFolder folder;
  std::optional<SharedFolder> shared(folder.path());
  const nlohmann::json proof = shared->Proof();
  shared.reset();
  // Of a former job.
  base::WriteFileAtomically(proof.at("file").get<std::string>(), "another number");
  const std::string error = InputErrorOf([&] { RequireSharedFolder(proof); });
  EXPECT_TRUE(error.starts_with(folder.path().string() + ": ")) << error;
  EXPECT_NE(error.find("all machines share"), std::string::npos) << error;
}

TEST(BytesSeen, IsTheSizeOrMinusOneWithoutTheFile) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "block.h5";
  EXPECT_EQ(BytesSeen(file), -1);
  base::WriteFileAtomically(file, "one");
  EXPECT_EQ(BytesSeen(file), 3);
}

}  // namespace
}  // namespace skyquilt::coordinator
