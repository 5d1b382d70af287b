#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/config/checked_toml.h"
#include "core/config/options.h"

namespace skyquilt::config {
namespace {

std::string LineOf(const toml::node& node) {
  const auto line = node.source().begin.line;
  return line > 0 ? " (line " + std::to_string(line) + ")" : "";
}

std::string KindOf(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number with a point";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

// Every option of the sections, and every table that may hold one ("a" and "a.b" for section "a.b").
struct Known {
  std::vector<std::string> keys;
  std::vector<std::string> section_of_key;  // parallel to keys
  std::set<std::string> tables;
};

// Takes the values of one section from the flattened document.
class ReadVisitor : public OptionVisitor {
 public:
  ReadVisitor(const std::string& origin, const std::string& prefix, const std::map<std::string, const toml::node*>& leaves)
      : origin_(origin), prefix_(prefix), leaves_(leaves) {}

  void Field(const std::string& key, bool& value, const std::string&) override { ReadExact(key, value, "true or false"); }

  void Field(const std::string& key, int& value, const std::string&) override {
    int64_t wide = value;
    ReadExact(key, wide, "an integer");
    if (wide < std::numeric_limits<int>::min() || wide > std::numeric_limits<int>::max()) {
      throw base::UsageError(origin_ + ": '" + prefix_ + key + "' = " + std::to_string(wide) + " is too large" + LineOf(*Find(key)));
    }
    value = static_cast<int>(wide);
  }

  void Field(const std::string& key, double& value, const std::string&) override {
    if (const toml::node* node = Find(key)) value = Number(key, *node, "a number");
  }

  void Field(const std::string& key, std::string& value, const std::string&) override { ReadExact(key, value, "a string in quotes"); }

  void Field(const std::string& key, std::vector<double>& value, const std::string&) override {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr) Refuse(key, *node, "an array of numbers");
    std::vector<double> numbers;
    for (const toml::node& element : *array) numbers.push_back(Number(key, element, "an array of numbers"));
    value = std::move(numbers);
  }

 private:
  const toml::node* Find(const std::string& key) const {
    const auto leaf = leaves_.find(prefix_ + key);
    return leaf == leaves_.end() ? nullptr : leaf->second;
  }

  [[noreturn]] void Refuse(const std::string& key, const toml::node& node, const std::string& wanted) const {
    throw base::UsageError(origin_ + ": '" + prefix_ + key + "' must be " + wanted + ", found " + KindOf(node) + LineOf(node));
  }

  template <typename Value>
  void ReadExact(const std::string& key, Value& value, const std::string& wanted) const {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    const std::optional<Value> found = node->value_exact<Value>();
    if (!found) Refuse(key, *node, wanted);
    value = *found;
  }

  double Number(const std::string& key, const toml::node& node, const std::string& wanted) const {
    if (const auto* integer = node.as_integer()) return static_cast<double>(integer->get());
    const auto* number = node.as_floating_point();
    if (number == nullptr) Refuse(key, node, wanted);
    if (std::isnan(number->get())) throw base::UsageError(origin_ + ": '" + prefix_ + key + "' is nan" + LineOf(node));
    return number->get();
  }

  const std::string& origin_;
  const std::string& prefix_;
  const std::map<std::string, const toml::node*>& leaves_;
};

// Collects the names only.
class NameVisitor : public OptionVisitor {
 public:
  explicit NameVisitor(std::vector<std::string>& keys) : keys_(keys) {}
  void Field(const std::string& key, bool&, const std::string&) override { keys_.push_back(key); }
  void Field(const std::string& key, int&, const std::string&) override { keys_.push_back(key); }
  void Field(const std::string& key, double&, const std::string&) override { keys_.push_back(key); }
  void Field(const std::string& key, std::string&, const std::string&) override { keys_.push_back(key); }
  void Field(const std::string& key, std::vector<double>&, const std::string&) override { keys_.push_back(key); }

