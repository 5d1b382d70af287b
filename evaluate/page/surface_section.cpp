#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"
#include "evaluate/surface/surface_scores.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr const char* kDash = "\xE2\x80\x93";
constexpr double kClassTau = 2.0;  // ground sampling distances, in the table by class

std::string CountOrDash(int64_t count) {
  return count < 0 ? kDash : FormatInteger(count);
}

std::string Centimetres(double metres) {
  return FormatFixed(100.0 * metres, 1, "cm");
}

// Nothing when that distance was not measured.
const surface::SurfaceFScore* FindTau(const surface::SurfaceAgreement& agreement, double gsd_count) {
  const std::string name = fmt::format("{:.0f} GSD", gsd_count);
  const auto found =
      std::find_if(agreement.f_scores.begin(), agreement.f_scores.end(), [&](const surface::SurfaceFScore& score) { return score.tau == name; });
  return found == agreement.f_scores.end() ? nullptr : &*found;
}

std::string MadeFacts(const surface::SurfaceScores& scores) {
  const surface::SurfaceRecord& record = scores.record;
  std::string html = "<dl class=\"card facts small\">";
  const auto fact = [&](const char* name, const std::string& value) { html += Fact(name, value); };
  fact("Triangles", CountOrDash(record.triangles));
  if (record.points >= 0) fact("Points of the cloud", FormatInteger(record.points));
  if (std::isfinite(record.area_m2)) fact("Area", FormatInteger(std::llround(record.area_m2)) + " m\xC2\xB2");
  if (std::isfinite(record.filled_m2)) fact("Closed holes and gaps", FormatFixed(record.filled_m2, 0, "m\xC2\xB2"));
  if (std::isfinite(record.voxel_m)) fact("Cells in which depths were fused", Centimetres(record.voxel_m));
  if (record.photos >= 0) {
    fact("Views", fmt::format("{} of photos, {} others", FormatInteger(record.photos), CountOrDash(record.virtual_views)));
  }
  if (record.edges >= 0) {
    fact("Edges", fmt::format("{}, of them {} at borders and {} with more than two triangles", FormatInteger(record.edges),
                              CountOrDash(record.boundary_edges), CountOrDash(record.non_manifold_edges)));
  }
  if (std::isfinite(record.seconds)) fact("Time", ShownDuration(record.seconds));
  return html + "</dl>";
}

std::string FileTable(const surface::SurfaceRecord& record) {
  if (record.files.empty()) return "";
  std::string html = BlockBegin("What was made") + TableBegin(Headings({"File", "Content", "Format", "Coordinates", "Heights above"}) +
                                                              NumberHeadings({"Size"}) + Headings({"Detail"}));
  for (const surface::SurfaceFile& file : record.files) {
    const std::string name = EscapeHtml(file.file);
    html += fmt::format("<tr><td><a href=\"../surface/{0}\">{0}</a></td>", name);
    for (const std::string* text : {&file.content, &file.format, &file.crs, &file.vertical}) html += TextCell(text->empty() ? kDash : *text);
    html += NumberCell(static_cast<double>(file.bytes), FormatBytes(file.bytes)) + TextCell(file.detail) + "</tr>";
  }
  return html + kTableEnd + "</div>\n";
}

std::string MeshCards(const ReportInput& input) {
  std::string html;
  for (size_t i = 0; i < input.images.size(); ++i) {
    const PhotoImages& images = input.images[i];
    if (images.mesh.empty()) continue;
    html += "<article class=\"card photo\"><header><h3>" + EscapeHtml(input.metrics->photos[i].name) + "</h3></header><div class=\"pics three\">";
    html += Picture("beside-photo-pic", images.photo, images.width, images.height, "Photo");
    html += Picture("beside-field-pic", images.render, images.width, images.height, "Field");
    html += Picture("beside-mesh-pic", images.mesh, images.width, images.height, "Mesh");
    html += "</div></article>\n";
  }
  return html.empty() ? html : "<div class=\"views\">" + html + "</div>";
}

