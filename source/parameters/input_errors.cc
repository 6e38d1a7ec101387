#include "input_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

namespace nsfd
{
  namespace
  {
    /** Bytes that continue a UTF-8 character take no column of their own. */
    bool continues_character(const char c)
    {
      return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
    }

    unsigned int n_characters(const std::string &text)
    {
      return std::count_if(text.begin(), text.end(), [](const char c) {
        return !continues_character(c);
      });
    }

    /** Control characters would disturb the terminal; tabs keep the caret. */
    std::string printable(std::string text)
    {
      for (char &c : text)
        if (std::iscntrl(static_cast<unsigned char>(c)) && c != '\t')
          c = '?';
      return text;
    }

    /** A value of many lines says no more in full. */
    std::string shortened(const std::string &text)
    {
      constexpr std::size_t longest = 500, kept = 220;
      if (text.size() <= longest)
        return text;
      std::size_t end = kept, begin = text.size() - kept;
      while (end > 0 && continues_character(text[end]))
        --end;
      while (begin < text.size() && continues_character(text[begin]))
        ++begin;
      return text.substr(0, end) + " ... " + text.substr(begin);
    }

    /** The line with its caret line, cut to a window around the caret. */
    std::string excerpt(const SourceLocation &at)
    {
      constexpr std::size_t window = 120;
      std::size_t begin = 0;
      if (at.column > window / 2 && at.text.size() > window)
        begin = at.column - window / 2;
      while (begin > 0 && continues_character(at.text[begin]))
        --begin;
      std::size_t end = std::min(at.text.size(), begin + window);
      while (end < at.text.size() && continues_character(at.text[end]))
        ++end;

      const std::string gutter =
          at.line > 0 ? fmt::format("{:>4}", at.line) : std::string(4, ' ');
      std::string result = fmt::format(
          "{} | {}\n", gutter, printable(at.text.substr(begin, end - begin)));
      if (at.length == 0 || at.column < begin || at.column > end)
        return result;

      std::string padding;
      for (std::size_t i = begin; i < at.column; ++i)
        if (at.text[i] == '\t')
          padding += '\t';
        else if (!continues_character(at.text[i]))
          padding += ' ';
      const unsigned int n_marks = std::max(
          1u,
          n_characters(at.text.substr(
              at.column, std::min<std::size_t>(at.length, end - at.column))));
      return result + std::string(gutter.size(), ' ') + " | " + padding + "^" +
             std::string(n_marks - 1, '~') + "\n";
    }

    std::string to_text(const Diagnostic &diagnostic)
    {
      const SourceLocation &at = diagnostic.location;
      std::string result = at.source;
      if (at.line > 0)
        result += ":" + std::to_string(at.line);
      using Kind = Diagnostic::Kind;
      result += diagnostic.kind == Kind::error     ? ": error: "
                : diagnostic.kind == Kind::warning ? ": warning: "
                                                   : ": note: ";
      result += printable(shortened(diagnostic.message)) + "\n";
      if (!at.text.empty())
        result += excerpt(at);
      if (!diagnostic.advice.empty())
        result += "  " + printable(shortened(diagnostic.advice)) + "\n";
      return result;
    }

    /**
     * Edits (insert, delete, replace, swap of neighbours) from a to b, or some
     * number from @p enough on if they are more.
     */
    std::size_t edit_distance(const std::string &a, const std::string &b,
                              const std::size_t enough)
    {
      const std::size_t difference =
          a.size() < b.size() ? b.size() - a.size() : a.size() - b.size();
      if (difference >= enough)
        return difference;
      std::vector<std::vector<std::size_t>> d(
          a.size() + 1, std::vector<std::size_t>(b.size() + 1));
      for (std::size_t i = 0; i <= a.size(); ++i)
        d[i][0] = i;
      for (std::size_t j = 0; j <= b.size(); ++j)
        d[0][j] = j;
      for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
          d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1,
                              d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
          if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
            d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
      return d[a.size()][b.size()];
    }

    std::string lower_case(std::string text)
    {
      for (char &c : text)
        c = std::tolower(static_cast<unsigned char>(c));
      return text;
    }

