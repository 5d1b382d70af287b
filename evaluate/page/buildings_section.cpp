#include "evaluate/page/buildings_section.h"

#include <fmt/core.h>

#include "evaluate/page/building_numbers.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {
namespace {

// "10 to 50 m2" as "10 to 50 m²".
std::string ShownSize(std::string size) {
  if (size.ends_with("m2")) size.replace(size.size() - 1, 1, "\xC2\xB2");
  return size;
}

std::string DetectionTable(const buildings::BuildingTruthScores& truth) {
  std::string html =
      BlockBegin(
          "Found and missed",
          "A building is found when its footprint and that of a true outline share at least half of what either covers. Completeness is the share of "
          "the true that was found, correctness the share of the found that is true, and quality what is both over what is either; per building, "
          "then per area. Outlines below 10 m\xC2\xB2 or not wholly inside the surveyed area count neither as missed nor as found.") +
      TableBegin(Headings({"Size"}) + NumberHeadings({"True outlines", "Found", "Missed", "Invented", "Completeness", "Correctness", "Quality",
                                                      "Completeness, area", "Correctness, area", "Quality, area"}),
                 "");
  for (const buildings::BuildingDetection& score : truth.detection) {
    html += "<tr>" + TextCell(ShownSize(score.size)) + CountCell(score.outlines) + CountCell(score.matched) + CountCell(score.missed) +
            CountCell(score.invented) + PercentCell(score.completeness) + PercentCell(score.correctness) + PercentCell(score.quality) +
            PercentCell(score.completeness_area) + PercentCell(score.correctness_area) + PercentCell(score.quality_area) + "</tr>";
  }
  html += kTableEnd;
  if (truth.outlines_not_counted + truth.found_not_counted > 0) {
    html += Note(fmt::format("Not counted: {} true outlines and {} found buildings.", FormatInteger(truth.outlines_not_counted),
                             FormatInteger(truth.found_not_counted)));
  }
  return html + "</div>\n";
}

const char* UnitOfMeasure(const std::string& measure) {
  return measure == "yaw" ? kDegree : measure == "footprint" ? "m\xC2\xB2" : "m";
}

std::string ErrorRow(const buildings::BuildingRoofScores& roof, const buildings::BuildingErrors& errors) {
  const auto figure = [&](double value) { return FixedCell(value, 2, UnitOfMeasure(errors.measure)); };
  return "<tr>" + TextCell(errors.measure) + TextCell(roof.roof) + CountCell(errors.n) + figure(errors.bias) + figure(errors.rmse) +
         figure(errors.nmad) + figure(errors.median_abs) + figure(errors.p90_abs) + PercentCell(errors.within_sigma) + "</tr>";
}

std::string ErrorTable(const buildings::BuildingTruthScores& truth) {
  std::string rows;
  for (const buildings::BuildingRoofScores& roof : truth.roofs) {
    for (const buildings::BuildingErrors& errors : roof.errors) rows += ErrorRow(roof, errors);
  }
  if (rows.empty()) return "";
  return BlockBegin("Errors of the measures",
                    "Found minus true, of all matched buildings and by true kind of roof. NMAD is 1.4826 times the median distance of the errors "
                    "from their median: the standard deviation, if errors are normal. The last column should be 95\xE2\x80\xAF%: more means that the "
                    "stated uncertainties are too large, less that they are too small. An error of the geo-reference counts too.") +
         TableBegin(Headings({"Measure", "Roof"}) +
                    NumberHeadings({"Buildings", "Mean error", "RMSE", "NMAD", "Median size", "90\xE2\x80\xAF% are below", "Within 1.96 \xCF\x83"})) +
         rows + kTableEnd + "</div>\n";
}

std::string RoofNote(const buildings::BuildingTruthScores& truth) {
  std::string text;
  for (const buildings::BuildingRoofScores& roof : truth.roofs) {
    if (roof.matched == 0) continue;
    text += fmt::format("{}{} of {} {}", text.empty() ? "The kind of roof is right for " : "; ", FormatPercent(roof.roof_right),
                        FormatInteger(roof.matched), roof.roof == "all" ? "buildings" : EscapeHtml(roof.roof) + " roofs");
  }
  if (text.empty()) return "";
  text += fmt::format(". Of {} corners of true outlines {} have a found corner within 3 m, with an RMSE of {}.", FormatInteger(truth.corners),
                      FormatPercent(truth.corners_found), FormatFixed(truth.corner_rmse_m, 2, "m"));
  return Note(text) + "\n";
}

std::string ScaleSentence(const buildings::BuildingsReport& report) {
  const buildings::BuildingSet& set = report.compared.set;
  if (!set.metric) {
    return " Lengths have no unit, because the scale is unknown: photos with GPS tags, or a length measured on site (buildings.scale_bar), would "
           "give it.";
  }
  std::string text = set.scale_source == "scale bar" ? " The scale is that of the given scale bar." : "";
  if (!report.vertical.empty()) {
    text += " Heights of ground, eave and ridge have this reference: " + EscapeHtml(report.vertical) + ".";
  }
  return text;
}

std::string FileLinks(const buildings::BuildingsReport& report) {
  std::string links;
  for (const std::string& file : report.files) {
    links += fmt::format("{0}<a href=\"../buildings/{1}\">{1}</a>", links.empty() ? "Files: " : ", ", EscapeHtml(file));
  }
  return links.empty() ? "" : Note(links + ".") + "\n";
}

std::string SolidNote(const buildings::BuildingScores& scores) {
  std::string text;
  if (scores.blocks_instead > 0) {
    text += fmt::format("{} {} a plain block instead of a solid with a roof. ", FormatInteger(scores.blocks_instead),
                        scores.blocks_instead == 1 ? "building has" : "buildings have");
  }
  text += scores.solids_rejected + scores.blocks_rejected == 0
              ? "All solids are closed and valid."
              : fmt::format("{} solids with roofs and {} blocks are not valid.", FormatInteger(scores.solids_rejected),
                            FormatInteger(scores.blocks_rejected));
  return Note(text) + "\n";
}

std::string ChipsOf(const buildings::BuildingScores& scores, const BuildingUnits& units) {
  std::string html = Chip(scores.found == 1 ? "building" : "buildings", FormatInteger(scores.found), "main") +
                     Chip("fit well", FormatInteger(scores.accepted)) + Chip("footprints", FormatFixed(scores.footprint_m2, 0, units.area)) +
                     Chip("volume", FormatFixed(scores.volume_m3, 0, units.volume));
  if (scores.truth && !scores.truth->detection.empty()) {
    html += Chip("completeness", FormatPercent(scores.truth->detection.front().completeness)) +
            Chip("correctness", FormatPercent(scores.truth->detection.front().correctness));
  }
  return html;
}

}  // namespace

