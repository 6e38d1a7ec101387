#pragma once

// What a run leaves behind: history.csv, JSON, pictures, the report, VTU files
// and the lines on the terminal.

#include "core/output_folder.h"
#include "postprocess/history_file.h"
#include "postprocess/progress.h"
#include "postprocess/report.h"
#include "postprocess/summary_file.h"
#include "postprocess/vtu.h"
#include "visualization/svg.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace output_checks
{
  using namespace nsfd;

  const double nan_value = std::numeric_limits<double>::quiet_NaN();

  inline std::string scratch(const std::string &name)
  {
    const std::string folder = testing::TempDir() + "nsfd_test_output/";
    std::filesystem::create_directories(folder);
    return folder + name;
  }

  inline std::string read(const std::string &path)
  {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file) << path;
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  inline std::size_t n_times(const std::string &text, const std::string &part)
  {
    std::size_t n = 0;
    for (auto at = text.find(part); at != std::string::npos;
         at = text.find(part, at + part.size()))
      ++n;
    return n;
  }

  /** Every tag is closed in order; empty if so, else the offending tag. */
  inline std::string
  unbalanced_tag(const std::string &text,
                 const std::vector<std::string> &never_closed = {})
  {
    std::vector<std::string> open;
    for (auto begin = text.find('<'); begin != std::string::npos;
         begin = text.find('<', begin)) {
      const auto end = text.find('>', begin);
      if (end == std::string::npos)
        return "'<' that is not closed";
      const std::string tag = text.substr(begin + 1, end - begin - 1);
      begin = end;
      if (tag[0] == '?' || tag[0] == '!' || tag.back() == '/')
        continue;
      const std::string name = tag.substr(
          tag[0] == '/', tag.find_first_of(" \n/>", 1) - (tag[0] == '/'));
      if (std::count(never_closed.begin(), never_closed.end(), name))
        continue;
      if (tag[0] != '/')
        open.push_back(name);
      else if (open.empty() || open.back() != tag.substr(1))
        return tag;
      else
        open.pop_back();
    }
    return open.empty() ? "" : open.back();
  }

  inline void expect_good_svg(const std::string &svg)
  {
    EXPECT_EQ(unbalanced_tag(svg), "");
    EXPECT_EQ(svg.find("nan"), std::string::npos) << svg;
    EXPECT_EQ(svg.find("inf"), std::string::npos) << svg;
  }

  /**
   * A plate of n x n cells, 10 um wide, torn along its middle: the halves are
   * apart by @p opening, the upper quarter of the crack is not broken yet.
   */
  inline Snapshot torn_plate(const unsigned int n, const double opening)
  {
    Snapshot snapshot;
    snapshot.time = 5e-9;
    const double h = 10e-6 / n;
    for (unsigned int j = 0; j < n; ++j)
      for (unsigned int i = 0; i < n; ++i) {
        Snapshot::Polygon cell;
        for (const auto &corner :
             {std::array<unsigned int, 2>{0, 0}, {1, 0}, {1, 1}, {0, 1}})
          cell.reference.push_back(
              {(i + corner[0]) * h, (j + corner[1]) * h, 0.});
        const double u = (i < n / 2 ? -0.5 : 0.5) * opening;
        cell.displacement.assign(4, {u, 0., 0.});
        cell.value = 1e8 * (i + j) / (2. * n);
        cell.fragment = i < n / 2 ? 0 : 1;
        snapshot.polygons.push_back(cell);
      }
    for (unsigned int j = 0; j < n; ++j) {
      Snapshot::FacePiece face;
      face.a = {5e-6, j * h, 0.};
      face.b = {5e-6, (j + 1) * h, 0.};
      face.displacement_a = face.displacement_b = {};
      face.can_break = true;
      face.beta = j < 3 * n / 4 ? 0. : 0.5;
      snapshot.faces.push_back(face);
    }
    return snapshot;
  }

  inline HistoryRow history_row(const unsigned int step)
  {
    HistoryRow row;
    row.step = step;
    row.time = 1e-11 * step;
    row.time_step = 1e-11;
    row.energy.kinetic = 0.1 + 0.2;
    row.residual = 1e-10;
    row.reactions = {1. / 3., -2.};
    return row;
  }
} // namespace output_checks
