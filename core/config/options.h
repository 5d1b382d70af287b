// Configuration options. Each option is described once, and this description is used to read TOML files and --set, to check the value, and for the
// help, the documentation and the configuration hash. The options of one part of the program are a plain struct with default values and two
// functions:
//
//   std::vector<config::Field<TrainOptions>> TrainOptions::Fields() {
//     return {{"levels", &TrainOptions::levels, Range{1, 16}, "resolutions of the hash grid"}, ...};
//   }
//   void TrainOptions::Check() const {  // takes the section's name as argument when several sections use the struct
//     config::CheckRanges("train", *this);
//     // ... and rules between several options
//   }
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/config/range.h"

namespace skyquilt::config {

// kWhenChanged: written to configuration files only with another value than its default; for options that few people look for.
enum class Written { kAlways, kWhenChanged };

// Describes one option of a struct: its key in the configuration, its member, its allowed values, and its help text (meaning, unit, special values).
template <typename Options>
struct Field {
  std::string key;
  std::variant<bool Options::*, int Options::*, double Options::*, std::string Options::*, std::vector<double> Options::*> member;
  Range range;
  std::string help;
  Written written = Written::kAlways;
};

// An option of earlier versions that is a constant now. Old configurations may still give it, with this value only; a warning is logged then. Hashes
// still contain it, so that results of earlier versions are taken.
struct FixedOption {
  std::string key;
  std::variant<int, double, bool> value;
};

using Value = std::variant<bool*, int*, double*, std::string*, std::vector<double>*>;  // points to the option's member

// The same for one object, which must outlive it: Field with the member's address.
struct Option {
  std::string key;
  Value value;
  Range range;
  std::string help;
  std::string unwritten = {};  // the value with which it is not written to files, in TOML syntax; empty: it is always written
};

// One value in TOML syntax; numbers in the shortest form that reads back to the same bits.
std::string TomlText(const Value& value);
std::string TomlText(const FixedOption& fixed);
// The word for its number, where the range has one.
std::string TomlText(const Option& option);

template <typename Options>
std::vector<Option> OptionsOf(Options& options) {
  std::vector<Option> list;
  Options defaults;
  for (Field<Options>& field : Options::Fields()) {
    const auto value_in = [&field](Options& object) { return std::visit([&](auto member) { return Value(&(object.*member)); }, field.member); };
    Option option{std::move(field.key), value_in(defaults), std::move(field.range), std::move(field.help)};
    if (field.written == Written::kWhenChanged) option.unwritten = TomlText(option);
    option.value = value_in(options);
    list.push_back(std::move(option));
  }
  return list;
}

// What is wrong with its value, for a message: " = 40 is not allowed: it must be 1 to 16", in lists "[1] = ..."; empty for one that its range
// contains.
std::string WhyForbidden(const Option& option);
// Throws base::UsageError naming section, key, value and range of the first option that is not allowed.
void CheckRanges(const std::string& section, const std::vector<Option>& options);
template <typename Options>
void CheckRanges(const std::string& section, const Options& options) {
  Options copy = options;
  CheckRanges(section, OptionsOf(copy));
}

// All options of a configuration, as named sections in file order. Holds references: the structs must outlive it.
class Sections {
 public:
  template <typename Options>
  void Add(const std::string& name, Options& options, const std::string& help) {
    entries_.push_back({name, help, OptionsOf(options), [name, &options] {
                          if constexpr (requires { options.Check(name); }) {
                            options.Check(name);
                          } else {
                            options.Check();
                          }
                        }});
    if constexpr (requires { Options::Fixed(); }) {
      for (FixedOption& fixed : Options::Fixed()) {
        fixed.key = name + "." + fixed.key;
        fixed_.push_back(std::move(fixed));
      }
    }
  }
  struct Entry {
    std::string name;
    std::string help;
    std::vector<Option> options;
    std::function<void()> check;
  };
  const std::vector<Entry>& entries() const { return entries_; }
  // The option with this "section.key"; null when there is none.
  const Option* Find(const std::string& key) const;

  // Calls the Check of every section's struct. Throws base::UsageError for a value that is not allowed, alone or in combination.
  void Check() const;

  // An option of section `name` that no configuration named has the value of the same option of section `from`, and is not written to files with it,
  // unless its key is in `own`. `named`: the keys that were named; belongs to the object with the options, as sections are made anew for every file.
  void Inherit(const std::string& name, const std::string& from, std::set<std::string> own, std::set<std::string>& named) {
    inheritances_.push_back({name, from, std::move(own), &named});
  }
  // The option whose value this option ("section.key") has when it is not named; null when it inherits nothing.
  const Option* Inherited(const std::string& key) const;
  // Call after options were set: `given`, as "section.key", are named from now on, and their values go to the options that inherit them.
  void PassOn(const std::set<std::string>& given) const;

  // The constant that an option of earlier versions has become; null when there is none.
  const FixedOption* FindFixed(const std::string& key) const;
  const std::vector<FixedOption>& fixed() const { return fixed_; }

  // Options of earlier versions, as "section.key". Old configurations may still contain them; a warning is logged then.
  void Retire(const std::string& key, const std::string& why) { retired_[key] = why; }          // ignored
  void Rename(const std::string& old_key, const std::string& key) { renamed_[old_key] = key; }  // sets `key` instead
  // True for a retired option; then logs a warning. `origin`: the file or flag that set it.
  bool IsRetired(const std::string& key, const std::string& origin) const;
  // The new key of a renamed option, otherwise the key itself. Logs a warning for a renamed option unless `origin` is empty.
  std::string CurrentName(const std::string& key, const std::string& origin) const;

 private:
  struct Inheritance {
    std::string name, from;
    std::set<std::string> own;
    std::set<std::string>* named;
  };

  std::vector<Entry> entries_;
  std::vector<Inheritance> inheritances_;
  std::vector<FixedOption> fixed_;
  std::map<std::string, std::string> retired_;
  std::map<std::string, std::string> renamed_;
};

// Reads a TOML file into the sections; options that the file does not contain keep their values. Throws base::InputError for a file that cannot be
// read or parsed (with the line), base::UsageError for an unknown section or key (with the nearest known one), a value of the wrong type or outside
// its range. `origin`: the file's name for messages.
void ReadToml(const std::filesystem::path& file, const Sections& sections);
void ReadTomlText(const std::string& text, const std::string& origin, const Sections& sections);
// A TOML file with every option and its value, without values that are inherited or not worth writing; help and range are comments.
std::string WriteToml(const Sections& sections);
// All options, fixed ones too, as "section.key" -> value in TOML syntax: a canonical form for hashing and comparing configurations.
std::map<std::string, std::string> Flatten(const Sections& sections);
// 16 hex digits.
std::string Hash(const std::map<std::string, std::string>& flat);
// "worker.steps: 2000 -> 4000" for every key that differs or exists on one side only.
std::vector<std::string> Differences(const std::map<std::string, std::string>& before, const std::map<std::string, std::string>& after);
// The candidate with the smallest edit distance; empty when that distance is above max(2, length of word / 3).
std::string Nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace skyquilt::config
