// One description per option serves TOML, the command line, the documentation and the configuration hash.
// A room's options are a plain struct with defaults in place and a member
//   void Visit(config::OptionVisitor& v) { v.Field("levels", levels, "resolutions of the hash grid, 1..16"); ... }
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace skyquilt::config {

class OptionVisitor {
 public:
  virtual ~OptionVisitor() = default;
  virtual void Field(const std::string& key, bool& value, const std::string& help) = 0;
  virtual void Field(const std::string& key, int& value, const std::string& help) = 0;
  virtual void Field(const std::string& key, double& value, const std::string& help) = 0;
  virtual void Field(const std::string& key, std::string& value, const std::string& help) = 0;
  virtual void Field(const std::string& key, std::vector<double>& value, const std::string& help) = 0;
};

// Named sections in file order. Holds references: the structs must outlive it.
class Sections {
 public:
  template <typename Options>
  void Add(const std::string& name, Options& options, const std::string& help) {
    entries_.push_back({name, help, [&options](OptionVisitor& visitor) { options.Visit(visitor); }});
  }
  struct Entry {
    std::string name;
    std::string help;
    std::function<void(OptionVisitor&)> visit;
  };
  const std::vector<Entry>& entries() const { return entries_; }

  // An option of earlier versions, as "section.key": still taken wherever it is set, without effect but a warning that says `why`.
  void Retire(const std::string& key, const std::string& why) { retired_[key] = why; }
  // True for a retired option, which is then warned of; `origin`: where it was set.
  bool IsRetired(const std::string& key, const std::string& origin) const;

 private:
  std::vector<Entry> entries_;
  std::map<std::string, std::string> retired_;
};

// Reads a TOML file into the sections. Throws base::InputError for a file that cannot be read or parsed (line named), base::UsageError for
// an unknown section or key (naming the nearest known one) or a value of the wrong type.
void ReadToml(const std::filesystem::path& file, Sections& sections);
void ReadTomlText(const std::string& text, const std::string& origin, Sections& sections);
// Every option with its value and its help as a comment.
std::string WriteToml(Sections& sections);
// "section.key" = value lines, sorted: canonical text for hashing and for naming differences.
std::map<std::string, std::string> Flatten(Sections& sections);
// 16 hex digits.
std::string Hash(const std::map<std::string, std::string>& flat);
// "worker.steps: 2000 -> 4000" for every key that differs or exists on one side only.
std::vector<std::string> Differences(const std::map<std::string, std::string>& before, const std::map<std::string, std::string>& after);
// The candidate with the smallest edit distance; empty when none is near (distance > max(2, length / 3)).
std::string Nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace skyquilt::config
