// The results of a bench for readers. From one BenchPage come a text table for the terminal, CSV for other programs, and an HTML page with plots and
// images that needs no internet connection.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace skyquilt::bench {

// One cell of a table: the text that is shown, and the number for sorting and CSV (NaN for plain text).
struct BenchCell {
  std::string shown;
  double value = std::numeric_limits<double>::quiet_NaN();

  static BenchCell Text(std::string shown) { return {std::move(shown)}; }
  // An en dash for NaN.
  static BenchCell Number(double value, int decimals, const std::string& unit = "");
  static BenchCell Percent(double share, int decimals = 1);  // share: 0..1
  static BenchCell Count(double value);                      // "1.53 M"
  static BenchCell Bytes(double bytes);
  static BenchCell Seconds(double seconds);
};

struct BenchTable {
  std::string name;   // its CSV file is BENCH_NAME.csv, or BENCH.csv when empty
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
  std::vector<std::string> charts;  // HTML <figure> elements, from page::CurveChart and page::BarChart
  std::vector<BenchTable> tables;
  std::vector<BenchPicture> pictures;  // in rows of up to four
  bool magnified = true;               // shows an enlarged part of all pictures, which follows the pointer
};

// A key figure at the top of the page: "Best", "27.3 dB", "3 x 3 blocks".
struct BenchFigure {
  std::string label, value, note;
};

struct BenchPage {
  std::string name;                   // of the files, for instance "tradeoff"
  std::string title;                  // of the page
  std::string lead;                   // the question and how it was measured
  std::vector<BenchFigure> figures;   // the answer in a few numbers
  std::vector<std::string> verdicts;  // sentences that say what the numbers mean and whether targets are met
  std::vector<BenchSection> sections;
  std::string command;  // command line that made the page
  std::string machine;
  std::string date;  // UTC

  // The three above: this command, this machine, now.
  void SetOrigin(const std::string& command_line);
};

// For the terminal: figures, tables and verdicts.
std::string BenchText(const BenchPage& page);
std::string BenchHtml(const BenchPage& page);
// Format of RFC 4180: numbers in full precision, texts quoted where needed.
std::string BenchCsv(const BenchTable& table);

// Writes NAME.json, NAME.html, and NAME.csv or NAME_TABLE.csv for every table. Throws base::InputError.
void WriteBench(const std::filesystem::path& folder, const BenchPage& page, const std::string& json);

}  // namespace skyquilt::bench
