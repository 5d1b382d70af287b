#include "tour/format/tour_file.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/tour/format/sample_tour.h"

namespace skyquilt::tour {
namespace {

std::string ErrorOf(const std::filesystem::path& folder) {
  try {
    LoadTourToPlay(folder);
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TourFile, IsSavedAndLoadedWithTheAssetsThatAreThere) {
  const TemporaryFolder folder;
  SaveTour(ParseTour(base::JsonText(SampleTour())), folder.path());
  std::filesystem::create_directories(AssetFolder(folder.path()));
  base::WriteFileAtomically(AssetFolder(folder.path()) / kSamplePicture, std::string(1234, 'x'));
  base::WriteFileAtomically(AssetFolder(folder.path()) / kSampleModel, "not 77 bytes");
  const PlayableTour playable = LoadTourToPlay(folder.path());
  EXPECT_EQ(playable.tour.stops[0].picture, kSamplePicture);
  EXPECT_EQ(playable.tour.things.size(), 3U);
  ASSERT_EQ(playable.missing.size(), 1U);
  EXPECT_NE(playable.missing[0].find("shed.glb"), std::string::npos) << "half a file is none";
}

TEST(TourFile, ErrorsNameTheFileAndTheRemedy) {
  const TemporaryFolder folder;
  EXPECT_NE(ErrorOf(folder.path()).find("--edit"), std::string::npos);
  base::WriteFileAtomically(TourFile(folder.path()), SampleTourWith([](nlohmann::json& json) { json["stops"][1]["pause_s"] = "long"; }));
  const std::string error = ErrorOf(folder.path());
  EXPECT_NE(error.find("tour.json"), std::string::npos);
  EXPECT_NE(error.find("stops[1].pause_s must be a number from 0"), std::string::npos) << error;
}

TEST(TourFile, ATourThatCouldNotBeReadIsNotSaved) {
  const TemporaryFolder folder;
  Tour tour = ParseTour(base::JsonText(SampleTour()));
  SaveTour(tour, folder.path());
  const std::string before = base::ReadFile(TourFile(folder.path()));
  tour.stops[1].id = "gate";
  EXPECT_THROW(SaveTour(tour, folder.path()), base::InputError);
  EXPECT_EQ(base::ReadFile(TourFile(folder.path())), before);
}

}  // namespace
}  // namespace skyquilt::tour
