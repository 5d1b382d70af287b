#include "core/config/options.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/config/override.h"
#include "tests/support/error_of.h"

namespace skyquilt::config {
namespace {

struct TrainOptions {
  int steps = 2000;
  double rate = 0.01;
  bool guided = true;
  std::string note = "plain";
  std::vector<double> altitudes_m = {150.0, 300.5};

  static std::vector<Field<TrainOptions>> Fields() {
    using O = TrainOptions;
    return {
        {"steps", &O::steps, Range(), "optimiser updates"},
        {"rate", &O::rate, Range(), "learning rate\nof the first step"},
        {"guided", &O::guided, Range(), "use the context"},
        {"note", &O::note, Range(), "free text"},
        {"altitudes_m", &O::altitudes_m, Range(), "one per block, metres above ground"},
    };
  }
  void Check() const { CheckRanges("train", *this); }
};

struct RenderOptions {
  double exposure_stops = 0.0;
  int supersample = 1;
  int width = 0;
  int threads = -1;
  std::string shape = "round";
  std::vector<double> heights_m;

  static std::vector<Field<RenderOptions>> Fields() {
    using O = RenderOptions;
    return {
        {"exposure_stops", &O::exposure_stops, Range{-10, 10}, "brighter or darker"},
        {"supersample", &O::supersample, Range{1, 8}, "rays per pixel and axis"},
        {"width", &O::width, Range{16, 4096}.MultipleOf(2).Or(0), "pixels"},
        {"threads", &O::threads, Range{1, 64}.OrWord("all", -1), "that render"},
        {"shape", &O::shape, Range::OneOf({"round", "square"}), "of the pixels"},
        {"heights_m", &O::heights_m, Range{0.5, 100}, "of the cameras"},
    };
  }
  // Takes the section's name, because several sections may use the struct.
  void Check(const std::string& section) const {
    CheckRanges(section, *this);
    if (supersample > 1 && exposure_stops > 5.0) throw base::UsageError(section + ".supersample is not allowed with so much light");
  }
};

struct All {
  TrainOptions train;
  RenderOptions render;
  Sections sections;
  All() {
    sections.Add("train", train, "training of one block");
    sections.Add("products.render", render, "pictures");
  }
};

template <typename Error>
std::string MessageOf(const std::string& text) {
  All all;
  return ErrorOf<Error>([&] { ReadTomlText(text, "skyquilt.toml", all.sections); });
}

TEST(Toml, ARetiredOptionIsAcceptedWithoutEffect) {
  All all;
  all.sections.Retire("train.gone", "nothing needs it");
  ReadTomlText("[train]\ngone = 3\nsteps = 7\n", "old.toml", all.sections);
  EXPECT_EQ(all.train.steps, 7);
  ApplyOverride({"train.gone", "4"}, all.sections);
  EXPECT_THROW(ApplyOverride({"train.never", "4"}, all.sections), base::UsageError);
  EXPECT_EQ(WriteToml(all.sections).find("gone"), std::string::npos);
}

TEST(Toml, ARenamedOptionSetsTheNewOne) {
  All all;
  all.sections.Rename("train.strides", "train.steps");
  ReadTomlText("[train]\nstrides = 7\n", "old.toml", all.sections);
  EXPECT_EQ(all.train.steps, 7);
  ApplyOverride({"train.strides", "8"}, all.sections);
  EXPECT_EQ(all.train.steps, 8);
  // The new name wins when both are given, in any order.
  ReadTomlText("[train]\nsteps = 9\nstrides = 10\n", "old.toml", all.sections);
  EXPECT_EQ(all.train.steps, 9);
  EXPECT_EQ(WriteToml(all.sections).find("strides"), std::string::npos);
}

// Like RenderOptions, after an earlier version had the options that are fixed here; one of them is worth a line only when it is set.
struct CloudOptions {
  double size_m = 1.0;
  int seed = 3;

