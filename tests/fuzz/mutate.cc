#include "mutate.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <functional>
#include <sstream>

namespace nsfd::fuzz
{
  namespace
  {
    using Lines = std::vector<std::string>;

    Lines split(const std::string &text)
    {
      Lines lines;
      std::istringstream stream(text);
      for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
      return lines;
    }

    std::string join(const Lines &lines)
    {
      std::string text;
      for (const std::string &line : lines)
        text += line + "\n";
      return text;
    }

    template <typename T>
    const T &any_of(const std::vector<T> &list, Random &random)
    {
      return list[below(random, list.size())];
    }

    /** Lines `set NAME = VALUE`. */
    std::vector<std::size_t> entries(const Lines &lines)
    {
      std::vector<std::size_t> result;
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::size_t first = lines[i].find_first_not_of(" \t");
        if (first != std::string::npos &&
            lines[i].compare(first, 4, "set ") == 0 &&
            lines[i].find('=') != std::string::npos)
          result.push_back(i);
      }
      return result;
    }

    std::string left_side(const std::string &line)
    {
      return line.substr(0, line.find('=') + 1) + " ";
    }

    std::string right_side(const std::string &line)
    {
      return line.substr(line.find('=') + 1);
    }

    /** Begin and end of the numbers in a text. */
    std::vector<std::pair<std::size_t, std::size_t>>
    numbers(const std::string &text)
    {
      std::vector<std::pair<std::size_t, std::size_t>> result;
      for (std::size_t i = 0; i < text.size();) {
        if (!std::isdigit(static_cast<unsigned char>(text[i]))) {
          ++i;
          continue;
        }
        const std::size_t begin = i;
        while (i < text.size() &&
               (std::isdigit(static_cast<unsigned char>(text[i])) ||
                text[i] == '.' || text[i] == 'e'))
          ++i;
        result.push_back({begin, i});
      }
      return result;
    }

    std::string repeated(const std::string &word, const std::size_t count)
    {
      std::string result;
      for (std::size_t i = 0; i < count; ++i)
        result += word;
      return result;
    }

    std::string odd_formula(Random &random)
    {
      static const std::vector<std::string> formulas = {"1 / x",
                                                        "sqrt(-1 - x^2)",
                                                        "1 / (t - t)",
                                                        "x / 0",
                                                        "ln(0)",
                                                        "exp(1e6)",
                                                        "tan(pi / 2) ^ 100",
                                                        "if(x > 0, 1 / 0, 0)",
                                                        "random()",
                                                        "pow(x)",
                                                        "1 m + 1 s",
                                                        "2 ^ 3 ^ 4 ^ 5 ^ 6",
                                                        "(((x)",
                                                        "x > 1 > 2",
                                                        "1 1/",
                                                        "-",
                                                        "x y",
                                                        "1e",
                                                        "5 kg/m^99",
                                                        "min()",
                                                        "a ? b",
                                                        "%s%n"};
      switch (below(random, 6)) {
      case 0:
        return "1" + repeated(" + 1", 300000);
      case 1:
        return repeated("(", 5000) + "1" + repeated(")", 5000);
      case 2:
        return "2" + repeated("^2", 3000);
      case 3:
        return repeated("1 > 0 ? ", 1000) + "1" + repeated(" : 0", 1000);
      default:
        return any_of(formulas, random);
      }
    }

    std::string long_word(Random &random)
    {
      static const std::vector<std::size_t> lengths = {300, 5000, 1000000};
      return std::string(any_of(lengths, random), 'a');
    }

    struct TextMutation {
      const char *name;
      /// false if there is nothing to mutate
      std::function<bool(Lines &, const Lines &, Random &)> change;
    };

    bool change_entry(Lines &lines, Random &random,
                      const std::function<std::string(std::string)> &value)
    {
      const auto places = entries(lines);
      if (places.empty())
        return false;
      std::string &line = lines[any_of(places, random)];
      line = left_side(line) + value(right_side(line));
      return true;
    }

    bool change_byte(Lines &lines, Random &random, const std::string &instead)
    {
      std::string &line = lines[below(random, lines.size())];
      if (line.empty())
        return false;
      line.replace(below(random, line.size()), 1, instead);
      return true;
    }