    /** "modulus" in "Young modulus": one is the other less some whole words. */
    bool contains_words(const std::string &a, const std::string &b)
    {
      const std::string &shorter = a.size() < b.size() ? a : b;
      const std::string &longer = a.size() < b.size() ? b : a;
      return shorter.size() > 2 &&
             (" " + longer + " ").find(" " + shorter + " ") !=
                 std::string::npos;
    }
  } // namespace

  void InputErrors::error(const SourceLocation &location,
                          const std::string &message, const std::string &advice)
  {
    diagnostics_.push_back(
        {location, message, advice, Diagnostic::Kind::error});
  }

  void InputErrors::warning(const SourceLocation &location,
                            const std::string &message,
                            const std::string &advice)
  {
    diagnostics_.push_back(
        {location, message, advice, Diagnostic::Kind::warning});
  }

  void InputErrors::note(const SourceLocation &location,
                         const std::string &message)
  {
    const auto is_same = [&message](const Diagnostic &d) {
      return d.kind == Diagnostic::Kind::note && d.message == message;
    };
    if (std::none_of(diagnostics_.begin(), diagnostics_.end(), is_same))
      diagnostics_.push_back({location, message, "", Diagnostic::Kind::note});
  }

  void InputErrors::add(const Diagnostic &diagnostic)
  {
    if (diagnostic.kind == Diagnostic::Kind::note)
      note(diagnostic.location, diagnostic.message);
    else
      diagnostics_.push_back(diagnostic);
  }

  void InputErrors::withdraw(const SourceLocation &location,
                             const std::string &message)
  {
    const auto is_meant = [&](const Diagnostic &d) {
      return d.message == message && d.location.source == location.source &&
             d.location.line == location.line;
    };
    diagnostics_.erase(
        std::remove_if(diagnostics_.begin(), diagnostics_.end(), is_meant),
        diagnostics_.end());
  }

  unsigned int InputErrors::n_errors() const
  {
    return std::count_if(diagnostics_.begin(), diagnostics_.end(),
                         [](const Diagnostic &d) { return d.is_error(); });
  }

  std::string InputErrors::report(const unsigned int n_shown) const
  {
    // files in the order in which they were first blamed, then by line
    std::map<std::string, std::size_t> rank;
    for (const Diagnostic &d : diagnostics_)
      rank.emplace(d.location.source, rank.size());
    std::vector<const Diagnostic *> sorted;
    for (const Diagnostic &d : diagnostics_)
      sorted.push_back(&d);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&rank](const Diagnostic *a, const Diagnostic *b) {
                       const auto key = [&rank](const Diagnostic *d) {
                         return std::make_pair(rank.at(d->location.source),
                                               d->location.line);
                       };
                       return key(a) < key(b);
                     });

    std::string result;
    for (std::size_t i = 0; i < sorted.size() && i < n_shown; ++i)
      result += to_text(*sorted[i]);
    if (sorted.size() > n_shown)
      result += fmt::format("... and {} more\n", sorted.size() - n_shown);
    if (has_errors())
      result += fmt::format("{} error{}, nothing was run\n", n_errors(),
                            n_errors() == 1 ? "" : "s");
    return result;
  }

  std::string nearest_name(const std::string &word,
                           const std::vector<std::string> &candidates)
  {
    constexpr std::size_t longest_name = 80;
    if (word.empty() || word.size() > longest_name)
      return "";

    std::string best;
    // one slip in short names, about one in three letters in long ones
    std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string &candidate : candidates) {
      const std::size_t distance =
          edit_distance(lower_case(word), lower_case(candidate), best_distance);
      if (distance < best_distance && distance < candidate.size()) {
        best = candidate;
        best_distance = distance;
      }
    }
    if (!best.empty())
      return best;
    for (const std::string &candidate : candidates)
      if (contains_words(lower_case(word), lower_case(candidate)))
        return candidate;
    return "";
  }

  std::string did_you_mean(const std::string &word,
                           const std::vector<std::string> &candidates,
                           const std::string &otherwise)
  {
    const std::string name = nearest_name(word, candidates);
    return name.empty() ? otherwise : "did you mean `" + name + "`?";
  }
} // namespace nsfd
