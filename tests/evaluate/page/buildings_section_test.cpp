#include "evaluate/page/buildings_section.h"

#include <gtest/gtest.h>

#include "core/base/pattern.h"
#include "evaluate/page/building_numbers.h"
#include "tests/evaluate/buildings/buildings_sample.h"
#include "tests/evaluate/page/sample_report.h"
#include "tests/support/count_of.h"

namespace skyquilt::evaluate::page {
namespace {

// A report without photos.
struct BuildingsPage : ReportParts {
  buildings::BuildingsReport report;

  explicit BuildingsPage(buildings::ComparedBuildings compared) {
    survey.georeferenced = true;
    report.compared = std::move(compared);
    base::ThreadPool threads(1);
    metrics.buildings = buildings::ScoreBuildings(report.compared, threads);
    input.buildings = &report;
  }
};

buildings::ComparedBuildings Untrue(buildings::BuildingSet set) {
  buildings::ComparedBuildings compared;
  compared.set = std::move(set);
  return compared;
}

void ExpectSound(const std::string& html) {
  for (const char* tag :
       {"section", "table", "tbody", "tr", "td", "th", "svg", "a", "article", "details", "figure", "div", "dl", "p", "span", "text"}) {
    const std::string name(tag);
    EXPECT_EQ(CountOf(html, "<" + name + " ") + CountOf(html, "<" + name + ">"), CountOf(html, "</" + name + ">")) << name;
  }
  EXPECT_EQ(CountOf(html, "nan") + CountOf(html, ">inf"), 0U);
  for (const base::PatternMatch& link : base::FindAll(html, "href=\"#([^\"]+)\"")) {
    EXPECT_EQ(CountOf(html, "id=\"" + link[1] + "\""), 1U) << link[1];
  }
}

TEST(ShownMeasure, HasTwoDigitsOfUncertaintyAndAValueToMatch) {
  const auto shown = [](double value, double sigma) {
    std::string text = ShownMeasure({value, sigma}, "m");
    for (size_t at = text.find("\xE2\x80\xAF"); at != std::string::npos; at = text.find("\xE2\x80\xAF")) text.replace(at, 3, " ");
    return text;
  };
  EXPECT_EQ(shown(8.5342, 0.1234), "8.53 \xC2\xB1 0.12 m");
  EXPECT_EQ(shown(8.5342, 0.0996), "8.53 \xC2\xB1 0.10 m");
  EXPECT_EQ(shown(8.5342, 0.0123), "8.534 \xC2\xB1 0.012 m");
  EXPECT_EQ(shown(8.5342, 1.26), "8.5 \xC2\xB1 1.3 m");
  EXPECT_EQ(shown(98.6, 12.2), "99 \xC2\xB1 12 m");
  EXPECT_EQ(shown(1234.0, 156.0), "1230 \xC2\xB1 160 m");
  EXPECT_EQ(shown(-0.5, 0.1),
            "\xE2\x88\x92"
            "0.50 \xC2\xB1 0.10 m");
  EXPECT_EQ(shown(8.5342, skyquilt::buildings::kUnknown), "8.53 m");
  EXPECT_EQ(shown(8.5342, 0.0), "8.53 m");
  EXPECT_EQ(shown(skyquilt::buildings::kUnknown, 0.1), "\xE2\x80\x93");
}

TEST(BuildingsSection, HasMapTableCardsAndPlans) {
  BuildingsPage page(Untrue(buildings::MadeTown(3)));
  buildings::Building& first = page.report.compared.set.buildings[0];
  first.measures.height_m.sigma = 0.1234;
  first.note = "only <seen> from above & far away";
  first.given_id = "<b>12\"";
  first.accepted = false;
  page.report.pictures.resize(3);
  page.report.pictures[1] = {"images/building_2.jpg", "DJI <2>.jpg", 640, 400};
  page.report.map_height_m = {400.0, 400.0, 400.0};
  page.report.vertical = "WGS84 ellipsoid (EPSG:4979)";
  page.report.files = {"buildings.csv"};
  const std::string html = BuildingsSection(page.input);
  ExpectSound(html);
  for (const char* text : {"id=\"buildings\"", "building-map", "class=\"scale\"", "class=\"north\"", "table class=\"sortable\"", "class=\"plan\"",
                           "12.00\xE2\x80\xAFm</text>"}) {
    EXPECT_NE(html.find(text), std::string::npos) << text;
  }
  EXPECT_NE(html.find("\xC2\xB1\xE2\x80\xAF"
                      "0.12\xE2\x80\xAFm"),
            std::string::npos);
  EXPECT_EQ(CountOf(html, "class=\"card photo building\""), 3U);
  EXPECT_EQ(CountOf(html, "<path class=\"footprint"), 3U);
  EXPECT_EQ(CountOf(html, "footprint unsure"), 1U);
  EXPECT_NE(html.find("the model does not fit well"), std::string::npos);
  EXPECT_NE(html.find("src=\"images/building_2.jpg\""), std::string::npos);
  EXPECT_EQ(CountOf(html, "No photo shows it"), 2U);
  EXPECT_NE(html.find("only &lt;seen&gt; from above &amp; far away"), std::string::npos);
  EXPECT_EQ(html.find("<seen>"), std::string::npos);
  EXPECT_EQ(html.find("<b>12"), std::string::npos);
  EXPECT_EQ(html.find("DJI <2>"), std::string::npos);
  EXPECT_NE(html.find("500.00\xE2\x80\xAFm"), std::string::npos) << "the ground at 100 m, as on a map";
  EXPECT_NE(html.find("WGS84 ellipsoid"), std::string::npos);
  EXPECT_NE(html.find("href=\"../buildings/buildings.csv\""), std::string::npos);
  // Nothing is said of a truth that nobody knows.
  for (const char* absent : {"Completeness", "invented", "missed", "Truth", "Mean error"}) EXPECT_EQ(html.find(absent), std::string::npos) << absent;
  const std::string whole = BuildReportPage(page.input);
  EXPECT_NE(whole.find(html), std::string::npos);
  EXPECT_EQ(CountOf(whole, "href=\"#buildings\""), 1U);
}

TEST(BuildingsSection, MarksWhatWasMissedAndInvented) {
  buildings::BuildingSet set = buildings::MadeTown(5);
  buildings::TrueBuildings truth = buildings::TruthOf(set);
  truth.outlines[4].inside = false;
  truth.outlines[0].kind = "<house>";
  set.buildings.erase(set.buildings.begin());
  skyquilt::buildings::HousePlan elsewhere;
  elsewhere.origin = {80.0, 80.0};
  set.buildings.push_back(skyquilt::buildings::MadeHouse(elsewhere, 77));
  const BuildingsPage page(buildings::Compared(set, truth));
  const std::string html = BuildingsSection(page.input);
  ExpectSound(html);
  EXPECT_EQ(CountOf(html, "<path class=\"missed\""), 1U);
  EXPECT_EQ(CountOf(html, "<path class=\"uncounted\""), 1U);
  EXPECT_EQ(CountOf(html, "footprint invented"), 1U);
  EXPECT_EQ(html.find("<house>"), std::string::npos);
  for (const char* text : {"Found and missed", "Errors of the measures", "75.0\xE2\x80\xAF%" /* 3 of 4 */, "60.0\xE2\x80\xAF%" /* quality */,
                           "over 50 m\xC2\xB2", "<td>deck</td>", "The kind of roof is right for 100.0\xE2\x80\xAF%", "true outline that was missed",
                           "invented</span>", "not counted</span>", "outline 1"}) {
    EXPECT_NE(html.find(text), std::string::npos) << text;
  }
}

TEST(BuildingsSection, OnlyTheLargestHaveCards) {
  const BuildingsPage page(Untrue(buildings::MadeTown(70)));
  const std::string html = BuildingsSection(page.input);
  ExpectSound(html);
  EXPECT_EQ(CountOf(html, "class=\"card photo building\""), buildings::kBuildingCards);
  EXPECT_EQ(CountOf(html, "<tr id=\"building-row-"), 70U);
  EXPECT_NE(html.find("of the 60 largest of 70 buildings"), std::string::npos);
  EXPECT_NE(html.find("48 smaller buildings"), std::string::npos);
  // The map leads to the row of those without.
  EXPECT_EQ(CountOf(html, "href=\"#building-row-"), 10U);
  const std::vector<size_t> order = buildings::BuildingsWithCards(page.report.compared.set);
  for (size_t i = 1; i < order.size(); ++i) {
    const auto area = [&](size_t k) { return Area(page.report.compared.set.buildings[order[k]].footprint); };
    EXPECT_GE(area(i - 1), area(i) - 1e-9);
  }
}

TEST(BuildingsSection, WithoutAScaleThereIsNoUnit) {
  buildings::BuildingSet set = buildings::MadeTown(3);
  set.metric = false;
  set.scale_source = "unknown";
  set.buildings[0].measures.length_m.sigma = 0.25;
  set.buildings[0].measures.volume_m3.sigma = 2.5;
  BuildingsPage page(Untrue(set));
  page.survey.georeferenced = false;
  const std::string html = BuildingsSection(page.input);
  ExpectSound(html);
  for (const char* unit : {"\xE2\x80\xAFm", " m<", "m\xC2\xB2", "m\xC2\xB3",
                           "\xE2\x80\xAF"
                           "cm"}) {
    EXPECT_EQ(html.find(unit), std::string::npos) << unit;
  }
  EXPECT_NE(html.find("the scale is unknown"), std::string::npos);
  EXPECT_NE(html.find("12.00\xE2\x80\xAF\xC2\xB1\xE2\x80\xAF"
                      "0.25<"),
            std::string::npos);
}

TEST(BuildingsSection, SaysInOneSentenceThatNothingWasFound) {
  const BuildingsPage page(Untrue({}));
  const std::string html = BuildingsSection(page.input);
  ExpectSound(html);
  EXPECT_NE(html.find("No buildings were found."), std::string::npos);
  EXPECT_EQ(html.find("<table"), std::string::npos);
  EXPECT_EQ(html.find("<svg"), std::string::npos);
  // With a truth it is known what was missed.
  const BuildingsPage missed(buildings::Compared({}, buildings::TruthOf(buildings::MadeTown(3))));
  const std::string all_missed = BuildingsSection(missed.input);
  ExpectSound(all_missed);
  EXPECT_EQ(CountOf(all_missed, "<path class=\"missed\""), 3U);
  EXPECT_NE(all_missed.find("<td class=\"num\" data-v=\"0\">0.0\xE2\x80\xAF%</td>"), std::string::npos);
}

TEST(BuildingsSection, IsAbsentWhenNoBuildingsWereSearched) {
  BuildingsPage page(Untrue(buildings::MadeTown(1)));
  page.input.buildings = nullptr;
  EXPECT_EQ(BuildingsSection(page.input), "");
  EXPECT_EQ(BuildReportPage(page.input).find("#buildings"), std::string::npos);
}

TEST(BuildingPlan, ShowsTheWallsOfCompoundShapesAndRidges) {
  buildings::BuildingSet set;
  skyquilt::buildings::HousePlan flat;
  flat.roof = buildings::RoofKind::kFlat;
  const std::string l_shape = BuildingPlan(skyquilt::buildings::MadeLHouse(flat), set);
  EXPECT_EQ(CountOf(l_shape, "<text"), 6U) << "each wall of an L";
  EXPECT_EQ(l_shape.find("class=\"ridge\""), std::string::npos);
  const std::string gable = BuildingPlan(skyquilt::buildings::MadeHouse({}), set);
  EXPECT_EQ(CountOf(gable, "<text"), 2U);
  EXPECT_NE(gable.find("class=\"ridge\""), std::string::npos);
  const std::string court = BuildingPlan(skyquilt::buildings::MadeCourtyard(flat, 2.5), set);
  const size_t walls = court.find("class=\"walls\"");
  EXPECT_EQ(CountOf(court.substr(walls, court.find("/>", walls) - walls), "Z"), 2U) << "the yard is a hole";
  set.scale = 2.0;
  EXPECT_NE(BuildingPlan(skyquilt::buildings::MadeHouse({}), set).find("24.00"), std::string::npos) << "a scale bar stretches lengths";
  EXPECT_EQ(BuildingPlan(buildings::Building{}, set), "");
}

}  // namespace
}  // namespace skyquilt::evaluate::page
