// The options of 'skyquilt odm', with OpenDroneMap's names, meanings and ranges. Their one table is share/skyquilt/odm/opendm/options.json: it is
// built into the program, and config.py beside it declares the same options to NodeODM.
#pragma once

#include <string>
#include <vector>

namespace skyquilt::odm {

enum class OptionKind {
  kFlag,    // without a value
  kInt,     //
  kFloat,   //
  kChoice,  // one of OptionSpec::choices
  kText,    //
  kPath,    //
  kJson     // a path, or JSON text
};

struct OptionSpec {
  std::string name;  // with its dashes: "--dsm"
  std::string short_name;
  OptionKind kind = OptionKind::kFlag;
  std::string default_value;  // empty: none
  std::vector<std::string> choices;
  std::string domain;  // in NodeODM's words, see DomainProblem; of choices without meaning
  std::string help;
  std::string no_effect;  // why it is taken without effect; empty: it has one
  std::string refused;    // why every value but the default ends the command; empty: it does not
};

// The text of options.json.
const char* OptionsJson();
// In the order of the file.
const std::vector<OptionSpec>& Options();
// By its long or short name; null: there is none.
const OptionSpec* FindOption(const std::string& name);
// Why the option cannot have this value ("must be from 1 to 14, not 20"); empty when it can. Ranges are written as NodeODM reads them:
// "positive integer" and "positive float" (0 too), "float > 0.0", "integer: 1 <= x <= 14".
std::string ValueProblem(const OptionSpec& option, const std::string& value);
// Name, value and help of every option, for people.
std::string OptionsHelp();

}  // namespace skyquilt::odm
