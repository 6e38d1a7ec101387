#include "variation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>

namespace nsfd
{
  namespace
  {
    std::string trimmed(const std::string &text)
    {
      const std::size_t begin = text.find_first_not_of(" \t");
      if (begin == std::string::npos)
        return "";
      return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
    }

    /** Parts between the separators outside of brackets; `&&` is none. */
    std::vector<std::string> split(const std::string &text,
                                   const char separator)
    {
      std::vector<std::string> parts(1);
      int depth = 0;
      for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        depth += (c == '[' || c == '(' || c == '{');
        depth -= (c == ']' || c == ')' || c == '}');
        const bool doubled =
            c == '&' && ((i > 0 && text[i - 1] == '&') ||
                         (i + 1 < text.size() && text[i + 1] == '&'));
        if (c == separator && depth == 0 && !doubled)
          parts.emplace_back();
        else
          parts.back() += c;
      }
      for (std::string &part : parts)
        part = trimmed(part);
      return parts;
    }

    /** Takes off brackets around all of it. */
    std::string unwrapped(const std::string &text)
    {
      if (text.size() < 2 || text.front() != '[' || text.back() != ']')
        return text;
      int depth = 0;
      for (std::size_t i = 0; i + 1 < text.size(); ++i) {
        depth += text[i] == '[';
        depth -= text[i] == ']';
        if (depth == 0)
          return text;
      }
      return trimmed(text.substr(1, text.size() - 2));
    }

    /** A range in a value, and what stands for it, one by one. */
    struct RangeInText {
      std::size_t begin = 0, length = 0;
      std::vector<std::string> values;
    };

    std::vector<int> integers(const int first, const int last, const int by)
    {
      std::vector<int> result;
      const int step = std::max(1, std::abs(by));
      if (std::abs(double(last) - first) / step > 1e4)
        return result;
      // the one after the last may be too large for an int
      for (long long i = first; first <= last ? i <= last : i >= last;
           i += first <= last ? step : -step)
        result.push_back(int(i));
      return result;
    }

    std::string printed(const double value)
    {
      return fmt::format("{:.15g}", value);
    }

    /** First range at or after @p from; false if there is none. */
    bool find_range(const std::string &text, const std::size_t from,
                    RangeInText &range)
    {
      static const std::regex pattern(
          "(?:([0-9.]+(?:[eE][-+]?[0-9]+)?)[ ]*([*/])[ ]*([0-9.]+)[ ]*\\^[ ]*)?"
          "(-?[0-9]+)\\.\\.(-?[0-9]+)(?:[ ]+by[ ]+([0-9]+))?");
      std::smatch match;
      const std::string rest = text.substr(from);
      if (!std::regex_search(rest, match, pattern))
        return false;
      range.begin = from + std::size_t(match.position(0));
      range.length = std::size_t(match.length(0));
      range.values.clear();
      const int by = match[6].matched ? std::atoi(match[6].str().c_str()) : 1;
      for (const int i : integers(std::atoi(match[4].str().c_str()),
                                  std::atoi(match[5].str().c_str()), by)) {
        if (!match[1].matched) {
          range.values.push_back(std::to_string(i));
          continue;
        }
        const double factor = std::strtod(match[1].str().c_str(), nullptr);
        const double power =
            std::pow(std::strtod(match[3].str().c_str(), nullptr), i);
        range.values.push_back(
            printed(match[2] == "*" ? factor * power : factor / power));
      }
      return true;
    }

    bool is_part_of_number(const std::string &text, const std::size_t at)
    {
      const char c = at < text.size() ? text[at] : ' ';
      return (c >= '0' && c <= '9') || c == '.';
    }

    std::vector<std::string> expand_ranges(const std::string &text,
                                           std::string &problem)
    {
      // regular expressions recurse for every character
      constexpr std::size_t longest = 2000;
      if (text.size() > longest) {
        problem = fmt::format("this value has {} bytes, more than {}",
                              text.size(), longest);
        return {text.substr(0, 40)};
      }
      std::vector<RangeInText> ranges;
      RangeInText range;
      for (std::size_t at = 0; find_range(text, at, range);
           at = range.begin + range.length) {
        const bool cut =
            (range.begin > 0 && is_part_of_number(text, range.begin - 1)) ||
            is_part_of_number(text, range.begin + range.length);
        if (cut || range.values.empty())
          problem = fmt::format("`{}` is not a range of integers; write for "
                                "example 1..4, 10*2^0..3, or every value",
                                text);
        ranges.push_back(range);
      }
      const std::size_t n = ranges.empty() ? 1 : ranges[0].values.size();
      for (const auto &other : ranges)
        if (other.values.size() != n)
          problem = fmt::format("the ranges in `{}` have {} and {} values",
                                text, n, other.values.size());
      if (!problem.empty() || ranges.empty())
        return {text};
      std::vector<std::string> values;
      for (std::size_t i = 0; i < n; ++i) {
        std::string value;
        std::size_t at = 0;
        for (const auto &part : ranges) {
          value += text.substr(at, part.begin - at) + part.values[i];
          at = part.begin + part.length;
        }
        values.push_back(value + text.substr(at));
      }
      return values;
    }