  static std::vector<Field<CloudOptions>> Fields() {
    using O = CloudOptions;
    return {{"size_m", &O::size_m, Range{0, 9}, "of the points"}, {"seed", &O::seed, Range(), "of the colours", Written::kWhenChanged}};
  }
  static std::vector<FixedOption> Fixed() { return {{"radius_m", 0.06}, {"width", 1600}, {"mirrored", false}}; }
  void Check(const std::string& section) const { CheckRanges(section, *this); }
};

struct Clouds {
  CloudOptions near, far;
  std::set<std::string> named;
  Sections sections;
  Clouds() {
    sections.Add("far", far, "");
    sections.Add("near", near, "");
    sections.Inherit("far", "near", {"seed"}, named);
  }
};

TEST(Toml, AFixedOptionIsAcceptedWithItsValueOnly) {
  Clouds clouds;
  ReadTomlText("[near]\nradius_m = 0.06\nwidth = 1600\nmirrored = false\nsize_m = 2\n", "old.toml", clouds.sections);
  EXPECT_EQ(clouds.near.size_m, 2.0);
  ApplyOverride({"far.radius_m", "0.06"}, clouds.sections);
  const auto message = [&](const std::string& text) { return ErrorOf<base::UsageError>([&] { ReadTomlText(text, "old.toml", clouds.sections); }); };
  EXPECT_EQ(message("[near]\nradius_m = 0.1\n"), "old.toml: near.radius_m is fixed at 0.06 now and takes no other value; remove it (line 2)");
  EXPECT_NE(message("[near]\nwidth = \"wide\"\n").find("near.width is fixed at 1600 now"), std::string::npos);
  EXPECT_NE(message("[near]\nmirrored = true\n").find("near.mirrored is fixed at false now"), std::string::npos);
  EXPECT_NE(message("[near]\nmirrored = 0\n").find("near.mirrored is fixed at false now"), std::string::npos);
  EXPECT_NE(message("[near]\nradius_m = false\n").find("near.radius_m is fixed at 0.06 now"), std::string::npos);
  EXPECT_NE(ErrorOf<base::UsageError>([&] { ApplyOverride({"near.width", "100"}, clouds.sections); }).find("near.width is fixed"), std::string::npos);
  EXPECT_EQ(WriteToml(clouds.sections).find("radius_m"), std::string::npos);
  // Results of earlier versions have the same hash.
  EXPECT_EQ(Flatten(clouds.sections).at("near.radius_m"), "0.06");
  EXPECT_EQ(Flatten(clouds.sections).at("far.width"), "1600");
}

TEST(Toml, AnOptionThatFewPeopleLookForIsWrittenWhenItIsSet) {
  Clouds clouds;
  EXPECT_EQ(WriteToml(clouds.sections).find("seed"), std::string::npos);
  EXPECT_EQ(Flatten(clouds.sections).at("near.seed"), "3");
  ApplyOverride({"near.seed", "4"}, clouds.sections);
  Clouds back;
  ReadTomlText(WriteToml(clouds.sections), "written.toml", back.sections);
  EXPECT_EQ(back.near.seed, 4);
  EXPECT_EQ(back.far.seed, 3);
}

TEST(Toml, AnOptionThatIsNotNamedFollowsTheOtherSection) {
  Clouds clouds;
  ReadTomlText("[near]\nsize_m = 2\nseed = 5\n", "one.toml", clouds.sections);
  EXPECT_EQ(clouds.far.size_m, 2.0);
  EXPECT_EQ(clouds.far.seed, 3) << "it is the section's own";
  EXPECT_EQ(WriteToml(clouds.sections).find("size_m"), WriteToml(clouds.sections).rfind("size_m")) << "the inherited value is not written";
  // In any order within a file, and before or after the other section's value.
  ReadTomlText("[far]\nsize_m = 7\n[near]\nsize_m = 6\n", "two.toml", clouds.sections);
  EXPECT_EQ(clouds.far.size_m, 7.0);
  ApplyOverride({"near.size_m", "8"}, clouds.sections);
  EXPECT_EQ(clouds.far.size_m, 7.0) << "a value that was named stays";
  Clouds back;
  ReadTomlText(WriteToml(clouds.sections), "written.toml", back.sections);
  EXPECT_EQ(Flatten(back.sections), Flatten(clouds.sections));
  // Also one that was named with the value of the other section.
  Clouds equal;
  ApplyOverride({"far.size_m", "1"}, equal.sections);
  ApplyOverride({"near.size_m", "2"}, equal.sections);
  EXPECT_EQ(equal.far.size_m, 1.0);
}

TEST(Toml, AValueOutOfRangeIsRefusedWithItsLineAndRange) {
  EXPECT_EQ(MessageOf<base::UsageError>("[products.render]\nsupersample = 9\n"),
            "skyquilt.toml: products.render.supersample = 9 is not allowed: it must be 1 to 8 (line 2)");
  EXPECT_EQ(MessageOf<base::UsageError>("[products.render]\nwidth = 17\n"),
            "skyquilt.toml: products.render.width = 17 is not allowed: it must be 0 or 16 to 4096 in steps of 2 (line 2)");
  EXPECT_EQ(MessageOf<base::UsageError>("[products.render]\nheights_m = [1, 0.25]\n"),
            "skyquilt.toml: products.render.heights_m[1] = 0.25 is not allowed: it must be 0.5 to 100 (line 2)");
  EXPECT_NE(MessageOf<base::UsageError>("[products.render]\nexposure_stops = inf\n").find("-10 to 10"), std::string::npos);
  EXPECT_EQ(MessageOf<base::UsageError>("[products.render]\nshape = \"oval\"\n"),
            "skyquilt.toml: products.render.shape = \"oval\" is not allowed: it must be round or square (line 2)");
}

TEST(Toml, AWordStandsForANumber) {
  All all;
  EXPECT_EQ(Flatten(all.sections).at("products.render.threads"), "\"all\"");
  EXPECT_NE(WriteToml(all.sections).find("# allowed: all or 1 to 64\nthreads = \"all\"\n"), std::string::npos) << WriteToml(all.sections);
  ReadTomlText("[products.render]\nthreads = 7\n", "a.toml", all.sections);
  EXPECT_EQ(all.render.threads, 7);
  EXPECT_EQ(Flatten(all.sections).at("products.render.threads"), "7");
  ReadTomlText("[products.render]\nthreads = \"all\"\n", "a.toml", all.sections);
  EXPECT_EQ(all.render.threads, -1);
  all.render.threads = 7;
  ApplyOverride({"products.render.threads", "all"}, all.sections);
  EXPECT_EQ(all.render.threads, -1);
  EXPECT_NO_THROW(all.sections.Check());
  for (const char* text : {"-1", "0", "\"some\"", "\"-1\""}) {
    const std::string message = MessageOf<base::UsageError>("[products.render]\nthreads = " + std::string(text) + "\n");
    EXPECT_NE(message.find("threads"), std::string::npos) << text << ": " << message;
  }
  EXPECT_NE(MessageOf<base::UsageError>("[products.render]\nthreads = -1\n").find("all or 1 to 64"), std::string::npos);
  // A word for whole numbers is none for other options.
  EXPECT_NE(MessageOf<base::UsageError>("[train]\nsteps = \"all\"\n").find("train.steps"), std::string::npos);
}

TEST(Override, IsReadLikeALineOfAFile) {
  All all;
  const auto set = [&](const std::string& text) { ApplyOverride(ParseOverride(text), all.sections); };
  const auto refusal = [&](const std::string& text) { return ErrorOf<base::UsageError>([&] { set(text); }); };
  set("train.note = a \"quoted\" \\ word");
  EXPECT_EQ(all.train.note, "a \"quoted\" \\ word");
  set("train.note=\"in TOML's \\t own way\"");
  EXPECT_EQ(all.train.note, "in TOML's \t own way");
  set("train.altitudes_m=100, 2.5");
  EXPECT_EQ(all.train.altitudes_m, (std::vector<double>{100.0, 2.5}));
  set("train.altitudes_m=[]");
  EXPECT_TRUE(all.train.altitudes_m.empty());
  set("train.guided=false");
  EXPECT_FALSE(all.train.guided);
  set("train.guided=yes");
  EXPECT_TRUE(all.train.guided);
  set("train.guided=0");
  EXPECT_FALSE(all.train.guided);
  for (const char* other : {"train . guided=false", "train.\"guided\"=false", "\"train\".guided=false", "#train.guided=true"}) {
    EXPECT_NE(refusal(other).find("is not an option"), std::string::npos) << other;
  }
  set("products.render.shape=square");
  EXPECT_EQ(all.render.shape, "square");
  // Options of --set have no file and no line.
  EXPECT_EQ(refusal("products.render.supersample=0"), "products.render.supersample = 0 is not allowed: it must be 1 to 8");
  EXPECT_EQ(refusal("train.steps=3.5"), "train.steps must be a whole number, found a decimal number");
  EXPECT_NE(refusal("train.steps=many").find("train.steps = 'many' is not understood"), std::string::npos);
  EXPECT_NE(refusal("train.stepz=3").find("'train.steps'"), std::string::npos);
  EXPECT_NE(refusal("train.steps=").find("train.steps"), std::string::npos);
  EXPECT_NE(refusal("train.steps=7\ntrain.rate=9").find("not understood"), std::string::npos);
  set("train.note=two\nlines");
  EXPECT_EQ(all.train.note, "two\nlines");
}

TEST(Sections, CheckNamesSectionAndRange) {
  All all;
  EXPECT_NO_THROW(all.sections.Check());
  all.render.width = 15;
  EXPECT_EQ(ErrorOf<base::UsageError>([&] { all.sections.Check(); }),
            "products.render.width = 15 is not allowed: it must be 0 or 16 to 4096 in steps of 2");
  all.render.width = 0;
  all.render.exposure_stops = 6.0;
  all.render.supersample = 2;
  EXPECT_EQ(ErrorOf<base::UsageError>([&] { all.sections.Check(); }), "products.render.supersample is not allowed with so much light");
}

TEST(Toml, ValuesComeBackExactly) {
  All written;
  written.train.steps = std::numeric_limits<int>::min();
  written.train.rate = 0.1 + 0.2;
  written.train.guided = false;
  written.train.note = "quote \" backslash \\ tab \t newline \n bell \a umlaut \xc3\xbc # no comment";
  written.train.altitudes_m = {-0.0, 1e-300, 5e-324, 123456789.0, 1e22, std::numeric_limits<double>::infinity(), 1.0 / 3.0};
  written.render.exposure_stops = -10.0;
  const std::string text = WriteToml(written.sections);
  All read;
  ReadTomlText(text, "skyquilt.toml", read.sections);
  EXPECT_EQ(read.train.steps, written.train.steps);
  EXPECT_EQ(read.train.rate, written.train.rate);
  EXPECT_EQ(read.train.guided, written.train.guided);
  EXPECT_EQ(read.train.note, written.train.note);
  EXPECT_EQ(read.train.altitudes_m, written.train.altitudes_m);
  EXPECT_EQ(read.render.exposure_stops, written.render.exposure_stops);
  EXPECT_EQ(WriteToml(read.sections), text);
}

TEST(Toml, EmptyArrayAndStringComeBack) {
  All written;
  written.train.note = "";
  written.train.altitudes_m = {};
  All read;
  ReadTomlText(WriteToml(written.sections), "skyquilt.toml", read.sections);
  EXPECT_EQ(read.train.note, "");
  EXPECT_TRUE(read.train.altitudes_m.empty());
}

TEST(Toml, EveryHelpLineIsAComment) {
  All all;
  const std::string text = WriteToml(all.sections);
  for (const char* part :
       {"# training of one block\n[train]\n", "# optimiser updates\nsteps = 2000\n", "# learning rate\n# of the first step\nrate = 0.01\n",
        "[products.render]\n", "# brighter or darker\n# allowed: -10 to 10\nexposure_stops = 0.0\n",
        "# allowed: 0 or 16 to 4096 in steps of 2\nwidth = 0\n", "# allowed: round or square\nshape = \"round\"\n", "altitudes_m = [150.0, 300.5]\n",
        "guided = true\n", "note = \"plain\"\n"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "in\n" << text;
  }
}

TEST(Toml, AbsentKeysKeepTheirValues) {
  All all;
  all.train.rate = 5.0;
  ReadTomlText("[train]\nsteps = 7\n", "skyquilt.toml", all.sections);
  EXPECT_EQ(all.train.steps, 7);
  EXPECT_EQ(all.train.rate, 5.0);
  ReadTomlText("", "skyquilt.toml", all.sections);
  EXPECT_EQ(all.train.steps, 7);
}

TEST(Toml, IntegersServeAsNumbers) {
  All all;
  ReadTomlText("train.rate = 3\ntrain.altitudes_m = [100, 2.5]\n[products.render]\nexposure_stops = -2\n", "skyquilt.toml", all.sections);
  EXPECT_EQ(all.train.rate, 3.0);
  EXPECT_EQ(all.train.altitudes_m, (std::vector<double>{100.0, 2.5}));
  EXPECT_EQ(all.render.exposure_stops, -2.0);
}

TEST(Toml, UnknownNamesAreRefusedWithTheNearest) {
  EXPECT_EQ(MessageOf<base::UsageError>("[train]\nstepz = 3\n"), "skyquilt.toml: unknown key 'train.stepz'; did you mean 'train.steps'? (line 2)");
  EXPECT_EQ(MessageOf<base::UsageError>("[trian]\nsteps = 3\n"), "skyquilt.toml: unknown section 'trian'; did you mean 'train'? (line 1)");
  // The right key in the wrong section.
  EXPECT_NE(MessageOf<base::UsageError>("[train]\nsupersample = 3\n").find("'products.render.supersample'"), std::string::npos);
  EXPECT_NE(MessageOf<base::UsageError>("steps = 3\n").find("'train.steps'"), std::string::npos);
  // No similar name: lists the known ones.
  EXPECT_NE(MessageOf<base::UsageError>("[train]\nxxxxxxxxxx = 3\n").find("guided"), std::string::npos);
  EXPECT_NE(MessageOf<base::UsageError>("[zzzzzzzzzz]\n").find("products.render"), std::string::npos);
  EXPECT_NE(MessageOf<base::UsageError>("[train.deeper]\nsteps = 1\n").find("unknown section 'train.deeper'"), std::string::npos);
}

TEST(Toml, WrongTypesAreRefused) {
  for (const char* text : {"[train]\nsteps = 3.5\n", "[train]\nsteps = \"3\"\n", "[train]\nsteps = 3000000000\n", "[train]\nrate = true\n",
                           "[train]\nrate = nan\n", "[train]\nguided = 1\n", "[train]\nnote = 3\n", "[train]\naltitudes_m = 3.0\n",
                           "[train]\naltitudes_m = [1.0, \"2\"]\n", "[train]\nrate = 2026-01-31\n", "[train.rate]\n", "train = 3\n"}) {
    const std::string message = MessageOf<base::UsageError>(text);
    EXPECT_NE(message.find("skyquilt.toml"), std::string::npos) << text;
    EXPECT_NE(message.find("train"), std::string::npos) << text << message;
    EXPECT_NE(message.find("line"), std::string::npos) << text << message;
  }
}

TEST(Toml, SyntaxErrorsNameTheLine) {
  const std::string message = MessageOf<base::InputError>("[train]\nsteps = 3\nrate = = 4\n");
  EXPECT_NE(message.find("skyquilt.toml"), std::string::npos) << message;
  EXPECT_NE(message.find("line 3"), std::string::npos) << message;
  EXPECT_NE(MessageOf<base::InputError>("[train]\nsteps = 3\nsteps = 4\n"), "");
  EXPECT_NE(MessageOf<base::InputError>("[train]\nnote = unquoted\n"), "");
}

TEST(Toml, OtherCharactersStandInQuotesAndCommentsOnly) {
  All all;
  const auto read = [&](const std::string& text) { ReadTomlText(text, "skyquilt.toml", all.sections); };
  for (const char* text : {"\xEF\xBB\xBF[train]\nnote = \"M\u00fcller\" # \u00fc\n", "[train]\nnote = '\"\u00fc'\n",
                           "[train]\nnote = \"\\\"\u00fc\"\n", "[train]\nnote = \"\"\"a\n\"\u00fc\"\"\"\n", "[train]\nnote = '''a\\\n'\u00fc'''\n"}) {
    EXPECT_NO_THROW(read(text)) << text;
    EXPECT_NE(all.train.note.find("\u00fc"), std::string::npos) << text;
  }
  // The first was found by fuzzing: toml++ asks about the character what it cannot answer.
  for (const char* text :
       {"[train]\nnote = \u035a-2\n", "[train]\nnote = \u201cquoted\u201d\n", "[train]\nst\u00e9ps = 3\n", "[train]\nnote = \"open\n\u00fc\""}) {
    EXPECT_NE(MessageOf<base::InputError>(text).find("line "), std::string::npos) << text;
  }
  EXPECT_NE(MessageOf<base::InputError>("[train]\nsteps = \u201c3\u201d\n").find("line 2: here is a character"), std::string::npos);
}

TEST(Toml, FilesAreReadAndMissingOnesNamed) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("skyquilt_options_test_" + std::to_string(getpid()) + ".toml");
  base::WriteFileAtomically(file, "[train]\nsteps = 9\n");
  All all;
  ReadToml(file, all.sections);
  EXPECT_EQ(all.train.steps, 9);
  std::filesystem::remove(file);
  EXPECT_THROW(ReadToml(file, all.sections), base::InputError);
}

TEST(Flatten, HashFollowsEveryValueAndNothingElse) {
  All one;
  All two;
  EXPECT_EQ(Flatten(one.sections).size(), 11U);
  EXPECT_EQ(Flatten(one.sections).at("train.rate"), "0.01");
  EXPECT_EQ(Flatten(one.sections).at("products.render.supersample"), "1");
  EXPECT_EQ(Hash(Flatten(one.sections)), Hash(Flatten(two.sections)));
  EXPECT_EQ(Hash(Flatten(one.sections)).size(), 16U);
  two.train.rate = std::nextafter(two.train.rate, 1.0);
  EXPECT_NE(Hash(Flatten(one.sections)), Hash(Flatten(two.sections)));
}

TEST(Differences, NameEveryChangedKey) {
  All one;
  All two;
  EXPECT_TRUE(Differences(Flatten(one.sections), Flatten(two.sections)).empty());
  two.train.steps = 4000;
  std::map<std::string, std::string> after = Flatten(two.sections);
  after.erase("train.note");
  after["train.zeal"] = "1";
  EXPECT_EQ(Differences(Flatten(one.sections), after),
            (std::vector<std::string>{"train.note: \"plain\" -> (none)", "train.steps: 2000 -> 4000", "train.zeal: (none) -> 1"}));
}

TEST(Nearest, FindsTypingErrorsOnly) {
  const std::vector<std::string> words = {"steps", "rate", "levels", "log2_table_size"};
  EXPECT_EQ(Nearest("stpes", words), "steps");
  EXPECT_EQ(Nearest("level", words), "levels");
  EXPECT_EQ(Nearest("raet", words), "rate");
  EXPECT_EQ(Nearest("log2_tabel_sise", words), "log2_table_size");
  EXPECT_EQ(Nearest("steps", words), "steps");
  EXPECT_EQ(Nearest("brightness", words), "");
  EXPECT_EQ(Nearest("anything", {}), "");
}

}  // namespace
}  // namespace skyquilt::config