 private:
  std::vector<std::string>& keys_;
};

std::string PrefixOf(const Sections::Entry& entry) {
  return entry.name.empty() ? "" : entry.name + ".";
}

Known Describe(const Sections& sections) {
  Known known;
  for (const Sections::Entry& entry : sections.entries()) {
    std::vector<std::string> keys;
    NameVisitor visitor(keys);
    entry.visit(visitor);
    for (const std::string& key : keys) {
      known.keys.push_back(PrefixOf(entry) + key);
      known.section_of_key.push_back(entry.name);
    }
    for (size_t dot = entry.name.find('.'); dot != std::string::npos; dot = entry.name.find('.', dot + 1)) {
      known.tables.insert(entry.name.substr(0, dot));
    }
    if (!entry.name.empty()) known.tables.insert(entry.name);
  }
  return known;
}

[[noreturn]] void RefuseTable(const std::string& origin, const std::string& name, const toml::node& node, const Known& known) {
  const std::vector<std::string> tables(known.tables.begin(), known.tables.end());
  const std::string nearest = Nearest(name, tables);
  throw base::UsageError(origin + ": unknown section '" + name + "'" +
                         (nearest.empty() ? "; known sections: " + base::Join(tables) : "; did you mean '" + nearest + "'?") + LineOf(node));
}

[[noreturn]] void RefuseKey(const std::string& origin, const std::string& name, const toml::node& node, const Known& known) {
  const size_t dot = name.rfind('.');
  const std::string section = dot == std::string::npos ? "" : name.substr(0, dot);
  const std::string bare = dot == std::string::npos ? name : name.substr(dot + 1);
  // First a misspelling within the section, then the right word in the wrong section, then anything near.
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
    advice = "; known here: " + base::Join(here);
  }
  throw base::UsageError(origin + ": unknown key '" + name + "'" + advice + LineOf(node));
}

// Every value of the document by its dotted name; refuses tables that no section knows.
void CollectLeaves(const std::string& origin, const toml::table& table, const std::string& prefix, const Sections& sections, const Known& known,
                   std::map<std::string, const toml::node*>& leaves) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    const toml::table* inner = node.as_table();
    const bool is_option = std::find(known.keys.begin(), known.keys.end(), name) != known.keys.end();
    if (!is_option && sections.IsRetired(name, origin)) continue;
    if (inner == nullptr || is_option) {
      if (!is_option) RefuseKey(origin, name, node, known);
      leaves[name] = &node;
      continue;
    }
    if (!known.tables.contains(name)) RefuseTable(origin, name, node, known);
    CollectLeaves(origin, *inner, name + ".", sections, known, leaves);
  }
}

toml::table Parse(const std::string& text, const std::string& origin) {
  try {
    return toml::parse(text, origin);
  } catch (const toml::parse_error& error) {
    std::ostringstream finding;
    finding << "line " << error.source().begin.line << ", column " << error.source().begin.column << ": " << error.description();
    throw base::InputError(origin, finding.str(), "Correct the line; text values need quotes");
  } catch (const FailedTomlCheck&) {
    throw base::InputError(origin, "is not TOML: a key or a value begins with a character that cannot begin one",
                           "Compare it with configs/default.toml");
  }
}

}  // namespace

void ReadToml(const std::filesystem::path& file, Sections& sections) {
  ReadTomlText(base::ReadFile(file), file.string(), sections);
}

void ReadTomlText(const std::string& text, const std::string& origin, Sections& sections) {
  const toml::table document = Parse(text, origin);
  const Known known = Describe(sections);
  std::map<std::string, const toml::node*> leaves;
  CollectLeaves(origin, document, "", sections, known, leaves);
  for (const Sections::Entry& entry : sections.entries()) {
    const std::string prefix = PrefixOf(entry);
    ReadVisitor visitor(origin, prefix, leaves);
    entry.visit(visitor);
  }
}

}  // namespace skyquilt::config