std::string BuildingScoreTables(const buildings::BuildingScores& scores) {
  return scores.truth ? DetectionTable(*scores.truth) + ErrorTable(*scores.truth) + RoofNote(*scores.truth) : "";
}

std::string BuildingsSection(const ReportInput& input) {
  if (input.buildings == nullptr || !input.metrics->buildings) return "";
  const buildings::BuildingsReport& report = *input.buildings;
  const buildings::BuildingScores& scores = *input.metrics->buildings;
  const buildings::BuildingSet& set = report.compared.set;
  if (set.buildings.empty()) {
    return SectionBegin("buildings", "Buildings") + EmptyCard("No buildings were found.") + "\n" +
           (report.compared.truth && !report.compared.truth->outlines.empty() ? BuildingsMap(input) : "") + BuildingScoreTables(scores) +
           "</section>\n";
  }
  const std::string lead =
      "Found in the points of the surface and measured by fitting walls and roofs to them. Length and width are between outer "
      "walls, without the roof's overhang; the direction is that of the length, counter-clockwise from east. The figure after \xC2\xB1 is one "
      "standard deviation." +
      ScaleSentence(report);
  return SectionBegin("buildings", "Buildings", Chips(ChipsOf(scores, BuildingUnits::Of(set)))) + Lead(lead) + BuildingsMap(input) +
         "<div class=\"block\">" + BuildingsTable(report) + "</div>" + FileLinks(report) + SolidNote(scores) + BuildingCards(report) +
         BuildingScoreTables(scores) + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
