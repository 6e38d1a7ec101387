#include "gmsh_lexer.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /// Gmsh's buffer of a string is 1024 long: what comes after it is a script
    constexpr std::size_t longest_string = 1000;

    /// Gmsh reads 8192 at once, and takes up a loop behind what it has read:
    /// not in the middle of a line, or of a string
    constexpr std::size_t longest_line = 8000;
  } // namespace

  void GmshLexer::put(const std::string &token)
  {
    if (out_.size() - line_begin_ + token.size() > longest_line)
      put_line_end();
    out_ += token;
  }

  void GmshLexer::read_one()
  {
    const char c = text_[at_];
    if (c == '\n') {
      line_end();
      ++at_;
    } else if (c == ' ' || c == '\t' || c == '\r' || c == '\f') {
      out_ += ' ';
      ++at_;
    } else if (c == '/' && ahead(1) == '/')
      while (at_ < text_.size() && text_[at_] != '\n')
        ++at_;
    else if (c == '/' && ahead(1) == '*')
      skip_comment();
    else if (c == '"' || c == '\'')
      read_string(c);
    else if (is_gmsh_letter(c)) {
      std::size_t n = 1;
      while (is_gmsh_letter(ahead(n)) || is_gmsh_digit(ahead(n)))
        ++n;
      add(GmshToken::Kind::word, n);
    } else if (is_gmsh_digit(c) || (c == '.' && is_gmsh_digit(ahead(1))))
      add(GmshToken::Kind::number, length_of_number());
    else
      read_sign(c);
  }

  void GmshLexer::skip_comment()
  {
    const unsigned int first_line = line_;
    const std::size_t end = text_.find("*/", at_ + 2);
    out_ += ' ';
    for (; at_ < std::min(end, text_.size()); ++at_)
      if (text_[at_] == '\n')
        line_end();
    if (end == std::string::npos)
      complaints_.add(first_line, "the comment that begins here has no end");
    else
      at_ += 2;
  }

  std::size_t GmshLexer::length_of_number() const
  {
    std::size_t n = 0;
    while (is_gmsh_digit(ahead(n)))
      ++n;
    if (ahead(n) == '.')
      ++n;
    while (is_gmsh_digit(ahead(n)))
      ++n;
    if (ahead(n) == 'e' || ahead(n) == 'E') {
      const std::size_t sign =
          ahead(n + 1) == '+' || ahead(n + 1) == '-' ? 1 : 0;
      if (is_gmsh_digit(ahead(n + 1 + sign))) {
        n += 1 + sign;
        while (is_gmsh_digit(ahead(n)))
          ++n;
      }
    }
    return n;
  }

  void GmshLexer::read_sign(const char c)
  {
    static const std::string known = "+-*/%^!<>=&|?:~#.,;()[]{}@";
    if (known.find(c) == std::string::npos) {
      const auto byte = static_cast<unsigned char>(c);
      complaints_.add(
          line_,
          std::isprint(byte)
              ? fmt::format("`{}` is no sign of Gmsh's scripts", c)
              : fmt::format("a byte {} is no sign of Gmsh's scripts", byte));
      ++at_;
      return;
    }
    add(GmshToken::Kind::sign, text_.compare(at_, 3, "...") == 0 ? 3 : 1);
  }

  void GmshLexer::read_string(const char quote)
  {
    std::size_t end = at_ + 1;
    while (end < text_.size() && text_[end] != quote && text_[end] != '\n')
      ++end;
    const std::string inside = text_.substr(at_ + 1, end - at_ - 1);
    const bool closed = end < text_.size() && text_[end] == quote;
    if (!closed)
      complaints_.add(line_, "the string that begins here has no end on "
                             "its line");
    else
      check_string(inside);
    tokens_.push_back({GmshToken::Kind::string, inside, line_});
    put(quote + inside + quote);
    at_ = closed ? end + 1 : end;
  }

  void GmshLexer::check_string(const std::string &inside)
  {
    if (inside.size() > longest_string)
      complaints_.add(line_, fmt::format("a string is longer than {} "
                                         "characters",
                                         longest_string));
    if (std::any_of(inside.begin(), inside.end(), [](const char c) {
          return c == '"' || c == '\'' ||
                 std::iscntrl(static_cast<unsigned char>(c));
        }))
      complaints_.add(line_, "a string has a quote or a control character "
                             "in it");
    for (const char *mark : {"//", "/*"})
      if (inside.find(mark) != std::string::npos)
        complaints_.add(line_, fmt::format("a string has `{}` in it, which "
                                           "Gmsh may take for a comment",
                                           mark));
    // Gmsh looks for these even inside strings
    std::string word;
    for (const char c : inside + " ")
      if (is_gmsh_letter(c))
        word += c;
      else {
        if (word == "If" || word == "ElseIf" || word == "Else" ||
            word == "EndIf" || word == "For" || word == "EndFor" ||
            word == "Return")
          complaints_.add(line_, fmt::format("a string has the word `{}` "
                                             "in it, which Gmsh may obey",
                                             word));
        word.clear();
      }
  }
} // namespace nsfd
