#include "abaqus_words.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <sstream>

namespace nsfd::abaqus
{
  std::string trimmed(const std::string &text)
  {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos)
      return "";
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
  }

  std::string upper(std::string text)
  {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](const unsigned char c) { return std::toupper(c); });
    return text;
  }

  std::string unquoted(const std::string &text)
  {
    const bool is_quoted =
        text.size() > 1 && text.front() == '"' && text.back() == '"';
    return is_quoted ? text.substr(1, text.size() - 2) : text;
  }

  std::vector<std::string> fields(const std::string &line)
  {
    std::vector<std::string> result;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, ',');)
      result.push_back(trimmed(field));
    // a line that is a comma alone
    if (result.empty())
      result.emplace_back();
    return result;
  }

  std::optional<long> integer(const std::string &text)
  {
    long value = 0;
    const char *const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc() && stop == end)
      return value;
    return {};
  }

  std::optional<double> real(std::string text)
  {
    if (text.empty())
      return 0.;
    std::replace_if(
        text.begin(), text.end(),
        [](const char c) { return c == 'd' || c == 'D'; }, 'e');
    const char *const begin = text.data() + (text[0] == '+' ? 1 : 0);
    const char *const end = text.data() + text.size();
    double value = 0.;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error == std::errc() && stop == end)
      return value;
    return {};
  }

  bool Keyword::take(const std::string &line)
  {
    std::vector<std::string> words = fields(line);
    if (!goes_on_) {
      std::istringstream in(upper(words[0]));
      name_.clear();
      for (std::string word; in >> word;)
        name_ += (name_.empty() ? "" : " ") + word;
      parameters_.clear();
      words.erase(words.begin());
    }
    for (const std::string &word : words) {
      const std::size_t equals = word.find('=');
      parameters_[upper(trimmed(word.substr(0, equals)))] =
          equals == std::string::npos
              ? ""
              : unquoted(trimmed(word.substr(equals + 1)));
    }
    goes_on_ = line.back() == ',';
    return !goes_on_;
  }

  std::string Keyword::get(const std::string &parameter) const
  {
    const auto found = parameters_.find(parameter);
    return found == parameters_.end() ? "" : found->second;
  }
} // namespace nsfd::abaqus
