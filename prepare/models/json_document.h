// A JSON file of a camera model, whose errors say where in the file they are: "FILE: line 12: frames[3].w must be ...".
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace skyquilt::prepare::models {

class JsonDocument;

// A value of a document, which must outlive it. All functions throw base::InputError when the value is not what is asked for.
class JsonValue {
 public:
  JsonValue(const JsonDocument& document, const nlohmann::json& value) : document_(&document), value_(&value) {}

  const nlohmann::json& json() const { return *value_; }
  bool IsObject() const { return value_->is_object(); }

  JsonValue At(const std::string& key) const;                   // of an object
  std::optional<JsonValue> Find(const std::string& key) const;  // of an object; nothing when missing or null
  JsonValue At(size_t index) const;                             // of a list
  size_t Size() const;                                          // of a list
  std::vector<std::pair<std::string, JsonValue>> Members() const;

  double Number() const;  // finite, at most 1e9 in size
  double Positive() const;
  int Pixels() const;  // a size: a whole number from 1 to 1e6; 640.0 is whole
  uint64_t Id() const;
  bool Boolean() const;
  std::string Text() const;  // one line of 1 to 4096 bytes
  Eigen::Vector3d Vector3() const;
  std::vector<double> Numbers(size_t count) const;
  // 0 when the object has no such member.
  double NumberOr0(const std::string& key) const;
  // Where it begins in the file, from 1; 0: not known (a key that is there twice).
  int Line() const;

  // Throws base::InputError: the line and the path of this value, what was found and how to fix it (empty: the document's usual advice).
  [[noreturn]] void Fail(const std::string& found, const std::string& fix = "") const;

 private:
  std::string Shown() const;

  const JsonDocument* document_;
  const nlohmann::json* value_;
};

class JsonDocument {
 public:
  // `fix`: how to get a good file. Throws base::InputError: not readable, not JSON (with the line), nested too deeply.
  // NaN and Infinity, which Python writes, are read, and refused like any wrong number where one is asked for, so that the message says where.
  JsonDocument(const std::filesystem::path& file, const std::string& fix);
  JsonDocument(const JsonDocument&) = delete;
  JsonDocument& operator=(const JsonDocument&) = delete;

  JsonValue Root() const { return {*this, json_}; }
  const std::filesystem::path& file() const { return file_; }

 private:
  friend class JsonValue;
  [[noreturn]] void Fail(const nlohmann::json& value, const std::string& found, const std::string& fix) const;
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

}  // namespace skyquilt::prepare::models
