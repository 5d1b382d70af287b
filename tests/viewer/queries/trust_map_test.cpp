#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/viewer/queries/analytic_field.h"
#include "viewer/queries/mean_map.h"

namespace skyquilt::viewer {
namespace {

// Level ground, one metre high, whose western half four photos show, with errors; of the eastern half nothing is known.
trust::Trust WestIsKnown() {
  std::vector<trust::Sighting> sightings;
  std::vector<trust::PixelFacts> facts;
  std::vector<float> errors;
  for (int x = -100; x < 0; x += 2) {
    for (int y = -100; y < 100; y += 2) {
      for (int photo = 0; photo < 4; ++photo) sightings.push_back({{x + 1.0, y + 1.0, 1.0}, photo, 1e-4F});
    }
  }
  trust::Trust trust{trust::EvidenceCells(sightings, 2.0), {}, {}};
  for (int i = 0; i < 400; ++i) {
    const bool known = i % 2 == 0;
    facts.push_back({trust.evidence.At({known ? -20.0 : 20.0, 0.0, 1.0}), 1.0F, 0.0F, 0.0F});
    errors.push_back(known ? 1e-4F : 0.02F);
  }
  trust.model = trust::ErrorModel(facts, errors);
  return trust;
}

TEST(TrustMap, ShowsWhatIsKnownOfThePlacesSeenFromAbove) {
  std::string png;
  const auto query = MakeTrustMap({.id = 5}, WestIsKnown(), [&](std::string picture) {
    png = std::move(picture);
    return std::string("pictures/2.png");
  });
  // No ground in the south.
  const nlohmann::json answer =
      AnswerOf(*query, AccessTo(FieldOf(Above([](double, double y) { return y > -50.0 ? std::optional(1.0) : std::nullopt; }))));
  EXPECT_EQ(answer["type"], "trust_map");
  EXPECT_EQ(answer["id"], 5);
  EXPECT_EQ(answer["url"], "pictures/2.png");
  EXPECT_NEAR(answer["scale"].get<double>(), 0.25, 1e-6);
  const cv::Mat picture = cv::imdecode(std::vector<uint8_t>(png.begin(), png.end()), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(picture.cols, MeanMap::kMaxSide);
  const auto at = [&](double x, double y) {
    const double cell = 200.0 / picture.cols;
    return picture.at<cv::Vec4b>(picture.rows - 1 - static_cast<int>((y + 100.0) / cell), static_cast<int>((x + 100.0) / cell));
  };
  EXPECT_EQ(at(-50, -70)[3], 0);
  EXPECT_EQ(at(-50, 20)[3], 255);
  EXPECT_EQ(at(50, 20)[3], 255);
  EXPECT_EQ(at(-50, 20), at(-20, 70));
  // From dark blue to yellow.
  EXPECT_GT(at(50, 20)[1], at(-50, 20)[1] + 20);
}

TEST(TrustMap, NeedsAFieldAndSomethingToSee) {
  const auto publish = [](std::string) { return std::string(); };
  EXPECT_THROW(MakeTrustMap({}, {}, {}), BadMessage);
  EXPECT_THROW(AnswerOf(*MakeTrustMap({}, {}, publish), AccessTo({})), BadMessage);
  EXPECT_THROW(AnswerOf(*MakeTrustMap({}, {}, publish), AccessTo(FieldOf(Above([](double, double) { return std::nullopt; })))), BadMessage);
}

}  // namespace
}  // namespace skyquilt::viewer
