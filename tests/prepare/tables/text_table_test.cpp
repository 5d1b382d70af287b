#include "prepare/tables/text_table.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/base/text.h"
#include "tests/support/error_of.h"

namespace skyquilt::prepare::tables {
namespace {

using Fields = std::vector<std::string>;

TextTable Parse(const std::string& text) {
  return ParseTextTable("table.txt", text);
}

TEST(TextTable, UnderstandsWhatSpreadsheetsAndWindowsWrite) {
  const TextTable table = Parse("\xEF\xBB\xBF\"EPSG:4326\",,,\r\n\r\n# a remark\r\n\"DJI 1.JPG\",8.4,\"47,1\",\r\n# another\r\nb.jpg , 8 ,47, 3\r\n");
  EXPECT_EQ(table.crs, "EPSG:4326");
  EXPECT_EQ(table.crs_line, 1);
  EXPECT_EQ(table.separator, ',');
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].fields, (Fields{"DJI 1.JPG", "8.4", "47,1", ""}));
  EXPECT_EQ(table.rows[0].line, 4);
  EXPECT_EQ(table.rows[1].fields, (Fields{"b.jpg", "8", "47", "3"}));
  EXPECT_EQ(table.rows[1].line, 6);
}

TEST(TextTable, TabsAloneSeparateWhereFieldsHaveSpacesOrNothing) {
  const TextTable table = Parse("DJI 1.JPG\t8.4\t47.1\t\t\t\t\t0.02\nb.jpg\t8.5\t47.2\t400\t0\t0\t0\t0.02\n");
  EXPECT_EQ(table.separator, '\t');
  EXPECT_EQ(table.rows[0].fields, (Fields{"DJI 1.JPG", "8.4", "47.1", "", "", "", "", "0.02"}));
}

TEST(TextTable, TabsAreSpacesWhereTheyAlignOrMixWithSpaces) {
  EXPECT_EQ(Parse("A\t\t586000\t4507000\t3\nLONG NAME\t1\t2\t3\n").rows[0].fields, (Fields{"A", "586000", "4507000", "3"}));
  EXPECT_EQ(Parse("1 2 3\t4 5\ta.jpg\tA\n").rows[0].fields, (Fields{"1", "2", "3", "4", "5", "a.jpg", "A"}));
}

TEST(TextTable, CommasInNumbersAreDecimalOnesBetweenOtherSeparators) {
  for (const char* text : {"a.jpg 8,4 47,1 400\nb.jpg 8 47,2 401,5\n", "a.jpg\t8,4\t47,1\t400\nb.jpg\t8\t47,2\t401,5\n", "a.jpg;8,4;47,1;400\n"}) {
    const TextTable table = Parse(text);
    EXPECT_TRUE(table.decimal_comma) << text;
    EXPECT_EQ(table.rows[0].fields, (Fields{"a.jpg", "8,4", "47,1", "400"})) << text;
  }
  for (const char* text : {"My point 1,586000,4507000,3\n", "My point 1, 586000, 4507000, 3\n", "My point 1 ,586000 ,4507000 ,3\n"}) {
    const TextTable commas = Parse(text);
    EXPECT_FALSE(commas.decimal_comma) << text;
    EXPECT_EQ(commas.rows[0].fields, (Fields{"My point 1", "586000", "4507000", "3"})) << text;
  }
  EXPECT_EQ(Parse("1, 586000, 4507000, 3\n").rows[0].fields, (Fields{"1", "586000", "4507000", "3"}));
}

TEST(TextTable, QuotesEncloseSpacesAlsoBetweenSpaces) {
  EXPECT_EQ(Parse("\"my photo.jpg\" 8 47 label\"s\n").rows[0].fields, (Fields{"my photo.jpg", "8", "47", "label\"s"}));
  EXPECT_EQ(Parse("\"unclosed 8 47\n").rows[0].fields, (Fields{"\"unclosed", "8", "47"}));
}

