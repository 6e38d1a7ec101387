#include "read_law_path.h"

#include "drive_point.h"
#include "parameters/parameter_file.h"
#include "parameters/text_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace nsfd
{
  namespace
  {
    using Marks = std::vector<PathMark>;

    const NamedPath *find_path(const std::string &name)
    {
      for (const NamedPath &path : named_paths())
        if (path.name == name)
          return &path;
      return nullptr;
    }

    /** What one opening, slip and reaction of a path are worth. */
    PathMark unit_of(const CohesiveLaw &law, const double reaction)
    {
      return {opening_scale(law), slip_scale(law), reaction, 0.};
    }

    // ------------------------------------------------------------- named paths

    void read_named(SectionReader &reader, const NamedPath &path,
                    const unsigned int n_steps, LawInput &input)
    {
      double reaction = 0.;
      const std::string text = "Pa, of the contact; default the strength";
      if (!path.presses())
        reader.refuse({"reaction"},
                      fmt::format("the path `{}` never presses", path.name));
      else if (reader.optional("reaction", text))
        reaction = reader.number("reaction", "", units::pressure,
                                 Range::positive(), text);
      reader.refuse({"opening", "slip", "time"},
                    fmt::format("the path `{}` has its own; write type = "
                                "points for a list",
                                path.name));
      for (LawCurveInput &curve : input.curves)
        if (const auto &law = curve.interaction.law) {
          const PathMark unit =
              unit_of(*law, reaction > 0. ? reaction : law->strength());
          curve.points =
              points_between(scaled(path.marks, unit), unit, n_steps);
        }
    }

    // ------------------------------------------------------------------- lists

    /** Entry i of a list; a single value holds at every mark. */
    double value_at(const std::vector<double> &list, const std::size_t i)
    {
      return list.empty() ? 0. : list.size() == 1 ? list[0] : list[i];
    }

    Marks read_marks(SectionReader &reader)
    {
      const auto any = Range::any(), positive = Range::non_negative();
      const std::vector<double> opening = reader.number_list(
          "opening", units::length, positive, "u_N at the marks, m");
      const std::vector<double> slip =
          reader.number_list("slip", units::length, any, "u_T at the marks, m");
      const std::vector<double> reaction = reader.number_list(
          "reaction", units::pressure, positive,
          "contact traction at the marks, Pa; where it is 0 nothing presses");

      const std::vector<double> time = reader.number_list(
          "time", units::time, positive,
          "at the marks, s, in which what is pressed heals; default 0");

      const std::size_t n =
          std::max({opening.size(), slip.size(), reaction.size(), time.size()});
      if (n < 2)
        reader.error("type", "a path of points needs two marks or more",
                     "write for example: set opening = 0, 1 um, 0, 3 um");
      for (const auto &[name, list] :
           {std::make_pair("opening", &opening), std::make_pair("slip", &slip),
            std::make_pair("reaction", &reaction),
            std::make_pair("time", &time)})
        if (list->size() > 1 && list->size() != n)
          reader.error(
              name,
              fmt::format("`{}` has {} values, but the path has {} marks", name,
                          list->size(), n),
              "give every list as many values, or a single one");
      if (!std::is_sorted(time.begin(), time.end()))
        reader.error("time", "the times at the marks go back",
                     "write each as late as the one before or later");
      if (reader.errors().has_errors())
        return {};
      Marks marks;
      for (std::size_t i = 0; i < n; ++i)
        marks.push_back({value_at(opening, i), value_at(slip, i),
                         value_at(reaction, i), value_at(time, i)});
      return marks;
    }

    // -------------------------------------------------------------------- file

    const char *const file_advice =
        "write numbers in SI below a header such as: opening,slip,reaction";

    std::vector<std::string> fields_of(const std::string &line)
    {
      std::vector<std::string> fields;
      std::istringstream stream(line);
      for (std::string field; std::getline(stream, field, ',');)
        fields.push_back(collapse_blanks(field));
      return fields;
    }

    /** Where a column of a file goes; null if it is none of ours. */
    double *component(PathMark &mark, const std::string &name)
    {
      return name == "opening"    ? &mark.opening
             : name == "slip"     ? &mark.slip
             : name == "reaction" ? &mark.reaction
             : name == "time"     ? &mark.time
                                  : nullptr;
    }

    /** Rows of a CSV file with a header; throws what is wrong. */
    Marks read_table(std::istream &stream)
    {
      std::string line;
      std::getline(stream, line);
      const std::vector<std::string> header = fields_of(line);
      PathMark probe;
      for (const std::string &name : header)
        if (component(probe, name) == nullptr)
          throw std::runtime_error(fmt::format(
              "line 1: `{}` is not one of opening, slip, reaction, time",
              name));
      Marks marks;
      for (unsigned int number = 2; std::getline(stream, line); ++number) {
        if (collapse_blanks(line).empty())
          continue;
        const std::vector<std::string> fields = fields_of(line);
        if (fields.size() != header.size())
          throw std::runtime_error(
              fmt::format("line {}: {} values below a header of {}", number,
                          fields.size(), header.size()));
        marks.emplace_back();
        for (std::size_t i = 0; i < fields.size(); ++i) {
          char *end = nullptr;
          const double value = std::strtod(fields[i].c_str(), &end);
          if (fields[i].empty() || *end != '\0' || !std::isfinite(value))
            throw std::runtime_error(fmt::format(
                "line {}: `{}` is not a number", number, fields[i]));
          *component(marks.back(), header[i]) = value;
        }
      }
      if (marks.size() < 2)
        throw std::runtime_error("a path needs two rows or more");
      return marks;
    }

    Marks read_file(SectionReader &reader)
    {
      reader.refuse({"opening", "slip", "reaction", "time"},
                    "they are in the file");
      const std::string path = reader.file(
          "file",
          "CSV with the columns opening, slip, reaction, time (any of them), a "
          "mark per row; relative to the folder of the parameter file",
          "path.csv");
      if (path.empty())
        return {};
      const TextFile file = read_text_file(path, text_limits::table);
      if (!file.problem.empty()) {
        reader.error("file", fmt::format("`{}` {}", path, file.problem),
                     file_advice);
        return {};
      }
      try {
        std::istringstream stream(file.content);
        return read_table(stream);
      } catch (const std::runtime_error &error) {
        reader.error("file", fmt::format("{}: {}", path, error.what()),
                     file_advice);
        return {};
      }
    }

    // ---------------------------------------------------------------- formulas

    std::vector<PathPoint> read_formulas(SectionReader &reader,
                                         const unsigned int n_steps)
    {
      const Expression opening = reader.expression(
          "opening", "0", units::length, "u_N in m, of t from 0 to 1");
      const Expression slip = reader.expression("slip", "0", units::length,
                                                "u_T in m, of t from 0 to 1");
      const Expression reaction =
          reader.expression("reaction", "0", units::pressure,
                            "contact traction in Pa, of t from 0 to 1");
      std::vector<PathPoint> points;
      const unsigned int n = std::max(n_steps, 1u);
      for (unsigned int i = 0; i <= n; ++i) {
        const double t = double(i) / n;
        points.push_back({t,
                          {opening(0., 0., 0., t), slip(0., 0., 0., t),
                           reaction(0., 0., 0., t), 0.}});
      }
      reader.refuse({"time"}, "formulas are of t from 0 to 1");
      if (points[0].at.opening != 0. || points[0].at.slip != 0.)
        points.insert(points.begin(), PathPoint());
      return points;
    }

    // ----------------------------------------------------------- all of them

    /** Points, formulas or a file: the same path for all curves. */
    void read_own(SectionReader &reader, const unsigned int n_steps,
                  LawInput &input)
    {
      const bool is_formula = input.path_name == "formula",
                 is_file = input.path_name == "file";
      std::vector<PathPoint> points;
      Marks marks;
      if (is_formula)
        points = read_formulas(reader, n_steps);
      else
        marks = is_file ? read_file(reader) : read_marks(reader);
      if (points.empty() && marks.empty())
        return;
      for (LawCurveInput &curve : input.curves) {
        const auto &law = curve.interaction.law;
        if (!law)
          continue;
        curve.points =
            is_formula ? points
                       : points_between(marks, unit_of(*law, law->strength()),
                                        n_steps);
        const std::string problem = contradiction(curve.points);
        if (problem.empty())
          continue;
        reader.error(is_file ? "file" : "type", problem,
                     "let the point close before it is pressed");
        return;
      }
    }

    CohesionRule read_rule(SectionReader &reader)
    {
      const std::string name = reader.choice(
          "cohesion rule", "end point", {"end point", "end velocity", "exact"},
          "end point (tractions on the envelope), end velocity or exact "
          "(means over the steps, no energy is lost)");
      return name == "exact"          ? CohesionRule::exact
             : name == "end velocity" ? CohesionRule::end_velocity
                                      : CohesionRule::end_point;
    }
  } // namespace

  void read_law_path(SectionReader &reader, LawInput &input)
  {
    std::vector<std::string> types;
    for (const NamedPath &path : named_paths())
      types.push_back(path.name);
    for (const char *type : {"points", "formula", "file"})
      types.emplace_back(type);
    input.path_name = reader.choice("type", types.front(), types,
                                    fmt::format("{}", fmt::join(types, ", ")));
    const unsigned int n_steps =
        reader.integer("steps", "400", 0, 1000000,
                       "of the whole path; 0: from mark to mark in one step");
    input.cohesion_rule = read_rule(reader);
    input.normalised =
        reader.boolean("normalised", false,
                       "pictures over final opening and strength of the law");
    if (input.path_name != "file")
      reader.refuse({"file"}, "only type = file reads one");

    if (const NamedPath *path = find_path(input.path_name))
      read_named(reader, *path, n_steps, input);
    else
      read_own(reader, n_steps, input);
    for (LawCurveInput &curve : input.curves)
      if (n_steps > 0 && !curve.points.empty())
        curve.points = with_kinks(curve.points, *curve.interaction.law);
  }
} // namespace nsfd
