// Reads control points from texts.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/base/errors.h"
#include "prepare/control/reading/read_control.h"
#include "tests/prepare/control/reading/made_control_files.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::control {

class ControlReader : public ::testing::Test {
 protected:
  // The points' file is `points` in the folder; so is that of the marks unless it is empty.
  ControlPoints Read(const test::ControlTexts& texts, ControlFiles files) {
    test::WriteTexts(texts, folder_.path());
    files.points = folder_ / files.points.string();
    if (!files.marks.empty()) files.marks = folder_ / files.marks.string();
    return ReadControl(files, made_.photos);
  }
  ControlPoints ReadList(const std::string& text, ControlFiles files = {}) {
    files.points = "gcp_list.txt";
    return Read({{"gcp_list.txt", text}}, files);
  }
  // A table of points with the marks of the made survey.
  ControlPoints ReadTable(const std::string& text, ControlFiles files = {}) {
    test::ControlTexts texts = test::Pix4dFiles(made_, "EPSG:32618");
    texts["points.csv"] = text;
    files.points = "points.csv";
    files.marks = "marks.csv";
    return Read(texts, files);
  }

  test::MadeControl made_ = test::MakeControl();
  TemporaryFolder folder_;
};

}  // namespace skyquilt::prepare::control
