#include <fmt/core.h>

#include "evaluate/page/building_numbers.h"
#include "evaluate/page/buildings_section.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {
namespace {

constexpr size_t kUnfoldedCards = 12;

// Measures of heights as a map has them.
buildings::Measure OnMap(const buildings::BuildingsReport& report, size_t index, buildings::Measure height) {
  if (index < report.map_height_m.size()) height.value += report.map_height_m[index];
  return height;
}

std::string FateChip(const buildings::BuildingsReport& report, size_t index) {
  if (report.compared.matches.found.empty()) return "";
  switch (report.compared.matches.found[index]) {
    case buildings::FoundFate::kMatched:
      return "";
    case buildings::FoundFate::kInvented:
      return State("bad", "invented");
    case buildings::FoundFate::kNotCounted:
      return State("idle", "not counted");
  }
  return "";
}

std::string StateOf(const buildings::Building& building) {
  return building.accepted ? State("good", "fits") : State("warn", "fits poorly");
}

std::string FactsOf(const buildings::BuildingsReport& report, size_t index) {
  const buildings::Building& building = report.compared.set.buildings[index];
  const skyquilt::buildings::Measures& measures = building.measures;
  const BuildingUnits units = BuildingUnits::Of(report.compared.set);
  std::string html = "<dl class=\"facts small\">";
  const auto fact = [&](const char* name, const buildings::Measure& measure, const char* unit) { html += Fact(name, ShownMeasure(measure, unit)); };
  fact("Height", measures.height_m, units.length);
  fact("Length", measures.length_m, units.length);
  fact("Width", measures.width_m, units.length);
  fact("Ground", OnMap(report, index, measures.ground_m), units.length);
  if (building.roof == buildings::RoofKind::kGable || building.roof == buildings::RoofKind::kHip) {
    fact("Eave", OnMap(report, index, measures.eave_m), units.length);
    fact("Ridge", OnMap(report, index, measures.ridge_m), units.length);
    fact("Pitch", measures.pitch_deg, kDegree);
  } else {
    fact("Roof", OnMap(report, index, measures.ridge_m), units.length);
  }
  fact("Direction", measures.yaw_deg, kDegree);
  fact("Footprint", measures.footprint_m2, units.area);
  fact("Roof area", measures.roof_m2, units.area);
  fact("Volume", measures.volume_m3, units.volume);
  html += Fact("Walls seen", FormatPercent(measures.wall_seen, 0));
  return html + "</dl>";
}

std::string CardOf(const buildings::BuildingsReport& report, size_t index) {
  const buildings::Building& building = report.compared.set.buildings[index];
  std::string html = fmt::format("<article class=\"card photo building\" id=\"building-{0}\"><header><h3>Building {0}{1}</h3><div class=\"chips\">",
                                 building.id, building.given_id.empty() ? "" : " (" + EscapeHtml(building.given_id) + ")");
  html += fmt::format("<span class=\"chip\"><b>{}</b>roof</span>", NameOf(building.roof)) +
          Chip("within 2 GSD", FormatPercent(building.share_within, 0)) + StateOf(building) + FateChip(report, index) +
          "</div></header><div class=\"building-grid\">";
  if (index < report.pictures.size() && !report.pictures[index].file.empty()) {
    const buildings::BuildingPicture& picture = report.pictures[index];
    html += Picture("building-pic", picture.file, picture.width, picture.height, "Model over photo " + picture.photo);
  } else {
    html += "<p class=\"empty\">No photo shows it.</p>";
  }
  html += "<figure class=\"plan-figure\">" + BuildingPlan(building, report.compared.set) + "</figure>" + FactsOf(report, index) + "</div>";
  if (!building.note.empty()) html += Note("Note: " + EscapeHtml(building.note) + ".");
  return html + "</article>\n";
}

}  // namespace

std::string BuildingCards(const buildings::BuildingsReport& report) {
  const std::vector<size_t> order = buildings::BuildingsWithCards(report.compared.set);
  if (order.empty()) return "";
  std::string html = "<div class=\"views\">";
  for (size_t i = 0; i < order.size() && i < kUnfoldedCards; ++i) html += CardOf(report, order[i]);
  html += "</div>";
  if (order.size() > kUnfoldedCards) {
    html += fmt::format("<details><summary>{} smaller buildings</summary><div class=\"views\">", order.size() - kUnfoldedCards);
    for (size_t i = kUnfoldedCards; i < order.size(); ++i) html += CardOf(report, order[i]);
    html += "</div></details>";
  }
  if (order.size() < report.compared.set.buildings.size()) {
    html += Note(fmt::format("Pictures and plans are shown of the {} largest of {} buildings; the table has all of them.", order.size(),
                             report.compared.set.buildings.size()));
  }
  return html;
}

std::string BuildingsTable(const buildings::BuildingsReport& report) {
  const buildings::BuildingSet& set = report.compared.set;
  if (set.buildings.empty()) return "";
  const BuildingUnits units = BuildingUnits::Of(set);
  const buildings::BuildingMatches& matches = report.compared.matches;
  std::vector<bool> carded(set.buildings.size());
  for (const size_t index : buildings::BuildingsWithCards(set)) carded[index] = true;
  std::string columns = NumberHeadings({"Building"}) + Headings({"Roof"}) +
                        NumberHeadings({"Height", "Length", "Width", "Footprint", "Volume", "Ground", "Eave", "Ridge or deck", "Direction", "Pitch",
                                        "Roof area", "Walls seen", "Within 2 GSD"}) +
                        Headings({"Model"});
  if (report.compared.truth) columns += Headings({"Truth"}) + NumberHeadings({"Overlap"});
  std::string html = TableBegin(columns + Headings({"Note"}));
  for (size_t i = 0; i < set.buildings.size(); ++i) {
    const buildings::Building& building = set.buildings[i];
    const skyquilt::buildings::Measures& measures = building.measures;
    html += fmt::format("<tr id=\"building-row-{0}\"><td class=\"num\" data-v=\"{0}\">", building.id);
    html += (carded[i] ? fmt::format("<a href=\"#building-{0}\">{0}</a>", building.id) : std::to_string(building.id)) + "</td>";
    html += TextCell(NameOf(building.roof)) + MeasureCell(measures.height_m, units.length) + MeasureCell(measures.length_m, units.length) +
            MeasureCell(measures.width_m, units.length) + MeasureCell(measures.footprint_m2, units.area) +
            MeasureCell(measures.volume_m3, units.volume) + MeasureCell(OnMap(report, i, measures.ground_m), units.length) +
            MeasureCell(OnMap(report, i, measures.eave_m), units.length) + MeasureCell(OnMap(report, i, measures.ridge_m), units.length) +
            MeasureCell(measures.yaw_deg, kDegree) + MeasureCell(measures.pitch_deg, kDegree) + MeasureCell(measures.roof_m2, units.area) +
            PercentCell(measures.wall_seen, 0) + PercentCell(building.share_within, 0) + "<td>" + StateOf(building) + "</td>";
    if (report.compared.truth) {
      const std::optional<size_t> pair = matches.pair_of_found[i];
      const double overlap = pair ? matches.pairs[*pair].overlap : kNotMeasured;
      html += "<td>" + (pair ? fmt::format("outline {}", report.compared.truth->outlines[matches.pairs[*pair].truth].id) : FateChip(report, i)) +
              "</td>" + PercentCell(overlap, 0);
    }
    html += TextCell(building.note) + "</tr>";
  }
  return html + kTableEnd + "\n";
}

}  // namespace skyquilt::evaluate::page
