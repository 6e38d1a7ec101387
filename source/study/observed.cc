#include "observed.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace nsfd
{
  namespace
  {
    using Kind = ObservedQuantity::Kind;

    std::string without_blanks(const std::string &text)
    {
      const std::size_t begin = text.find_first_not_of(" \t\n");
      if (begin == std::string::npos)
        return "";
      return text.substr(begin, text.find_last_not_of(" \t\n") + 1 - begin);
    }

    /** The words between two separators. */
    std::vector<std::string> parts_of(const std::string &text,
                                      const char separator)
    {
      std::vector<std::string> parts;
      std::istringstream stream(text);
      for (std::string part; std::getline(stream, part, separator);)
        parts.push_back(part);
      return parts;
    }

    /** The finite values of a column; empty if there is none. */
    std::vector<double> finite_column(const std::string &file,
                                      const std::string &name)
    {
      std::ifstream stream(file);
      std::string line;
      if (!std::getline(stream, line))
        return {};
      const std::vector<std::string> head = parts_of(line, ',');
      const auto found = std::find(head.begin(), head.end(), name);
      const std::size_t place = std::size_t(found - head.begin());
      std::vector<double> values;
      while (found != head.end() && std::getline(stream, line)) {
        const std::vector<std::string> row = parts_of(line, ',');
        if (place >= row.size())
          continue;
        const double value = std::strtod(row[place].c_str(), nullptr);
        if (std::isfinite(value))
          values.push_back(value);
      }
      return values;
    }

    /** A number of summary.json, or nothing. */
    void observe_summary(const ObservedQuantity &quantity,
                         const nlohmann::json &summary,
                         std::map<std::string, double> &values)
    {
      const nlohmann::json *at = &summary;
      for (const std::string &key : parts_of(quantity.column, '/')) {
        if (!at->is_object() || !at->contains(key))
          return;
        at = &at->at(key);
      }
      if (at->is_number())
        values[quantity.name] = at->get<double>();
    }

    ObservedQuantity read_quantity(const std::string &text,
                                   std::string &problem)
    {
      ObservedQuantity quantity;
      quantity.name = text;
      std::replace(quantity.name.begin(), quantity.name.end(), ' ', '_');
      const std::size_t blank = text.find(' ');
      if (blank == std::string::npos) {
        quantity.column = text;
        return quantity;
      }
      const std::string how = text.substr(0, blank);
      if (how == "max")
        quantity.kind = Kind::largest;
      else if (how == "min")
        quantity.kind = Kind::smallest;
      else if (how == "final")
        quantity.kind = Kind::last;
      else if (how == "range")
        quantity.kind = Kind::span;
      else
        problem = fmt::format("`{}` is no quantity: before a column stand max, "
                              "min, range or final",
                              text);
      quantity.column = without_blanks(text.substr(blank));
      const std::size_t slash = quantity.column.rfind('/');
      quantity.table =
          slash == std::string::npos
              ? "history.csv"
              : "observables/" + quantity.column.substr(0, slash) + ".csv";
      if (slash != std::string::npos)
        quantity.column = quantity.column.substr(slash + 1);
      return quantity;
    }
  } // namespace

  std::vector<ObservedQuantity> parse_observed(const std::string &text,
                                               std::string &problem)
  {
    std::vector<ObservedQuantity> quantities;
    for (const std::string &part : parts_of(text, ','))
      if (const std::string one = without_blanks(part); !one.empty())
        quantities.push_back(read_quantity(one, problem));
    if (quantities.empty() && problem.empty())
      problem = "no quantity is named";
    return quantities;
  }

  void observe(const std::vector<ObservedQuantity> &quantities,
               const std::string &folder, std::map<std::string, double> &values)
  {
    nlohmann::json summary;
    for (const ObservedQuantity &quantity : quantities) {
      if (quantity.kind == Kind::summary) {
        if (summary.is_null()) {
          std::ifstream stream(folder + "/summary.json");
          summary = nlohmann::json::parse(stream, nullptr, false);
        }
        observe_summary(quantity, summary, values);
        continue;
      }
      const std::vector<double> all =
          finite_column(folder + "/" + quantity.table, quantity.column);
      if (all.empty())
        continue;
      const auto [low, high] = std::minmax_element(all.begin(), all.end());
      values[quantity.name] = quantity.kind == Kind::largest    ? *high
                              : quantity.kind == Kind::smallest ? *low
                              : quantity.kind == Kind::last     ? all.back()
                                                                : *high - *low;
    }
  }
} // namespace nsfd
