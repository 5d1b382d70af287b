// Files of control points in one format, FUZZ_FORMAT. An input is one of its files; its first byte says which one. The others are valid.
#include <iterator>
#include <string_view>

#include "prepare/control/reading/control_checks.h"
#include "prepare/control/reading/read_control.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/prepare/control/reading/made_control_files.h"

namespace skyquilt::fuzz {
namespace {

constexpr std::string_view kFormat = FUZZ_FORMAT;
constexpr const char* kCrs = "EPSG:2263";

struct Control {
  test::MadeControl made = test::MakeControl();
  test::ControlTexts texts;
  prepare::control::ControlFiles files;
  TemporaryFolder folder;
  Control() {
    files.crs = kCrs;
    if (kFormat == "odm") {
      texts = test::OdmFiles(made, kCrs);
      files.points = folder / "gcp_list.txt";
      files.crs.clear();
    } else if (kFormat == "opensfm") {
      texts = test::OpensfmControlFiles(made);
      files.points = folder / "ground_control_points.json";
      files.crs.clear();
    } else if (kFormat == "pix4d") {
      texts = test::Pix4dFiles(made, kCrs);
      files.points = folder / "points.csv";
      files.marks = folder / "marks.csv";
    } else {
      texts = test::MetashapeControlFiles(made, kCrs);
      files.points = folder / "reference.csv";
      files.marks = folder / "markers.xml";
    }
    test::WriteTexts(texts, folder.path());
  }
};

const Control& Whole() {
  static const Control whole;
  return whole;
}

}  // namespace

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (const auto& [name, text] : Whole().texts) seeds.push_back(std::string(1, static_cast<char>('0' + static_cast<char>(seeds.size()))) + text);
  return seeds;
}

void Feed(const std::string& bytes) {
  if (bytes.empty()) return;
  const Control& whole = Whole();
  const size_t which = static_cast<unsigned char>(bytes[0] - '0') % whole.texts.size();
  const auto& [name, text] = *std::next(whole.texts.begin(), static_cast<std::ptrdiff_t>(which));
  test::WriteTexts({{name, bytes.substr(1)}}, whole.folder.path());
  try {
    const prepare::control::ControlPoints control = prepare::control::ReadControl(whole.files, whole.made.photos);
    prepare::control::CheckNear(control, {whole.made.points[0].place});
    prepare::control::CheckGeometry(control, true);
  } catch (const base::InputError&) {
  }
  test::WriteTexts({{name, text}}, whole.folder.path());
}

}  // namespace skyquilt::fuzz
