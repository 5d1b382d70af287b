// An object of a tour, with what the format says of ids, positions and members that are not known.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/checked_json.h"
#include "core/base/json_object.h"

namespace skyquilt::tour {

// How much of a file must be as we write it.
struct Reading {
  bool strict = false;         // for saving: what is not known is refused
  bool other_version = false;  // what cannot be read is left out
  // Plain sentences about what is left out; only when not strict.
  std::vector<std::string> missing = {};
};

class Fields : public base::JsonObject {
 public:
  Fields(const base::JsonValue& object, Reading* reading) : JsonObject(object), path_(object.path()), reading_(reading) {}

  // The path of a member: "stops[3].title".
  std::string Path(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

  std::string Id(const std::string& key);
  Eigen::Vector3d Position(const std::string& key);
  // For these a member that is missing is null or empty.
  std::optional<std::string> OptionalId(const std::string& key);
  std::vector<std::string> Ids(const std::string& key, size_t max);

  // Members that were not taken: refused, or left out with a sentence.
  void End();

  Reading& reading() { return *reading_; }

 private:
  std::string path_;
  Reading* reading_;
};

}  // namespace skyquilt::tour
