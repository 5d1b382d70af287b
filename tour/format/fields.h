// A JSON object whose members are taken out one by one, each with its type and limits checked. Errors are base::Refused with the member's path.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/checked_json.h"

namespace skyquilt::tour {

// How much of a file must be as we write it.
struct Reading {
  bool strict = false;         // for saving: what is not known is refused
  bool other_version = false;  // what cannot be read is left out
  // Plain sentences about what is left out; only when not strict.
  std::vector<std::string> missing = {};
};

class Fields {
 public:
  // where: path of the object, empty for the document.
  Fields(const nlohmann::json& object, std::string where, Reading* reading);

  // The path of a member: "stops[3].title".
  std::string Path(const char* key) const;
  // Nothing when it is missing.
  const nlohmann::json* Find(const char* key);
  // Nothing when it is missing or null, which mean the same.
  const nlohmann::json* FindUnlessNull(const char* key);

  // These throw when the member is missing.
  std::string Id(const char* key);
  std::string Line(const char* key, size_t max);  // of 1 to max characters
  double Number(const char* key, double min, double max);
  Eigen::Vector3d Position(const char* key);
  bool Flag(const char* key);

  // For these a member that is missing is null, zero or empty.
  std::optional<std::string> OptionalId(const char* key);
  std::string LineOrEmpty(const char* key, size_t max);
  std::string Text(const char* key, size_t max);  // lines of up to max characters in all
  double NumberOrZero(const char* key, double max);
  const nlohmann::json* List(const char* key, size_t max);      // of at most max members
  std::vector<std::string> Lines(const char* key, size_t max);  // a list of lines of 1 to 200 characters
  std::vector<std::string> Ids(const char* key, size_t max);

  // Members that were not taken: refused, or left out with a sentence.
  void End();

  [[noreturn]] void Refuse(const char* key, const std::string& rule) const;
  Reading& reading() { return *reading_; }

 private:
  // Throws for a member that is missing.
  const nlohmann::json& Need(const char* key);

  const nlohmann::json& object_;
  std::string where_;
  Reading* reading_;
  std::set<std::string, std::less<>> taken_;
};

bool IsId(std::string_view text);

}  // namespace skyquilt::tour
