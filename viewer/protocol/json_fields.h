// A client's message as a JSON object whose members are taken out one by one, each with its type and limits checked. What was not taken out is
// refused in the end.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::viewer {

// The beginning of a client's text in quotation marks, at most 40 characters, plain ASCII: safe to show and to log.
std::string Quoted(std::string_view text);

// All members throw BadMessage, which names the key and what is allowed.
class JsonFields {
 public:
  // Refuses longer texts, nesting deeper than 4, keys that occur twice, and all but an object.
  JsonFields(std::string_view text, size_t max_bytes);
  ~JsonFields();
  JsonFields(const JsonFields&) = delete;
  JsonFields& operator=(const JsonFields&) = delete;

  bool Has(const char* key) const;
  std::string Text(const char* key);
  // Index of the text in the list.
  size_t OneOf(const char* key, std::initializer_list<std::string_view> allowed);
  // A number written without fraction and exponent, limits included.
  int64_t Integer(const char* key, int64_t min, int64_t max);
  uint32_t U32(const char* key);
  double Number(const char* key, double min, double max);
  // Exactly out.size() numbers from -limit to limit.
  void Numbers(const char* key, double limit, std::span<double> out);
  // A list of pairs of numbers.
  std::vector<Eigen::Vector2d> Points(const char* key, int min_count, int max_count, double limit);

  void RefuseOthers() const;
  [[noreturn]] void Refuse(const char* key, const std::string& why) const;

 private:
  struct Object;
  std::unique_ptr<Object> object_;
  std::set<std::string, std::less<>> taken_;
  std::string type_;  // once known; for messages
};

}  // namespace skyquilt::viewer
