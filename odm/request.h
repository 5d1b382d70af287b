// A command line of OpenDroneMap, read and checked.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace skyquilt::odm {

class Request {
 public:
  // words: what follows 'skyquilt odm', as in --project-path /data --dsm --pc-quality high NAME. Options may also be written --name=value; of an
  // option that is given twice the last value counts. Throws base::UsageError: unknown options, values out of range, options that are refused, no
  // project path.
  static Request Parse(const std::vector<std::string>& words);

  bool help() const { return help_; }        // --help or -h is among the words; nothing else was checked
  bool version() const { return version_; }  // likewise --version
  const std::string& name() const { return name_; }
  // Folder of the dataset: project path and name.
  std::filesystem::path Folder() const;

  // option: with its dashes. Whether it was given; its value, else its default, else empty; the number of those of a number.
  bool Has(const std::string& option) const { return given_.contains(option); }
  std::string Text(const std::string& option) const;
  double Number(const std::string& option) const;

  // A line for each option that was given without effect: "--split: taken, without effect: ...".
  std::vector<std::string> Notes() const;

 private:
  void TakeOption(const std::vector<std::string>& words, size_t* at);

  std::map<std::string, std::string> given_;  // by long name; flags: empty
  std::string name_ = "code";                 // OpenDroneMap's default
  bool help_ = false, version_ = false;
};

}  // namespace skyquilt::odm