    /** What is safe in the name of a folder, and in a shell. */
    std::string safe(const std::string &text)
    {
      std::string result;
      for (const char c : text)
        if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
            (c >= 'A' && c <= 'Z') || c == '.' || c == '+' || c == '-')
          result += c;
        else if (!result.empty() && result.back() != '-')
          result += '-';
      while (!result.empty() && result.back() == '-')
        result.pop_back();
      return result;
    }

    constexpr std::size_t longest_name = 100;
  } // namespace

  std::size_t Variation::size() const
  {
    std::size_t n = 0;
    for (const Parameter &parameter : parameters)
      n = std::max(n, parameter.values.size());
    return n;
  }

  const Variation::Parameter &Variation::leader() const
  {
    for (const Parameter &parameter : parameters)
      if (parameter.values.size() > 1)
        return parameter;
    return parameters.front();
  }

  const std::string &Variation::value(const Parameter &parameter,
                                      const std::size_t i)
  {
    return parameter.values[std::min(i, parameter.values.size() - 1)];
  }

  std::string short_name(const std::string &path)
  {
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? path : path.substr(slash + 1);
  }

  std::vector<std::string> expand_values(const std::string &text,
                                         std::string &problem)
  {
    problem.clear();
    const auto by_semicolon = split(text, ';');
    std::vector<std::string> values;
    for (const std::string &part :
         by_semicolon.size() > 1 ? by_semicolon : split(text, ',')) {
      const std::string value = unwrapped(part);
      if (value.empty()) {
        problem = fmt::format("a value is empty in `{}`", text);
        return {};
      }
      for (const std::string &one : expand_ranges(value, problem))
        values.push_back(one);
      constexpr std::size_t most_values = 10000;
      if (values.size() > most_values) {
        problem = fmt::format("these are more than {} values", most_values);
        return {};
      }
    }
    return values;
  }

  std::optional<Variation> parse_variation(const std::string &text,
                                           std::string &problem)
  {
    Variation variation;
    for (const std::string &part : split(text, '&')) {
      const std::size_t equals = part.find('=');
      const std::string path = trimmed(part.substr(0, equals));
      if (equals == std::string::npos || path.empty()) {
        problem = fmt::format("`{}` assigns nothing", part);
        return {};
      }
      variation.parameters.push_back(
          {path, expand_values(part.substr(equals + 1), problem)});
      if (!problem.empty())
        return {};
    }
    problem = problem_of(variation);
    if (!problem.empty())
      return {};
    variation.name = short_name(variation.leader().path);
    return variation;
  }

  std::string problem_of(const Variation &variation)
  {
    if (variation.parameters.empty())
      return "nothing varies";
    const std::size_t n = variation.size();
    const auto &leader = variation.leader();
    for (const auto &parameter : variation.parameters)
      if (parameter.values.size() != 1 &&
          parameter.values.size() != leader.values.size())
        return fmt::format("{} has {} values and {} has {}: what varies "
                           "together needs equally many (or one)",
                           leader.path, leader.values.size(), parameter.path,
                           parameter.values.size());
    std::set<std::string> seen;
    for (std::size_t i = 0; i < n; ++i) {
      std::string all;
      for (const auto &parameter : variation.parameters)
        all += Variation::value(parameter, i) + "\n";
      if (!seen.insert(all).second)
        return fmt::format("the value `{}` of {} stands twice",
                           Variation::value(leader, i), leader.path);
    }
    return "";
  }

  std::vector<Combination> combine(const std::vector<Variation> &variations)
  {
    std::vector<Combination> result;
    std::set<std::string> names;
    std::vector<std::size_t> index(variations.size(), 0);
    while (true) {
      Combination one;
      one.index = index;
      for (std::size_t v = 0; v < variations.size(); ++v) {
        for (const auto &parameter : variations[v].parameters)
          one.parameters.emplace_back(parameter.path,
                                      Variation::value(parameter, index[v]));
        if (variations[v].is_constant())
          continue;
        const auto &leader = variations[v].leader();
        one.name += (one.name.empty() ? "" : "_") +
                    safe(short_name(leader.path)) + "=" +
                    safe(Variation::value(leader, index[v]));
      }
      if (one.name.empty())
        one.name = "case";
      one.name.resize(std::min(one.name.size(), longest_name));
      const std::string stem = one.name;
      for (unsigned int k = 2; !names.insert(one.name).second; ++k)
        one.name = fmt::format("{}_{}", stem, k);
      result.push_back(std::move(one));

      std::size_t v = variations.size();
      while (v > 0 && ++index[v - 1] == variations[v - 1].size())
        index[--v] = 0;
      if (v == 0)
        return result;
    }
  }
} // namespace nsfd
