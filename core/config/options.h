// Options of the rooms. One description per option serves the TOML files, --set, the command line's help, the check of its value, the
// documentation and the configuration hash. A room's options are a plain struct with defaults in place and two functions:
//
//   std::vector<config::Field<TrainOptions>> TrainOptions::Fields() {
//     return {{"levels", &TrainOptions::levels, Range{1, 16}, "resolutions of the hash grid"}, ...};
//   }
//   void TrainOptions::Check() const {  // or with the section's name, where several sections hold such a struct
//     config::CheckRanges("train", *this);
//     // ... and the rules that concern several options together
//   }
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/config/range.h"

namespace skyquilt::config {

// One option of a struct: its key in the configuration, its member, what it may be, and what it is for (unit, special values).
template <typename Options>
struct Field {
  std::string key;
  std::variant<bool Options::*, int Options::*, double Options::*, std::string Options::*, std::vector<double> Options::*> member;
  Range range;
  std::string help;
};

using Value = std::variant<bool*, int*, double*, std::string*, std::vector<double>*>;

// One option of one object, which must outlive it.
struct Option {
  std::string key;
  Value value;
  Range range;
  std::string help;
};

template <typename Options>
std::vector<Option> OptionsOf(Options& options) {
  std::vector<Option> list;
  for (Field<Options>& field : Options::Fields()) {
    const Value value = std::visit([&](auto member) { return Value(&(options.*member)); }, field.member);
    list.push_back({std::move(field.key), value, std::move(field.range), std::move(field.help)});
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

// Named sections in file order. Holds references: the structs must outlive it.
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

  // Throws base::UsageError for values that cannot be, alone or together with others of their section.
  void Check() const;

  // Options of earlier versions, as "section.key". Both are still taken wherever they are set, with a warning:
  void Retire(const std::string& key, const std::string& why) { retired_[key] = why; }          // without effect
  void Rename(const std::string& old_key, const std::string& key) { renamed_[old_key] = key; }  // for the new key
  // True for a retired option, which is then warned of; `origin`: where it was set.
  bool IsRetired(const std::string& key, const std::string& origin) const;
  // The new key of a renamed option, which is then warned of unless `origin` is empty; otherwise the key itself.
  std::string CurrentName(const std::string& key, const std::string& origin) const;

 private:
  std::vector<Entry> entries_;
  std::map<std::string, std::string> retired_;
  std::map<std::string, std::string> renamed_;
};

// Reads a TOML file into the sections. Throws base::InputError for a file that cannot be read or parsed (line named), base::UsageError for an
// unknown section or key (naming the nearest known one), a value of the wrong type, or one that its range does not contain.
void ReadToml(const std::filesystem::path& file, const Sections& sections);
void ReadTomlText(const std::string& text, const std::string& origin, const Sections& sections);
// Every option with its value; help and range as comments.
std::string WriteToml(const Sections& sections);
// One value as TOML writes it; numbers in the shortest form that reads back to the same bits.
std::string TomlText(const Value& value);
// "section.key" = value lines, sorted: canonical text for hashing and for naming differences.
std::map<std::string, std::string> Flatten(const Sections& sections);
// 16 hex digits.
std::string Hash(const std::map<std::string, std::string>& flat);
// "worker.steps: 2000 -> 4000" for every key that differs or exists on one side only.
std::vector<std::string> Differences(const std::map<std::string, std::string>& before, const std::map<std::string, std::string>& after);
// The candidate with the smallest edit distance; empty when none is near (distance > max(2, length / 3)).
std::string Nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace skyquilt::config