TEST(TextTable, SystemsOfManyKindsAreRecognised) {
  for (const char* crs : {"EPSG:32632", "epsg:4326", "WGS84", "WGS84 UTM 32N", "+proj=utm +zone=10 +datum=WGS84", "IGNF:LAMB93", "OGC:CRS84",
                          "NAD83 / UTM zone 10N", "urn:ogc:def:crs:EPSG::4326"}) {
    const TextTable table = Parse(std::string(crs) + "\na.jpg 8 47\n");
    EXPECT_EQ(table.crs, crs);
    EXPECT_EQ(table.rows.size(), 1U);
  }
  EXPECT_EQ(Parse("a.jpg 8 47\n").crs, "");
  EXPECT_EQ(Parse("C:\\flight\\a.jpg 8 47\n").crs, "");
}

TEST(TextTable, NumbersAreFiniteAndWhole) {
  EXPECT_EQ(ParseTableNumber("+8.5", false), 8.5);
  EXPECT_EQ(ParseTableNumber("8,5", true), 8.5);
  for (const char* text : {"", "nan", "inf", "1e10", "8,5", "8.5m", "1 2", "+"}) EXPECT_EQ(ParseTableNumber(text, false), std::nullopt) << text;
  for (const char* text : {"", "NaN", "none", "NULL", "n/a"}) EXPECT_TRUE(IsNoValue(text)) << text;
  EXPECT_FALSE(IsNoValue("0"));
}

TEST(TextTable, OtherFilesAreNamedAsSuch) {
  const std::string binary = InputErrorOf([] { Parse(std::string("a,1\nb\0,2\n", 9)); });
  EXPECT_NE(binary.find("table.txt: line 2: has a character that text does not have"), std::string::npos) << binary;
  const std::string endless = InputErrorOf([] { Parse(std::string(70000, 'a')); });
  EXPECT_NE(endless.find("line 1: is longer than 64 KiB"), std::string::npos) << endless;
}

// Names with spaces, quotes and the other dialects' separators.
RC_GTEST_PROP(TextTableProperty, FieldsReadBackTheSameInEveryDialect, ()) {
  const char separator = *rc::gen::element(',', ';', '\t', ' ');
  const bool decimal_comma = separator != ',' && *rc::gen::arbitrary<bool>();
  const bool windows = *rc::gen::arbitrary<bool>(), remarks = *rc::gen::arbitrary<bool>();
  const int n_rows = *rc::gen::inRange(2, 6);
  std::vector<Fields> rows;
  std::string text = windows ? "\xEF\xBB\xBF" : "";
  for (int i = 0; i < n_rows; ++i) {
    Fields row = {"photo " + std::string(1, *rc::gen::element('a', 'Z', '_', '(')) + std::to_string(i) + " x.jpg"};
    for (int k = 0; k < 3; ++k) {
      const int whole = *rc::gen::inRange(-90000, 90000), decimals = *rc::gen::inRange(100, 999);
      row.push_back(std::to_string(whole) + (decimal_comma ? "," : ".") + std::to_string(decimals));
    }
    if (remarks) text += windows ? "# remark\r\n\r\n" : "# remark\n\n";
    text +=
        (separator == ' ' ? "\"" + row[0] + "\"" : row[0]) + separator + base::Join(Fields(row.begin() + 1, row.end()), std::string(1, separator));
    text += windows ? "\r\n" : "\n";
    rows.push_back(row);
  }
  const TextTable table = Parse(text);
  RC_ASSERT(table.rows.size() == rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    RC_ASSERT(table.rows[i].fields == rows[i]);
    for (size_t k = 1; k < 4; ++k) {
      const bool is_number = ParseTableNumber(rows[i][k], table.decimal_comma).has_value();
      RC_ASSERT(is_number);
    }
  }
}

}  // namespace
}  // namespace skyquilt::prepare::tables
