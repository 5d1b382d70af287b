// What a bench found, as people read it: a text table for the terminal, CSV for other programs, one offline HTML page with plots and pictures.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace skyquilt::bench {

// One value of a table: what is shown, and the number behind it (sorting, CSV), NaN for plain text.
struct BenchCell {
  std::string shown;
  double value = std::numeric_limits<double>::quiet_NaN();

  static BenchCell Text(std::string shown) { return {std::move(shown)}; }
  // An en dash for NaN.
  static BenchCell Number(double value, int decimals, const std::string& unit = "");
  static BenchCell Percent(double share, int decimals = 1);
  static BenchCell Count(double value);  // "1.53 M"
  static BenchCell Bytes(double bytes);
  static BenchCell Seconds(double seconds);
};

struct BenchTable {
  std::string name;   // of its CSV file, behind the bench's; empty: the bench's alone
  std::string title;  // may be empty
  std::string note;   // under the table; may be empty
  std::vector<std::string> columns;
  std::vector<std::vector<BenchCell>> rows;  // as many cells as columns
};

struct BenchPicture {
  std::string file;  // relative to the page
  std::string caption;
};

struct BenchSection {
  std::string id;  // unique in the page
  std::string title;
  std::string lead;                 // a paragraph; may be empty
  std::vector<std::string> charts;  // <figure>s, as report::CurveChart makes them
  std::vector<BenchTable> tables;
  std::vector<BenchPicture> pictures;  // in rows of up to four
};

struct BenchFigure {
  std::string label, value, note;
};

struct BenchPage {
  std::string name;                   // "tradeoff": of the files
  std::string title;                  // a sentence
  std::string lead;                   // what was asked and how it was measured
  std::vector<BenchFigure> figures;   // the answer in a few numbers
  std::vector<std::string> verdicts;  // sentences that say what the numbers mean, targets included
  std::vector<BenchSection> sections;
  std::string command;  // that made it
  std::string machine;
  std::string date;  // UTC
};

// For a terminal: figures, verdicts and tables.
std::string BenchText(const BenchPage& page);
std::string BenchHtml(const BenchPage& page);
// RFC 4180: numbers in full, texts quoted where needed.
std::string BenchCsv(const BenchTable& table);

// NAME.json, NAME.html, NAME.csv or NAME_TABLE.csv for every table. Throws base::InputError.
void WriteBench(const std::filesystem::path& folder, const BenchPage& page, const std::string& json);

}  // namespace skyquilt::bench
