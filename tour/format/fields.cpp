#include "tour/format/fields.h"

#include <algorithm>

namespace skyquilt::tour {
namespace {

constexpr size_t kMaxIdCharacters = 40;
constexpr size_t kMaxLineCharacters = 200;
constexpr double kMaxCoordinate = 1e9;
constexpr const char* kIdForm = "a name of 1 to 40 letters, digits, - or _";

bool IsId(std::string_view text) {
  const auto is_good = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_'; };
  return !text.empty() && text.size() <= kMaxIdCharacters && std::all_of(text.begin(), text.end(), is_good);
}

bool HoldsId(const base::JsonValue& value) {
  return value.json().is_string() && IsId(value.json().get_ref<const std::string&>());
}

}  // namespace

std::string Fields::Id(const std::string& key) {
  const base::JsonValue value = Need(key);
  if (!HoldsId(value)) value.Fail(std::string("must be ") + kIdForm);
  return value.json().get<std::string>();
}

std::optional<std::string> Fields::OptionalId(const std::string& key) {
  const std::optional<base::JsonValue> value = FindUnlessNull(key);
  if (!value) return {};
  if (!HoldsId(*value)) value->Fail(std::string("must be null or ") + kIdForm);
  return value->json().get<std::string>();
}

Eigen::Vector3d Fields::Position(const std::string& key) {
  Eigen::Vector3d position;
  Numbers(key, kMaxCoordinate, {position.data(), 3});
  return position;
}

std::vector<std::string> Fields::Ids(const std::string& key, size_t max) {
  std::vector<std::string> ids = Lines(key, max, kMaxLineCharacters);
  if (!std::all_of(ids.begin(), ids.end(), IsId)) Refuse(key, "must be a list of names of 1 to 40 letters, digits, - or _");
  return ids;
}

void Fields::End() {
  for (const std::string& key : Rest()) {
    const std::string shown = base::ShownStart(key);
    if (reading_->strict) Refuse(shown, "is not known: leave it out");
    // One sentence about the other version stands for all its new members.
    if (!reading_->other_version) reading_->missing.push_back(Path(shown) + " is not known and is left out.");
  }
}

}  // namespace skyquilt::tour