// Pictures of the mesh and the field, whole and by class.
std::string PictureTable(const surface::SurfaceScores& scores) {
  if (scores.pixels == 0) return "";
  std::string html = BlockBegin("Mesh beside the field in held-out photos",
                                "PSNR over the covered pixels. Where the mesh has a hole its picture is black, which counts as an error. The first "
                                "two rows are means over the photos; rows of classes pool the pixels of all photos.") +
                     TableBegin(Headings({"Pixels"}) + NumberHeadings({"Mesh", "Field", "Difference", "Pixels without mesh"}), "");
  const auto row = [&](const char* name, double mesh_db, double field_db, double missing_share) {
    html += "<tr>" + TextCell(name) + FixedCell(mesh_db, 2, "dB") + FixedCell(field_db, 2, "dB") + FixedCell(mesh_db - field_db, 2, "dB") +
            PercentCell(missing_share) + "</tr>";
  };
  row("all covered pixels", scores.psnr, scores.psnr_field, scores.missing_share);
  row("those with mesh", scores.psnr_where_mesh, scores.psnr_field_where_mesh, 0.0);
  for (const surface::SurfaceClassScore& score : scores.classes) {
    if (score.pixels == 0) continue;
    row(score.name.c_str(), score.psnr_db, score.psnr_field_db, static_cast<double>(score.missing_pixels) / static_cast<double>(score.pixels));
  }
  return html + kTableEnd + "</div>\n";
}

std::string ScoreCells(const surface::SurfaceFScore& score) {
  return PercentCell(score.precision) + PercentCell(score.recall) + PercentCell(score.f);
}

std::string DistanceTables(const surface::SurfaceScores& scores) {
  if (scores.agreement.f_scores.empty()) return "";
  const std::string columns = NumberHeadings({"Precision", "Recall", "F-score"});
  std::string html = BlockBegin("Mesh against the true surface",
                                "Precision is the share of the mesh that is nearer to the true surface than the distance, recall the share of the "
                                "true surface that is nearer to the mesh, and the F-score their harmonic mean. Only surface counts that at least two "
                                "training photos see. An error of the geo-reference counts too.") +
                     TableBegin(Headings({"Distance"}) + NumberHeadings({"In metres"}) + columns, "");
  for (const surface::SurfaceFScore& score : scores.agreement.f_scores) {
    html += "<tr>" + TextCell(score.tau) + FixedCell(score.tau_m, 3, "m") + ScoreCells(score) + "</tr>";
  }
  std::string note = fmt::format("Median distance from the mesh to the true surface {}, from the true surface to the mesh {}.",
                                 Centimetres(scores.agreement.accuracy_median_m), Centimetres(scores.agreement.completeness_median_m));
  if (scores.deck_samples > 0) {
    note += fmt::format(
        " On flat roofs, {} of the mesh is within 2 GSD of the height of the deck, apart from what is within 1 m of an edge or of something that "
        "stands there.",
        FormatPercent(scores.decks_within_2_gsd, 2));
  }
  html += kTableEnd + Note(note) + "</div>\n";
  const bool by_class = std::any_of(scores.classes.begin(), scores.classes.end(),
                                    [](const surface::SurfaceClassScore& score) { return FindTau(score.agreement, kClassTau) != nullptr; });
  if (!by_class) return html;
  html += BlockBegin(fmt::format("By class, at {:.0f} GSD", kClassTau)) +
          TableBegin(Headings({"Surface"}) + columns + NumberHeadings({"Mesh to truth, median", "Truth to mesh, median"}), "");
  for (const surface::SurfaceClassScore& score : scores.classes) {
    const surface::SurfaceFScore* at_tau = FindTau(score.agreement, kClassTau);
    if (at_tau == nullptr) continue;
    const double accuracy_m = score.agreement.accuracy_median_m, completeness_m = score.agreement.completeness_median_m;
    html += "<tr>" + TextCell(score.name) + ScoreCells(*at_tau) + NumberCell(accuracy_m, Centimetres(accuracy_m)) +
            NumberCell(completeness_m, Centimetres(completeness_m)) + "</tr>";
  }
  return html + kTableEnd + "</div>\n";
}

}  // namespace

std::string SurfaceSection(const ReportInput& input) {
  if (!input.metrics->surface) return "";
  const surface::SurfaceScores& scores = *input.metrics->surface;
  std::string chips;
  if (std::isfinite(scores.psnr)) chips += Chip("PSNR of the mesh", FormatFixed(scores.psnr, 2, "dB"), "main");
  if (const surface::SurfaceFScore* at_tau = FindTau(scores.agreement, kClassTau)) {
    chips += Chip(fmt::format("F-score at {:.0f} GSD", kClassTau), FormatPercent(at_tau->f));
  }
  return SectionBegin("surface", "Surface", Chips(chips)) +
         Lead(
             "A textured mesh was made from the field, and from it the files below. The mesh is compared with photos that were "
             "kept out of training, beside the field itself.") +
         MadeFacts(scores) + FileTable(scores.record) + MeshCards(input) + PictureTable(scores) + DistanceTables(scores) + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
