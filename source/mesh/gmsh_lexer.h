#pragma once

#include <fmt/format.h>

#include <cctype>
#include <string>
#include <vector>

namespace nsfd
{
  /** A word, number, string or sign of a script of Gmsh. */
  struct GmshToken {
    enum class Kind { word, number, string, sign, end };
    Kind kind = Kind::end;
    std::string text; ///< of a string: what is between the quotes
    unsigned int line = 0;

    bool is(const char *sign) const
    {
      return kind == Kind::sign && text == sign;
    }
  };

  /** The problems of one file, each with its line. */
  class GmshComplaints
  {
  public:
    GmshComplaints(const std::string &where, std::vector<std::string> &problems)
        : where_(where), problems_(problems)
    {
    }

    void add(const unsigned int line, const std::string &sentence)
    {
      problems_.push_back(fmt::format("line {}{}: {}", line, where_, sentence));
    }

    void add_word(const GmshToken &word, const std::string &deed)
    {
      add(word.line, fmt::format("`{}` {}; a mesh script may only describe "
                                 "geometry and meshing",
                                 word.text, deed));
    }

  private:
    std::string where_;
    std::vector<std::string> &problems_;
  };

  /** What a name begins with, and goes on with besides digits. */
  inline bool is_gmsh_letter(const char c)
  {
    return std::isalpha(static_cast<unsigned char>(c)) || c == '_';
  }

  inline bool is_gmsh_digit(const char c)
  {
    return std::isdigit(static_cast<unsigned char>(c));
  }

  /**
   * Words, numbers, strings and signs as the lexer of Gmsh sees them. The
   * text that comes out has no comments: Gmsh, which looks for the end of a
   * branch that is not taken without regard to strings, cannot take a string
   * for anything else.
   */
  class GmshLexer
  {
  public:
    GmshLexer(const std::string &text, GmshComplaints &complaints)
        : text_(text), complaints_(complaints)
    {
      while (at_ < text_.size())
        read_one();
      tokens_.push_back({GmshToken::Kind::end, "", line_});
    }

    const std::vector<GmshToken> &tokens() const { return tokens_; }
    const std::string &text() const { return out_; }

  private:
    char ahead(const std::size_t n) const
    {
      return at_ + n < text_.size() ? text_[at_ + n] : '\0';
    }

    void add(const GmshToken::Kind kind, const std::size_t length)
    {
      const std::string token = text_.substr(at_, length);
      tokens_.push_back({kind, token, line_});
      put(token);
      at_ += length;
    }

    void put(const std::string &token);

    void put_line_end()
    {
      out_ += '\n';
      line_begin_ = out_.size();
    }

    void line_end()
    {
      put_line_end();
      ++line_;
    }

    void read_one();
    void skip_comment();
    std::size_t length_of_number() const;
    void read_sign(char c);
    /** Gmsh knows no escapes: the next quote of its kind is the end. */
    void read_string(char quote);
    void check_string(const std::string &inside);

    const std::string &text_;
    GmshComplaints &complaints_;
    std::size_t at_ = 0, line_begin_ = 0;
    unsigned int line_ = 1;
    std::vector<GmshToken> tokens_;
    std::string out_;
  };
} // namespace nsfd
