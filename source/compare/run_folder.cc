#include "run_folder.h"

#include "postprocess/row_file.h"

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;
    using Json = nlohmann::ordered_json;

    /** Empty if there is no such file. */
    std::optional<std::string> text_of(const fs::path &file)
    {
      std::ifstream stream(file, std::ios::binary);
      if (!stream || fs::is_directory(file))
        return {};
      std::ostringstream text;
      text << stream.rdbuf();
      return text.str();
    }

    void add_numbers(const Json &object, const std::string &path,
                     RunFolder &run)
    {
      for (const auto &[name, value] : object.items())
        if (value.is_object())
          add_numbers(value, path + name + '/', run);
        else if (value.is_number())
          run.numbers.emplace_back(path + name, value.get<double>());
        else if (value.is_null() && name != "failure")
          run.numbers.emplace_back(path + name,
                                   std::numeric_limits<double>::quiet_NaN());
    }

    void read_summary(const fs::path &file, RunFolder &run)
    {
      const auto text = text_of(file);
      if (!text)
        throw std::runtime_error(fmt::format("there is no {}", file.string()));
      const Json json = Json::parse(*text, nullptr, false);
      if (!json.is_object() || !json.contains("completed") ||
          !json["completed"].is_boolean())
        throw std::runtime_error(
            fmt::format("{} is not the summary of a run", file.string()));
      run.completed = json["completed"].get<bool>();
      if (json.contains("failure") && json["failure"].is_string())
        run.failure = json["failure"].get<std::string>();
      add_numbers(json, "", run);
      run.dimension = unsigned(run.number("dimension").value_or(2.));
      run.axisymmetric = json.value("axisymmetric", Json(false)) == Json(true);
      const Json judged = json.value("certificate", Json::object());
      const Json lines = judged.value("lines", Json::object());
      for (const auto &[name, line] : lines.items())
        if (line.is_object() && line.contains("verdict") &&
            line["verdict"].is_string())
          run.certificate.emplace_back(name,
                                       line["verdict"].get<std::string>());
    }

    /** Names between commas; quotes around a name are taken off. */
    std::vector<std::string> names_of(const std::string &header)
    {
      std::vector<std::string> names(1);
      bool quoted = false;
      for (std::size_t k = 0; k < header.size(); ++k)
        if (header[k] == '"' && quoted && k + 1 < header.size() &&
            header[k + 1] == '"')
          names.back() += header[++k];
        else if (header[k] == '"')
          quoted = !quoted;
        else if (header[k] == ',' && !quoted)
          names.emplace_back();
        else if (header[k] != '\r')
          names.back() += header[k];
      return names;
    }

    using Columns = std::vector<std::pair<std::string, std::vector<double>>>;

    Columns table_of(const std::string &text, const fs::path &file)
    {
      std::istringstream lines(text);
      std::string line;
      std::getline(lines, line);
      Columns columns;
      for (const std::string &name : names_of(line))
        columns.emplace_back(name, std::vector<double>());
      for (std::size_t row = 2; std::getline(lines, line); ++row) {
        const auto numbers = numbers_of(line, columns.size());
        if (numbers.empty())
          throw std::runtime_error(fmt::format("{}, line {}: not {} numbers",
                                               file.string(), row,
                                               columns.size()));
        for (std::size_t c = 0; c < columns.size(); ++c)
          columns[c].second.push_back(numbers[c]);
      }
      return columns;
    }

    const std::vector<double> *find(const Columns &columns,
                                    const std::string &name)
    {
      for (const auto &[other, values] : columns)
        if (other == name)
          return &values;
      return nullptr;
    }

    void read_fragments(const fs::path &file, RunFolder &run)
    {
      const auto text = text_of(file);
      if (!text)
        return;
      const Columns columns = table_of(*text, file);
      const auto *time = find(columns, "time"), *size = find(columns, "size");
      if (!time || !size)
        throw std::runtime_error(
            fmt::format("{} has no columns time and size", file.string()));
      for (std::size_t k = 0; k < time->size(); ++k)
        if ((*time)[k] == time->back())
          run.fragment_sizes.push_back((*size)[k]);
      std::sort(run.fragment_sizes.begin(), run.fragment_sizes.end(),
                std::greater<>());
    }
  } // namespace

  std::optional<double> RunFolder::number(const std::string &path) const
  {
    for (const auto &[name, value] : numbers)
      if (name == path)
        return value;
    return {};
  }

  const std::vector<double> *RunFolder::column(const std::string &name) const
  {
    return find(history, name);
  }

  double RunFolder::largest_energy() const
  {
    double largest = 0.;
    const auto see = [&largest](const double value) {
      if (std::isfinite(value))
        largest = std::max(largest, std::abs(value));
    };
    for (const auto &[name, value] : numbers)
      if (name == "work" || name.compare(0, 7, "energy/") == 0 ||
          name.compare(0, 11, "dissipated/") == 0)
        see(value);
    for (const char *name :
         {"kinetic", "elastic", "cohesive", "damage", "friction", "viscous",
          "plastic", "impact", "numerical", "absorbed", "work"})
      if (const auto *values = column(name))
        std::for_each(values->begin(), values->end(), see);
    return largest;
  }

  RunFolder read_run(const std::string &path)
  {
    RunFolder run;
    run.name = path;
    const bool is_folder = fs::is_directory(path);
    if (!is_folder && !fs::exists(path))
      throw std::runtime_error(
          fmt::format("there is no folder or file {}", path));
    const fs::path folder =
        is_folder ? fs::path(path) : fs::path(path).parent_path();
    read_summary(is_folder ? folder / "summary.json" : fs::path(path), run);
    const auto history = text_of(folder / "history.csv");
    if (history)
      run.history = table_of(*history, folder / "history.csv");
    run.parameters = text_of(folder / "parameters.prm");
    for (const auto &[there, name] :
         {std::pair(history.has_value(), "history.csv"),
          std::pair(run.parameters.has_value(), "parameters.prm")})
      if (is_folder && !there)
        throw std::runtime_error(fmt::format(
            "there is no {}; name {} to "
            "compare the summaries alone",
            (folder / name).string(), (folder / "summary.json").string()));
    read_fragments(folder / "fragments.csv", run);
    return run;
  }
} // namespace nsfd
