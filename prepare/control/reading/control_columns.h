// What the columns of a table of control points or marks mean, by their names.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::prepare::control {

enum class ControlColumn {
  kLabel,
  kX,  // east or longitude
  kY,  // north or latitude
  kZ,
  kSigma,            // one standard deviation for all axes, metres
  kHorizontalSigma,  // for each horizontal axis
  kVerticalSigma,
  kPhoto,
  kPixelX,
  kPixelY,
  kPhotoWidth,  // pixels of the photo that was marked
  kPhotoHeight,
  kIgnored
};

// What a table is about: control points, marks, positions of photos.
enum class TableKind { kPoints, kMarks, kPositions };

// The names as they are written by programs and people: in any case, without what is in brackets, '_', '-' and spaces; of "X/Longitude" the part that
// says more. In a table of marks x and y are pixels. Nothing for a name that has no meaning.
std::optional<ControlColumn> ColumnOfName(const std::string& name, TableKind kind);
// Whether the name says which of the axes it is: "east" does, "x" does not.
bool SaysAxis(const std::string& name);

// The fields of a table by their meaning.
class ControlColumns {
 public:
  // Columns without a meaning are ignored. The first column of a meaning counts.
  ControlColumns(const std::vector<std::string>& names, TableKind kind);

  bool Has(ControlColumn column) const { return index_[static_cast<size_t>(column)] >= 0; }
  // Empty when the row is shorter or there is no such column.
  std::string Field(const std::vector<std::string>& fields, ControlColumn column) const;
  // All that the kind of table cannot do without: label, x and y; photo, label and pixel; or, of positions of photos, photo
  // (or label), x and y.
  bool IsComplete(TableKind kind) const;
  // The marks' columns too.
  bool HasMarks() const;
  bool axes_said() const { return axes_said_; }

 private:
  std::array<int, static_cast<size_t>(ControlColumn::kIgnored)> index_;
  bool axes_said_ = false;
};

// The names in a text like "label,east,north,up".
std::vector<std::string> SplitNames(const std::string& text);

}  // namespace skyquilt::prepare::control
