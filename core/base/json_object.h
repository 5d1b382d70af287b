// An object of a JSON document whose members are taken out one by one, each with its type and limits checked, so that those that nobody took are
// known in the end.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/json_document.h"

namespace skyquilt::base {

// All functions throw as those of JsonValue, with the place of the member.
class JsonObject {
 public:
  // Throws when it is no object.
  explicit JsonObject(const JsonValue& object);

  bool Has(const std::string& key) const { return object_.json().contains(key); }
  // Nothing when it is missing.
  std::optional<JsonValue> Find(const std::string& key);
  // Nothing when it is missing or null, which mean the same.
  std::optional<JsonValue> FindUnlessNull(const std::string& key);

  // These throw when the member is missing.
  JsonValue Need(const std::string& key);
  JsonObject Object(const std::string& key) { return JsonObject(Need(key)); }
  std::string Line(const std::string& key, size_t max);  // of 1 to max characters
  double Number(const std::string& key, double min, double max) { return Need(key).Number(min, max); }
  int64_t Integer(const std::string& key, int64_t min, int64_t max) { return Need(key).Integer(min, max); }
  uint64_t Count(const std::string& key);  // a whole number above 0
  bool Flag(const std::string& key) { return Need(key).Boolean(); }
  // Exactly out.size() numbers from -limit to limit.
  void Numbers(const std::string& key, double limit, std::span<double> out);
  // A list of pairs of such numbers.
  std::vector<std::array<double, 2>> Pairs(const std::string& key, size_t min_count, size_t max_count, double limit);
  // Index of the text in the list.
  size_t OneOf(const std::string& key, std::initializer_list<std::string_view> allowed);

  // For these a member that is missing is zero or empty.
  std::string LineOrEmpty(const std::string& key, size_t max);
  std::string Paragraphs(const std::string& key, size_t max);  // lines of up to max characters in all
  double NumberOrZero(const std::string& key, double max) { return Find(key) ? Number(key, 0.0, max) : 0.0; }
  std::vector<JsonValue> List(const std::string& key, size_t max);  // of at most max members
  std::vector<std::string> Lines(const std::string& key, size_t max_count, size_t max);

  // Keys of the members that were not taken.
  std::vector<std::string> Rest() const;

  [[noreturn]] void Refuse(const std::string& key, const std::string& rule) const { object_.FailAt(key, rule); }

 private:
  JsonValue object_;
  std::set<std::string, std::less<>> taken_;
};

}  // namespace skyquilt::base
