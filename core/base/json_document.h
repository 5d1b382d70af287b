// Values of a JSON document from outside, taken out one by one, each with its type and limits checked. Errors say where the value is: of a file that
// a user names "FILE: line 12: frames[3].w must be ..., not ...", of other documents "stops[3].title must be ...", without what was found there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace skyquilt::base {

class JsonDocument;

// A value of a document, which must outlive it. All functions throw when the value is not what is asked for: InputError for a file's, else Refused.
class JsonValue {
 public:
  // Of a document that is no file. path: where in it, empty for the whole.
  explicit JsonValue(const nlohmann::json& value, std::string path = "") : value_(&value), path_(std::move(path)) {}

  const nlohmann::json& json() const { return *value_; }
  bool IsObject() const { return value_->is_object(); }
  // Where it is in a document that is no file: "stops[3].title".
  const std::string& path() const { return path_; }

  JsonValue At(const std::string& key) const;                     // of an object
  std::optional<JsonValue> Find(const std::string& key) const;    // of an object; nothing when missing or null
  std::optional<JsonValue> Member(const std::string& key) const;  // of an object; nothing when missing
  JsonValue At(size_t index) const;                               // of a list
  size_t Size() const;                                            // of a list
  std::vector<std::pair<std::string, JsonValue>> Members() const;

  // Finite.
  double Number(double min = -1e9, double max = 1e9) const;
  // Written without fraction and exponent.
  int64_t Integer(int64_t min, int64_t max) const;
  double Positive() const;
  int Pixels() const;  // a size: a whole number from 1 to 1e6; 640.0 is whole
  uint64_t Id() const;
  bool Boolean() const;
  std::string Text(size_t max_bytes = 4096) const;  // one line, not empty
  std::vector<double> Numbers(size_t count) const;
  // 0 when the object has no such member.
  double NumberOr0(const std::string& key) const;
  // The line of the file where it begins, from 1; 0: not known (a key that is there twice, or no file).
  int LineNumber() const;

  // Throws: the place of this value, what was found and how to fix it (empty: the file's usual advice).
  [[noreturn]] void Fail(const std::string& found, const std::string& fix = "") const;
  // The same for a member that is missing, or wrong: the place is that of the member, its line that of this object.
  [[noreturn]] void FailAt(const std::string& key, const std::string& found) const;

 private:
  friend class JsonDocument;
  JsonValue(const JsonDocument& document, const nlohmann::json& value) : document_(&document), value_(&value) {}
  JsonValue Child(const nlohmann::json& value, const std::string& key) const;
  JsonValue Child(const nlohmann::json& value, size_t index) const;
  // ", not 7"; nothing for other documents than files: their senders get no texts back.
  std::string Not() const;

  const JsonDocument* document_ = nullptr;  // the file
  const nlohmann::json* value_;
  std::string path_ = {};  // only without a file, where it is found when it is needed
};

class JsonDocument {
 public:
  // `fix`: how to get a good file. Throws InputError: not readable, not JSON (with the line), nested too deeply.
  // NaN and Infinity, which Python writes, are read, and refused like any wrong number where one is asked for, so that the message says where.
  JsonDocument(const std::filesystem::path& file, const std::string& fix);
  JsonDocument(const JsonDocument&) = delete;
  JsonDocument& operator=(const JsonDocument&) = delete;

  JsonValue Root() const { return {*this, json_}; }
  const std::filesystem::path& file() const { return file_; }

 private:
  friend class JsonValue;
  // key: of the value's member that is meant; empty for the value itself.
  [[noreturn]] void Fail(const nlohmann::json& value, const std::string& key, const std::string& found, const std::string& fix) const;
  int LineOfValue(const nlohmann::json& value) const;
  // The value for a message; NaN and Infinity as they are in the file.
  std::string Shown(const nlohmann::json& value) const;

  std::filesystem::path file_;
  std::string fix_;
  std::string text_;
  bool has_nan_ = false;  // or Infinity
  nlohmann::json json_;
  mutable std::unordered_map<const nlohmann::json*, size_t> offsets_;  // of all values in the text; filled when first asked for
};

// Number of the line in which the byte is, from 1.
size_t LineOf(std::string_view text, size_t offset);
// "from 0.5 to 1e9".
std::string RangeText(double min, double max);

}  // namespace skyquilt::base