    const std::vector<TextMutation> &text_mutations()
    {
      static const std::vector<TextMutation> mutations = {
          {"byte",
           [](Lines &lines, const Lines &, Random &random) {
             return change_byte(lines, random,
                                std::string(1, char(below(random, 256))));
           }},
          {"no UTF-8",
           [](Lines &lines, const Lines &, Random &random) {
             static const std::vector<std::string> bytes = {
                 "\xff", "\xc3", "\xed\xa0\x80", std::string(1, '\0'),
                 "\xf8\x88\x80\x80\x80"};
             return change_byte(lines, random, any_of(bytes, random));
           }},
          {"line deleted",
           [](Lines &lines, const Lines &, Random &random) {
             lines.erase(lines.begin() +
                         std::ptrdiff_t(below(random, lines.size())));
             return true;
           }},
          {"line doubled",
           [](Lines &lines, const Lines &, Random &random) {
             const std::size_t i = below(random, lines.size());
             lines.insert(lines.begin() + std::ptrdiff_t(i), lines[i]);
             return true;
           }},
          {"lines swapped",
           [](Lines &lines, const Lines &, Random &random) {
             std::swap(lines[below(random, lines.size())],
                       lines[below(random, lines.size())]);
             return true;
           }},
          {"values swapped",
           [](Lines &lines, const Lines &, Random &random) {
             const auto places = entries(lines);
             if (places.empty())
               return false;
             std::string &a = lines[any_of(places, random)];
             std::string &b = lines[any_of(places, random)];
             const std::string of_a = right_side(a), of_b = right_side(b);
             a = left_side(a) + of_b;
             b = left_side(b) + of_a;
             return true;
           }},
          {"entry empty",
           [](Lines &lines, const Lines &, Random &random) {
             return change_entry(lines, random,
                                 [](const std::string &) { return ""; });
           }},
          {"extreme number",
           [](Lines &lines, const Lines &, Random &random) {
             std::string &line = lines[below(random, lines.size())];
             const auto places = numbers(line);
             if (places.empty())
               return false;
             const auto [begin, end] = any_of(places, random);
             line.replace(begin, end - begin, extreme_value(random));
             return true;
           }},
          {"extreme value",
           [](Lines &lines, const Lines &, Random &random) {
             return change_entry(lines, random, [&](const std::string &) {
               return extreme_value(random);
             });
           }},
          {"formula",
           [](Lines &lines, const Lines &, Random &random) {
             return change_entry(lines, random, [&](const std::string &) {
               return odd_formula(random);
             });
           }},
          {"long word",
           [](Lines &lines, const Lines &, Random &random) {
             std::string &line = lines[below(random, lines.size())];
             line.insert(below(random, line.size() + 1), long_word(random));
             return true;
           }},
          {"nesting",
           [](Lines &lines, const Lines &, Random &random) {
             const std::size_t at = below(random, lines.size());
             static const std::vector<std::size_t> depths = {1, 2, 100000};
             const Lines inner(any_of(depths, random), "subsection A");
             lines.insert(lines.begin() + std::ptrdiff_t(at), inner.begin(),
                          inner.end());
             return true;
           }},
          {"many lines",
           [](Lines &lines, const Lines &, Random &random) {
             const std::size_t at = below(random, lines.size());
             Lines many;
             for (std::size_t i = 0; i < 50000; ++i)
               many.push_back("set a" + std::to_string(i) + " = b" +
                              std::to_string(i));
             lines.insert(lines.begin() + std::ptrdiff_t(at), many.begin(),
                          many.end());
             return true;
           }},
          {"cut",
           [](Lines &lines, const Lines &, Random &random) {
             lines.resize(1 + below(random, lines.size()));
             lines.back().resize(below(random, lines.back().size() + 1));
             return true;
           }},
          {"line of another",
           [](Lines &lines, const Lines &other, Random &random) {
             if (other.empty())
               return false;
             lines.insert(lines.begin() +
                              std::ptrdiff_t(below(random, lines.size())),
                          any_of(other, random));
             return true;
           }},
          {"value of another",
           [](Lines &lines, const Lines &other, Random &random) {
             const auto places = entries(other);
             if (places.empty())
               return false;
             const std::string value =
                 right_side(other[any_of(places, random)]);
             return change_entry(lines, random,
                                 [&](const std::string &) { return value; });
           }},
          {"section deleted",
           [](Lines &lines, const Lines &, Random &random) {
             std::vector<std::size_t> begins;
             for (std::size_t i = 0; i < lines.size(); ++i)
               if (lines[i].compare(0, 11, "subsection ") == 0)
                 begins.push_back(i);
             if (begins.empty())
               return false;
             const std::size_t begin = any_of(begins, random);
             std::size_t end = begin;
             while (end < lines.size() && lines[end].compare(0, 3, "end") != 0)
               ++end;
             lines.erase(lines.begin() + std::ptrdiff_t(begin),
                         lines.begin() +
                             std::ptrdiff_t(std::min(end + 1, lines.size())));
             return true;
           }},
      };
      return mutations;
    }
  } // namespace

  std::size_t below(Random &random, const std::size_t n)
  {
    return n == 0 ? 0 : std::size_t(random() % n);
  }

  std::string extreme_value(Random &random)
  {
    static const std::vector<std::string> values = {"0",
                                                    "-1",
                                                    "1e300",
                                                    "1e-300",
                                                    "1e400",
                                                    "-1e400",
                                                    "0x10",
                                                    "nan",
                                                    "inf",
                                                    "1e17",
                                                    "1e3",
                                                    "0.5",
                                                    "4294967296",
                                                    "-2147483649",
                                                    "18446744073709551616",
                                                    "5000",
                                                    "20",
                                                    "1e-30",
                                                    "1e30",
                                                    "1,1,1,1,1,1",
                                                    ",",
                                                    "1e9",
                                                    "2",
                                                    "3",
                                                    "1000000",
                                                    "-0",
                                                    "1e-30 m",
                                                    "1e300 Pa",
                                                    "1e-300 kg/m^3",
                                                    "true",
                                                    "all",
                                                    "/dev/zero",
                                                    "/",
                                                    "..",
                                                    "/dev/stdin",
                                                    "auto",
                                                    "none",
                                                    "1 courant",
                                                    "1e17 s",
                                                    "1 furlong"};
    return any_of(values, random);
  }

  Mutant mutate_text(const std::string &text,
                     const std::vector<std::string> &others, Random &random)
  {
    Lines lines = split(text);
    const Lines other =
        others.empty() ? Lines() : split(any_of(others, random));
    Mutant mutant;
    for (std::size_t n = 1 + below(random, 3); n > 0; --n) {
      const TextMutation &mutation = any_of(text_mutations(), random);
      if (!lines.empty() && mutation.change(lines, other, random))
        mutant.done +=
            (mutant.done.empty() ? "" : ", ") + std::string(mutation.name);
    }
    mutant.content = join(lines);
    return mutant;
  }

  Mutant mutate_bytes(const std::string &bytes, Random &random)
  {
    Mutant mutant{bytes, ""};
    std::string &content = mutant.content;
    for (std::size_t n = 1 + below(random, 3); n > 0 && !content.empty(); --n) {
      const std::size_t at = below(random, content.size());
      const std::size_t length =
          std::min<std::size_t>(1 + below(random, 64), content.size() - at);
      const char *done = "";
      switch (below(random, 7)) {
      case 0:
        done = "bit";
        content[at] = char(content[at] ^ (1 << below(random, 8)));
        break;
      case 1:
        done = "byte";
        content[at] = char(below(random, 256));
        break;
      case 2: {
        done = "word";
        static const std::vector<std::uint64_t> words = {
            0,
            ~std::uint64_t(0),
            std::uint64_t(1) << 63,
            0x7fffffff,
            0xffffffff,
            0x7ff0000000000000, // infinity
            0x7ff8000000000000, // not a number
            0x7fe0000000000000, // 1e308
            1};
        const std::uint64_t word = any_of(words, random);
        // numbers are aligned to their size in most formats
        const std::size_t aligned = at / 8 * 8;
        if (aligned + 8 <= content.size())
          std::memcpy(&content[aligned], &word, 8);
        break;
      }
      case 3:
        done = "hole";
        content.replace(at, length, length, '\0');
        break;
      case 4:
        done = "deleted";
        content.erase(at, length);
        break;
      case 5:
        done = "doubled";
        content.insert(at, content.substr(at, length));
        break;
      default:
        done = "cut";
        content.resize(at);
      }
      mutant.done += (mutant.done.empty() ? "" : ", ") + std::string(done);
    }
    return mutant;
  }
} // namespace nsfd::fuzz
