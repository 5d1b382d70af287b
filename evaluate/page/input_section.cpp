
#include "core/base/text.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

namespace {

std::string Counted(int64_t n, const char* one, const char* several) {
  return FormatInteger(n) + " " + (n == 1 ? one : several);
}

std::string GroupRow(const InputGroup& group) {
  const std::string reason = group.several ? "each its own, such as: " + group.reason : group.reason;
  const bool more = group.n > static_cast<int64_t>(group.examples.size());
  return "<tr>" + TextCell(group.kind) + TextCell(group.taken ? "yes" : "no") + CountCell(group.n) + TextCell(reason) +
         TextCell(base::Join(group.examples) + (more ? ", ..." : "")) + "</tr>";
}

}  // namespace

std::string InputSection(const ReportInput& input) {
  const InputFiles& files = input.files;
  if (!files.Remarkable()) return "";
  std::string lead = Counted(files.n_taken, "photo was", "photos were") + " taken, ";
  lead += files.n_left_out > 0 ? Counted(files.n_left_out, "other file or folder was", "other files and folders were") + " left out."
                               : std::string("and nothing was left out.");
  lead += " Every file is in survey/input.csv; prepare.photos chooses others.";
  std::string html = SectionBegin("input", "Photo folder") + Lead(lead) +
                     TableBegin(Headings({"Kind", "Taken as photos"}) + NumberHeadings({"Files"}) + Headings({"Reason", "Such as"}));
  for (const InputGroup& group : files.groups) html += GroupRow(group);
  return html + kTableEnd + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
