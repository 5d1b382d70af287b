#include "worker/robust/rejected_pixels.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::worker {
namespace {

RC_GTEST_PROP(RejectedPixels, AreThoseOfTheirCellsAlsoAfterSavingAndLoading, ()) {
  const int cell_px = *rc::gen::inRange(1, 9), width = *rc::gen::inRange(1, 60), height = *rc::gen::inRange(1, 60);
  const int columns = (width + cell_px - 1) / cell_px, rows = (height + cell_px - 1) / cell_px;
  const auto n = static_cast<size_t>(columns) * static_cast<size_t>(rows);
  const auto cells = *rc::gen::container<std::vector<uint8_t>>(n, rc::gen::inRange<uint8_t>(0, 2));
  RejectedPixels made(3, cell_px);
  made.Set(1, columns, rows, cells);
  const TemporaryFolder folder;
  made.Save("key", folder.path() / "rejected.bin");
  const RejectedPixels loaded = RejectedPixels::Load("key", folder.path() / "rejected.bin");
  for (const RejectedPixels* one : std::initializer_list<const RejectedPixels*>{&made, &loaded}) {
    RC_ASSERT(one->photos() == 3U);
    RC_ASSERT(one->cell_px() == cell_px);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto cell = static_cast<size_t>(y / cell_px) * static_cast<size_t>(columns) + static_cast<size_t>(x / cell_px);
        RC_ASSERT(one->At(1, x, y) == (cells[cell] != 0));
        RC_ASSERT(!one->At(0, x, y));
      }
    }
    const auto rejected = static_cast<double>(std::count(cells.begin(), cells.end(), uint8_t{1}));
    RC_ASSERT(std::abs(one->Share(1) - rejected / static_cast<double>(n)) < 1e-12);
  }
}

TEST(RejectedPixels, OfNoPhotosRejectNothing) {
  EXPECT_FALSE(RejectedPixels().At(0, 3, 5));
  EXPECT_EQ(RejectedPixels().Share(0), 0.0);
}

TEST(RejectedPixels, FilesThatAreDamagedOrOfAnotherTrainingAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "rejected.bin";
  RejectedPixels pixels(2, 4);
  pixels.Set(0, 3, 2, {0, 1, 0, 0, 1, 1});
  pixels.Save("one", file);
  EXPECT_NE(InputErrorOf([&] { RejectedPixels::Load("two", file); }).find("belongs to another training"), std::string::npos);
  const std::string content = base::ReadFile(file);
  for (size_t end = 0; end < content.size(); end += 3) {
    base::WriteFileAtomically(file, content.substr(0, end));
    EXPECT_NE(InputErrorOf([&] { RejectedPixels::Load("one", file); }).find("is damaged"), std::string::npos) << end;
  }
  for (size_t i = 0; i < content.size(); i += 3) {
    std::string changed = content;
    changed[i] = static_cast<char>(changed[i] ^ 4);
    base::WriteFileAtomically(file, changed);
    EXPECT_THROW(RejectedPixels::Load("one", file), base::InputError) << i;
  }
}

}  // namespace
}  // namespace skyquilt::worker
