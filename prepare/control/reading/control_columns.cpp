#include "prepare/control/reading/control_columns.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>

namespace skyquilt::prepare::control {
namespace {

using Names = std::map<std::string, ControlColumn>;

const Names& PointNames() {
  static const Names names = [] {
    Names all;
    const auto add = [&](ControlColumn column, std::initializer_list<const char*> words) {
      for (const char* word : words) all[word] = column;
    };
    add(ControlColumn::kLabel, {"label", "name", "id", "point", "pointname", "gcp", "gcpname", "gcplabel", "marker"});
    add(ControlColumn::kX, {"x", "e", "east", "easting", "lon", "long", "longitude", "gpslongitude"});
    add(ControlColumn::kY, {"y", "n", "north", "northing", "lat", "latitude", "gpslatitude"});
    add(ControlColumn::kZ, {"z", "h", "up", "height", "altitude", "alt", "elevation", "ellipsoidalheight", "gpsaltitude"});
    add(ControlColumn::kSigma, {"accuracy", "sigma", "sxyz"});
    add(ControlColumn::kHorizontalSigma,
        {"accuracyhorz", "accuracyhorizontal", "horizontalaccuracy", "horizontalsigma", "accuracyxy", "xyaccuracy", "sxy"});
    add(ControlColumn::kVerticalSigma, {"accuracyvert", "accuracyvertical", "verticalaccuracy", "verticalsigma", "accuracyz", "zaccuracy", "sz"});
    add(ControlColumn::kPhoto,
        {"image", "photo", "imagename", "photoname", "filename", "file", "camera", "imagefile", "imagefilename", "sourcefile"});
    add(ControlColumn::kPixelX, {"px", "pixelx", "imagex", "imx", "column"});
    add(ControlColumn::kPixelY, {"py", "pixely", "imagey", "imy", "row"});
    add(ControlColumn::kPhotoWidth, {"imagewidth", "photowidth"});
    add(ControlColumn::kPhotoHeight, {"imageheight", "photoheight"});
    return all;
  }();
  return names;
}

const Names& MarkNames() {
  static const Names names = [] {
    Names all;
    for (const auto& [name, column] : PointNames()) {
      if (column >= ControlColumn::kPhoto || column == ControlColumn::kLabel) all[name] = column;
    }
    all["x"] = ControlColumn::kPixelX;
    all["y"] = ControlColumn::kPixelY;
    all["width"] = ControlColumn::kPhotoWidth;
    all["height"] = ControlColumn::kPhotoHeight;
    return all;
  }();
  return names;
}

// "Accuracy_(m)" as "accuracy", "X/Longitude" as "longitude".
std::string Plain(const std::string& name) {
  std::string text = name.substr(0, name.find_first_of("(["));
  text.erase(0, text.find('/') == std::string::npos ? 0 : text.find('/') + 1);
  std::string plain;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

}  // namespace

std::optional<ControlColumn> ColumnOfName(const std::string& name, TableKind kind) {
  const std::string plain = Plain(name);
  if (plain == "skip" || plain == "ignore") return ControlColumn::kIgnored;
  const Names& names = kind == TableKind::kMarks ? MarkNames() : PointNames();
  const auto found = names.find(plain);
  return found == names.end() ? std::nullopt : std::optional(found->second);
}

bool SaysAxis(const std::string& name) {
  const std::string plain = Plain(name);
  return plain != "x" && plain != "y";
}

ControlColumns::ControlColumns(const std::vector<std::string>& names, TableKind kind) {
  index_.fill(-1);
  int n_said = 0;
  for (size_t i = 0; i < names.size(); ++i) {
    const std::optional<ControlColumn> column = ColumnOfName(names[i], kind);
    if (!column || *column == ControlColumn::kIgnored) continue;
    int& index = index_[static_cast<size_t>(*column)];
    if (index >= 0) continue;
    index = static_cast<int>(i);
    if (*column == ControlColumn::kX || *column == ControlColumn::kY) n_said += SaysAxis(names[i]) ? 1 : 0;
  }
  axes_said_ = n_said == 2;
}

std::string ControlColumns::Field(const std::vector<std::string>& fields, ControlColumn column) const {
  const int index = index_[static_cast<size_t>(column)];
  return index < 0 || static_cast<size_t>(index) >= fields.size() ? "" : fields[static_cast<size_t>(index)];
}

bool ControlColumns::IsComplete(TableKind kind) const {
  if (kind == TableKind::kMarks) return Has(ControlColumn::kLabel) && HasMarks();
  const bool named = Has(ControlColumn::kLabel) || (kind == TableKind::kPositions && Has(ControlColumn::kPhoto));
  return named && Has(ControlColumn::kX) && Has(ControlColumn::kY);
}

bool ControlColumns::HasMarks() const {
  return Has(ControlColumn::kPhoto) && Has(ControlColumn::kPixelX) && Has(ControlColumn::kPixelY);
}

std::vector<std::string> SplitNames(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream in(text);
  for (std::string name; std::getline(in, name, ',');) {
    const size_t begin = name.find_first_not_of(" \t\r");
    names.push_back(begin == std::string::npos ? "" : name.substr(begin, name.find_last_not_of(" \t\r") - begin + 1));
  }
  return names;
}

}  // namespace skyquilt::prepare::control
