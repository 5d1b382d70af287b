#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/config/checked_toml.h"
#include "core/config/options.h"
#include "core/config/toml_json.h"

namespace skyquilt::config {
namespace {

// " (line 3)"; empty for --set, which has no file.
std::string LineOf(const toml::node& node) {
  if (node.source().path == nullptr || node.source().path->empty()) return "";
  const auto line = node.source().begin.line;
  return line > 0 ? " (line " + std::to_string(line) + ")" : "";
}

std::string KindOf(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "a text in quotes";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a decimal number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

// All known keys, and all tables that may contain one ("a" and "a.b" for section "a.b").
struct Known {
  std::vector<std::string> keys;
  std::vector<std::string> section_of_key;  // parallel to keys
  std::set<std::string> tables;
};

// "my.toml: " at the start of a message; empty for --set, where the option's name is enough.
std::string From(const std::string& origin) {
  return origin.empty() ? "" : origin + ": ";
}

// Reads one value of the document into its option.
struct Assign {
  const std::string& origin;
  const std::string& name;  // "section.key"
  const toml::node& node;
  const Range& range;

  void operator()(bool* value) const { *value = Exact<bool>("true or false"); }
  void operator()(int* value) const {
    if (const auto* word = node.as_string()) {
      if (const std::optional<double> number = range.NumberOf(word->get())) {
        *value = static_cast<int>(*number);
        return;
      }
    }
    const auto wide = Exact<int64_t>("a whole number");
    if (const std::optional<std::string> word = range.WordFor(static_cast<double>(wide))) {
      throw base::UsageError(From(origin) + name + " = " + std::to_string(wide) + " is not allowed: it must be " + range.Text() + LineOf(node));
    }
    if (wide < std::numeric_limits<int>::min() || wide > std::numeric_limits<int>::max()) {
      throw base::UsageError(From(origin) + name + " = " + std::to_string(wide) + " is too large or too small" + LineOf(node));
    }
    *value = static_cast<int>(wide);
  }
  void operator()(double* value) const { *value = Number(node, "a number"); }
  void operator()(std::string* value) const { *value = Exact<std::string>("a text in quotes"); }
  void operator()(std::vector<double>* value) const {
    const toml::array* array = node.as_array();
    if (array == nullptr) Refuse(node, "a list of numbers");
    std::vector<double> numbers;
    numbers.reserve(array->size());
    for (const toml::node& element : *array) numbers.push_back(Number(element, "a list of numbers"));
    *value = std::move(numbers);
  }

 private:
  [[noreturn]] void Refuse(const toml::node& found, const std::string& wanted) const {
    throw base::UsageError(From(origin) + name + " must be " + wanted + ", found " + KindOf(found) + LineOf(found));
  }
  template <typename T>
  T Exact(const std::string& wanted) const {
    const std::optional<T> found = node.value_exact<T>();
    if (!found) Refuse(node, wanted);
    return *found;
  }
  double Number(const toml::node& found, const std::string& wanted) const {
    if (const auto* integer = found.as_integer()) return static_cast<double>(integer->get());
    const auto* number = found.as_floating_point();
    if (number == nullptr) Refuse(found, wanted);
    if (std::isnan(number->get())) throw base::UsageError(From(origin) + name + " must be a number, found nan" + LineOf(found));
    return number->get();
  }
};

Known Describe(const Sections& sections) {
  Known known;
  for (const Sections::Entry& entry : sections.entries()) {
    for (const Option& option : entry.options) {
      known.keys.push_back(entry.name + "." + option.key);
      known.section_of_key.push_back(entry.name);
    }
    for (size_t dot = entry.name.find('.'); dot != std::string::npos; dot = entry.name.find('.', dot + 1)) {
      known.tables.insert(entry.name.substr(0, dot));
    }
    known.tables.insert(entry.name);
  }
  return known;
}

[[noreturn]] void RefuseTable(const std::string& origin, const std::string& name, const toml::node& node, const Known& known) {
  const std::vector<std::string> tables(known.tables.begin(), known.tables.end());
  const std::string nearest = Nearest(name, tables);
  throw base::UsageError(From(origin) + "unknown section '" + name + "'" +
                         (nearest.empty() ? "; known sections: " + base::Join(tables) : "; did you mean '" + nearest + "'?") + LineOf(node));
}

[[noreturn]] void RefuseKey(const std::string& origin, const std::string& name, const toml::node& node, const Known& known) {
  const size_t dot = name.rfind('.');
  const std::string section = dot == std::string::npos ? "" : name.substr(0, dot);
  const std::string bare = dot == std::string::npos ? name : name.substr(dot + 1);
  // Suggest a similar key of the section, else the same key of another section, else any similar key.
  std::vector<std::string> here;
  std::string elsewhere;
  for (size_t i = 0; i < known.keys.size(); ++i) {
    const std::string& key = known.keys[i];
    const std::string key_bare = known.section_of_key[i].empty() ? key : key.substr(known.section_of_key[i].size() + 1);
    if (known.section_of_key[i] == section) here.push_back(key_bare);
    if (key_bare == bare && elsewhere.empty()) elsewhere = key;
  }
  std::string nearest = Nearest(bare, here);
  if (!nearest.empty()) nearest = section.empty() ? nearest : section + "." + nearest;
  if (nearest.empty()) nearest = elsewhere;
  if (nearest.empty()) nearest = Nearest(name, known.keys);
  std::string advice;
  if (!nearest.empty()) {
    advice = "; did you mean '" + nearest + "'?";
  } else if (!here.empty()) {
    advice = "; this section has: " + base::Join(here);
  }
  throw base::UsageError(From(origin) + "unknown key '" + name + "'" + advice + LineOf(node));
}

// Takes the value of an option that is a constant now. Another value than the constant's would be silently lost: it is refused.
void TakeFixed(const std::string& origin, const FixedOption& fixed, const toml::node& node) {
  const bool* flag = std::get_if<bool>(&fixed.value);
  const double constant = std::visit([](auto value) { return static_cast<double>(value); }, fixed.value);
  const bool agrees = flag != nullptr ? node.is_boolean() && node.value<bool>() == *flag : node.is_number() && node.value<double>() == constant;
  if (!agrees) {
    throw base::UsageError(From(origin) + fixed.key + " is fixed at " + TomlText(fixed) + " now and takes no other value; remove it" + LineOf(node));
  }
  base::LogWarning("{}: option '{}' is fixed at {} now; remove it", origin.empty() ? "--set" : origin, fixed.key, TomlText(fixed));
}

// Collects every value of the document under its dotted name; throws for unknown tables and keys.
void CollectLeaves(const std::string& origin, const toml::table& table, const std::string& prefix, const Sections& sections, const Known& known,
                   std::map<std::string, const toml::node*>& leaves) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    const toml::table* inner = node.as_table();
    const std::string current = sections.CurrentName(name, "");
    const bool is_option = sections.Find(current) != nullptr;
    if (!is_option && sections.IsRetired(name, origin.empty() ? "--set" : origin)) continue;
    if (const FixedOption* fixed = sections.FindFixed(name)) {
      TakeFixed(origin, *fixed, node);
      continue;
    }
    if (inner == nullptr || is_option) {
      if (!is_option) RefuseKey(origin, name, node, known);
      if (current == name) {
        leaves[current] = &node;
      } else {
        sections.CurrentName(name, origin.empty() ? "--set" : origin);
        leaves.try_emplace(current, &node);  // the new name wins when both are given
      }
      continue;
    }
    if (!known.tables.contains(name)) RefuseTable(origin, name, node, known);
    CollectLeaves(origin, *inner, name + ".", sections, known, leaves);
  }
}

// TOML allows bytes of other than ASCII characters in texts and comments only; about some of them elsewhere toml++ 3.3 decides with undefined
// behaviour (is_non_ascii_horizontal_whitespace). Texts that never end are left to toml++.
void RefuseStrayCharacters(std::string_view text, const std::string& origin) {
  int line = 1;
  std::string_view quotes;  // of the text that is open
  for (size_t i = text.starts_with("\xEF\xBB\xBF") ? 3 : 0; i < text.size();) {
    const std::string_view rest = text.substr(i);
    size_t length = 1;
    if (rest[0] == '\n') ++line;
    if (quotes.empty()) {
      if (rest[0] == '#') length = std::min(rest.find('\n'), rest.size());
      if (rest[0] == '"' || rest[0] == '\'') {
        quotes = rest.substr(0, rest.starts_with("\"\"\"") || rest.starts_with("'''") ? 3 : 1);
        length = quotes.size();
      }
      if (static_cast<unsigned char>(rest[0]) >= 0x80) {
        throw base::InputError(origin, "line " + std::to_string(line) + ": here is a character that may stand only in quotes or comments",
                               "Put the text into quotes, or replace the character: editors and web pages turn quotes and dashes into others");
      }
    } else if (rest[0] == '\\' && quotes[0] == '"' && rest.size() > 1 && rest[1] != '\n') {
      length = 2;
    } else if (rest.starts_with(quotes) || (quotes.size() == 1 && rest[0] == '\n')) {
      length = rest[0] == '\n' ? 1 : quotes.size();
      quotes = {};
    }
    i += length;
  }
}

toml::table Parse(const std::string& text, const std::string& origin) {
  RefuseStrayCharacters(text, origin);
  try {
    return toml::parse(text, origin);
  } catch (const toml::parse_error& error) {
    std::ostringstream finding;
    finding << "line " << error.source().begin.line << ", column " << error.source().begin.column << ": " << error.description();
    throw base::InputError(origin, finding.str(), "Correct the line; text values need quotes");
  } catch (const FailedTomlCheck&) {
    throw base::InputError(origin, "is not valid TOML: a key or a value begins with a character that is not allowed there",
                           "Compare it with configs/default.toml");
  }
}

}  // namespace

nlohmann::json TomlAsJson(const std::filesystem::path& file) {
  return TomlTextAsJson(base::ReadFile(file), file.string());
}

nlohmann::json TomlTextAsJson(const std::string& text, const std::string& origin) {
  const toml::table table = Parse(text, origin);
  std::ostringstream json;
  json << toml::json_formatter{table};
  return base::ParseJson(json.str());
}

void ReadToml(const std::filesystem::path& file, const Sections& sections) {
  ReadTomlText(base::ReadFile(file), file.string(), sections);
}

void ReadTomlText(const std::string& text, const std::string& origin, const Sections& sections) {
  const toml::table document = Parse(text, origin);
  std::map<std::string, const toml::node*> leaves;
  CollectLeaves(origin, document, "", sections, Describe(sections), leaves);
  for (const auto& [name, node] : leaves) {
    const Option& option = *sections.Find(name);
    std::visit(Assign{origin, name, *node, option.range}, option.value);
    const std::string why = WhyForbidden(option);
    if (!why.empty()) throw base::UsageError(From(origin).append(name).append(why).append(LineOf(*node)));
  }
  std::set<std::string> given;
  for (const auto& [name, node] : leaves) given.insert(name);
  sections.PassOn(given);
}

}  // namespace skyquilt::config
