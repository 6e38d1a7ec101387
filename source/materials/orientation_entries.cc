#include "orientation_entries.h"

#include "anisotropy.h"

#include "nsfd/materials/material_entries.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"
#include "parameters/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace nsfd::materials
{
  namespace
  {
    const std::vector<std::string> entries = {
        "Euler angles",     "axis 1",           "axis 2",
        "orientation seed", "orientation file", "orientation data"};

    /** Those of the others mean nothing. */
    void refuse_all_but(SectionReader &reader,
                        const std::vector<std::string> &own,
                        const std::string &chosen)
    {
      for (const std::string &name : entries)
        if (std::find(own.begin(), own.end(), name) == own.end())
          reader.refuse({name},
                        fmt::format("the block has orientation = {}", chosen));
    }

    void read_angles(SectionReader &reader, OrientationInput &orientation)
    {
      const std::string name = entries[0];
      const auto given = reader.raw(
          name, "0, 0, 0",
          "degrees, phi1, Phi, phi2 of Bunge; may depend on x, y, z");
      if (!given)
        return;
      const auto parts = given->split(',');
      if (parts.size() != 3)
        return reader.error(name,
                            fmt::format("{} = {} has {} value{}, 3 are needed",
                                        name, given->text(), parts.size(),
                                        parts.size() == 1 ? "" : "s"),
                            "write phi1, Phi, phi2 in degrees, for example: "
                            "set Euler angles = 30, 45, 0");
      for (unsigned int k = 0; k < 3; ++k) {
        orientation.angles[k] =
            reader.expression_in(parts[k], name, units::none);
        if (orientation.angles[k].depends_on_time())
          reader.error(name,
                       fmt::format("{} depends on t, but a crystal keeps its "
                                   "axes",
                                   parts[k].text()),
                       "write a number or a formula of x, y, z");
      }
    }

    void read_axes(SectionReader &reader, OrientationInput &orientation)
    {
      const unsigned int n_before = reader.errors().n_errors();
      std::array<std::array<double, 3>, 3> axes{};
      for (unsigned int k = 0; k < 2; ++k) {
        const std::string name = entries[1 + k];
        const auto given = reader.numbers(
            name, "", units::none, Range::any(), 3,
            fmt::format("direction of axis {} of the crystal, of any length",
                        k + 1));
        const double size = std::hypot(given[0], given[1], given[2]);
        if (reader.errors().n_errors() == n_before && size == 0.)
          reader.error(name, "the axis has no direction",
                       fmt::format("write for example: set {} = {}", name,
                                   k == 0 ? "1, 1, 0" : "-1, 1, 0"));
        for (unsigned int c = 0; c < 3; ++c)
          axes[k][c] = given[c] / (size > 0. ? size : 1.);
      }
      if (reader.errors().n_errors() > n_before)
        return;
      double cosine = 0.;
      for (unsigned int c = 0; c < 3; ++c)
        cosine += axes[0][c] * axes[1][c];
      constexpr double slack = 1e-6; // digits that a user writes
      if (std::abs(cosine) > slack) {
        double normal[3];
        for (unsigned int c = 0; c < 3; ++c)
          normal[c] = axes[1][c] - cosine * axes[0][c];
        return reader.error(
            entries[2],
            fmt::format("axes 1 and 2 of the crystal are {:.4g} degrees apart "
                        "instead of 90",
                        std::acos(cosine) * 180. / std::acos(-1.)),
            std::abs(cosine) > 1. - slack
                ? "write a direction across axis 1"
                : fmt::format("write for example: set axis 2 = {:.7g}, {:.7g}, "
                              "{:.7g}",
                              normal[0], normal[1], normal[2]));
      }
      double size = 0.;
      for (unsigned int c = 0; c < 3; ++c) {
        axes[1][c] -= cosine * axes[0][c];
        size = std::hypot(size, axes[1][c]);
      }
      for (unsigned int c = 0; c < 3; ++c)
        axes[1][c] /= size;
      for (unsigned int c = 0; c < 3; ++c)
        axes[2][c] = axes[0][(c + 1) % 3] * axes[1][(c + 2) % 3] -
                     axes[0][(c + 2) % 3] * axes[1][(c + 1) % 3];
      const EulerAngles angles = euler_angles(axes);
      for (unsigned int k = 0; k < 3; ++k)
        orientation.angles[k] = Expression(angles[k]);
    }

    /** The numbers of a line; what is no number is told. */
    std::string numbers_of_line(std::string line, std::vector<double> &numbers)
    {
      line.resize(std::min(line.size(), line.find('#')));
      for (char &c : line)
        if (c == ',' || c == ';')
          c = ' ';
      std::istringstream words(line);
      std::string word;
      while (words >> word) {
        char *end = nullptr;
        const double number = std::strtod(word.c_str(), &end);
        if (*end != '\0' || !std::isfinite(number))
          return fmt::format("`{}` is not a number", word);
        numbers.push_back(number);
      }
      return "";
    }

    void read_table(SectionReader &reader, OrientationInput &orientation)
    {
      const std::string name = entries[4];
      const std::string path = reader.file(
          name,
          "lines phi1 Phi phi2 in degrees, one per grain, or number phi1 "
          "Phi phi2; # begins a comment",
          "grains.ori");
      if (path.empty())
        return;
      orientation.source = path;
      const TextFile file = read_text_file(path, text_limits::table);
      const auto fail = [&](const unsigned int line, const std::string &what,
                            const std::string &advice) {
        reader.error(name,
                     line == 0
                         ? fmt::format("`{}` {}", path, what)
                         : fmt::format("`{}`: line {}: {}", path, line, what),
                     advice);
      };
      if (!file.problem.empty())
        return fail(file.line, file.problem, file.advice);
      std::istringstream lines(file.content);
      std::string line;
      std::size_t width = 0;
      for (unsigned int n = 1; std::getline(lines, line); ++n) {
        std::vector<double> numbers;
        const std::string problem = numbers_of_line(line, numbers);
        if (!problem.empty())
          return fail(n, problem,
                      "write phi1 Phi phi2 in degrees, separated by blanks");
        if (numbers.empty())
          continue;
        width = width == 0 ? numbers.size() : width;
        if (numbers.size() != width || width < 3 || width > 4)
          return fail(n, fmt::format("there are {} numbers", numbers.size()),
                      "write three angles in every line, or the number of the "
                      "grain and three angles in every line");
        unsigned int grain = unsigned(orientation.of_grain.size()) + 1;
        if (width == 4) {
          if (!(numbers[0] >= 0. && numbers[0] < 4e9 &&
                numbers[0] == std::floor(numbers[0])))
            return fail(
                n, fmt::format("{:g} is not the number of a grain", numbers[0]),
                "write a whole number first, then three angles");
          grain = unsigned(numbers[0]);
        }
        const auto *angles = numbers.data() + width - 3;
        if (!orientation.of_grain
                 .emplace(grain, EulerAngles{{angles[0], angles[1], angles[2]}})
                 .second)
          return fail(n, fmt::format("grain {} has a line already", grain),
                      "write one line per grain");
      }
      if (orientation.of_grain.empty())
        fail(0, "has no line of numbers",
             "write phi1 Phi phi2 in degrees, one line per grain");
    }

    void read_cell_data(SectionReader &reader, const MaterialSetting &setting,
                        OrientationInput &orientation)
    {
      const std::string name = entries[5];
      orientation.source = reader.word(
          name, "orientation",
          "name of the cell data of the mesh file: three values per cell, "
          "phi1, Phi, phi2 in degrees");
      static const GrainTable none;
      const auto &all =
          (setting.grains != nullptr ? *setting.grains : none).cell_data;
      const auto found = all.find(orientation.source);
      if (found != all.end()) {
        orientation.of_id = found->second;
        return;
      }
      std::vector<std::string> names;
      for (const auto &entry : all)
        names.push_back(entry.first);
      reader.error(
          reader.has(name) ? name : "orientation",
          names.empty()
              ? "the mesh has no data of cells with three values"
              : fmt::format("the mesh has no data of cells `{}` with three "
                            "values; it has {}",
                            orientation.source, fmt::join(names, ", ")),
          "Gmsh writes them as $ElementData of three components, VTK as an "
          "array of cells, Neper as $ElsetOrientations; three data of one "
          "value "
          "each go into formulas: Euler angles = phi1, Phi, phi2");
    }
  } // namespace

  OrientationInput read_orientation(SectionReader &reader,
                                    const MaterialSetting &setting)
  {
    using Kind = OrientationInput::Kind;
    OrientationInput orientation;
    const std::string word = reader.choice(
        "orientation", "Euler angles",
        {"Euler angles", "axes", "random", "random in plane", "table",
         "cell data"},
        "of the crystals: Euler angles, axes, random (per grain), random in "
        "plane, table (a file), cell data (of the mesh file)");
    if (setting.grains != nullptr)
      orientation.numbers = setting.grains->numbers;
    if (word == "axes") {
      refuse_all_but(reader, {entries[1], entries[2]}, word);
      read_axes(reader, orientation);
    } else if (word == "random" || word == "random in plane") {
      refuse_all_but(reader, {entries[3]}, word);
      orientation.kind = word == "random" ? Kind::random : Kind::in_plane;
      orientation.seed = reader.integer(
          entries[3], "1", 0, std::numeric_limits<unsigned int>::max(),
          "another one draws other orientations");
    } else if (word == "table") {
      refuse_all_but(reader, {entries[4]}, word);
      orientation.kind = Kind::table;
      read_table(reader, orientation);
    } else if (word == "cell data") {
      refuse_all_but(reader, {entries[5]}, word);
      orientation.kind = Kind::cell_data;
      read_cell_data(reader, setting, orientation);
    } else {
      refuse_all_but(reader, {entries[0]}, word);
      read_angles(reader, orientation);
    }
    return orientation;
  }
} // namespace nsfd::materials
