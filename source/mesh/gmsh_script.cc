#include "gmsh_script.h"

#include "gmsh_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace nsfd
{
  namespace
  {
    struct Token {
      enum class Kind { word, number, string, sign, end };
      Kind kind = Kind::end;
      std::string text; ///< of a string: what is between the quotes
      unsigned int line = 0;

      bool is(const char *sign) const
      {
        return kind == Kind::sign && text == sign;
      }
    };

    bool is_letter(const char c)
    {
      return std::isalpha(static_cast<unsigned char>(c)) || c == '_';
    }

    bool is_digit(const char c)
    {
      return std::isdigit(static_cast<unsigned char>(c));
    }

    /// Gmsh's buffer of a string is 1024 long: what comes after it is a script
    constexpr std::size_t longest_string = 1000;

    /// Gmsh reads 8192 at once, and takes up a loop behind what it has read:
    /// not in the middle of a line, or of a string
    constexpr std::size_t longest_line = 8000;

    /** The problems of one file, each with its line. */
    class Complaints
    {
    public:
      Complaints(const std::string &where, std::vector<std::string> &problems)
          : where_(where), problems_(problems)
      {
      }

      void add(const unsigned int line, const std::string &sentence)
      {
        problems_.push_back(
            fmt::format("line {}{}: {}", line, where_, sentence));
      }

      void add_word(const Token &word, const std::string &deed)
      {
        add(word.line, fmt::format("`{}` {}; a mesh script may only describe "
                                   "geometry and meshing",
                                   word.text, deed));
      }

    private:
      std::string where_;
      std::vector<std::string> &problems_;
    };

    /**
     * Words, numbers, strings and signs as the lexer of Gmsh sees them. The
     * text that comes out has no comments: Gmsh, which looks for the end of a
     * branch that is not taken without regard to strings, cannot take a string
     * for anything else.
     */
    class Lexer
    {
    public:
      Lexer(const std::string &text, Complaints &complaints)
          : text_(text), complaints_(complaints)
      {
        while (at_ < text_.size())
          read_one();
        tokens_.push_back({Token::Kind::end, "", line_});
      }

      const std::vector<Token> &tokens() const { return tokens_; }
      const std::string &text() const { return out_; }

    private:
      char ahead(const std::size_t n) const
      {
        return at_ + n < text_.size() ? text_[at_ + n] : '\0';
      }

      void add(const Token::Kind kind, const std::size_t length)
      {
        const std::string token = text_.substr(at_, length);
        tokens_.push_back({kind, token, line_});
        put(token);
        at_ += length;
      }

      void put(const std::string &token)
      {
        if (out_.size() - line_begin_ + token.size() > longest_line)
          put_line_end();
        out_ += token;
      }

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

      void read_one()
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
        else if (is_letter(c)) {
          std::size_t n = 1;
          while (is_letter(ahead(n)) || is_digit(ahead(n)))
            ++n;
          add(Token::Kind::word, n);
        } else if (is_digit(c) || (c == '.' && is_digit(ahead(1))))
          add(Token::Kind::number, length_of_number());
        else
          read_sign(c);
      }

      void skip_comment()
      {
        const unsigned int first_line = line_;
        const std::size_t end = text_.find("*/", at_ + 2);
        out_ += ' ';
        for (; at_ < std::min(end, text_.size()); ++at_)
          if (text_[at_] == '\n')
            line_end();
        if (end == std::string::npos)
          complaints_.add(first_line,
                          "the comment that begins here has no end");
        else
          at_ += 2;
      }

      std::size_t length_of_number() const
      {
        std::size_t n = 0;
        while (is_digit(ahead(n)))
          ++n;
        if (ahead(n) == '.')
          ++n;
        while (is_digit(ahead(n)))
          ++n;
        if (ahead(n) == 'e' || ahead(n) == 'E') {
          const std::size_t sign =
              ahead(n + 1) == '+' || ahead(n + 1) == '-' ? 1 : 0;
          if (is_digit(ahead(n + 1 + sign))) {
            n += 1 + sign;
            while (is_digit(ahead(n)))
              ++n;
          }
        }
        return n;
      }

      void read_sign(const char c)
      {
        static const std::string known = "+-*/%^!<>=&|?:~#.,;()[]{}@";
        if (known.find(c) == std::string::npos) {
          const auto byte = static_cast<unsigned char>(c);
          complaints_.add(
              line_, std::isprint(byte)
                         ? fmt::format("`{}` is no sign of Gmsh's scripts", c)
                         : fmt::format("a byte {} is no sign of Gmsh's scripts",
                                       byte));
          ++at_;
          return;
        }
        add(Token::Kind::sign, text_.compare(at_, 3, "...") == 0 ? 3 : 1);
      }

      /** Gmsh knows no escapes: the next quote of its kind is the end. */
      void read_string(const char quote)
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
        tokens_.push_back({Token::Kind::string, inside, line_});
        put(quote + inside + quote);
        at_ = closed ? end + 1 : end;
      }

      void check_string(const std::string &inside)
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
          if (is_letter(c))
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

      const std::string &text_;
      Complaints &complaints_;
      std::size_t at_ = 0, line_begin_ = 0;
      unsigned int line_ = 1;
      std::vector<Token> tokens_;
      std::string out_;
    };

    /** Which words may stand where. */
    class Filter
    {
    public:
      Filter(const std::vector<Token> &tokens, Complaints &complaints,
             std::vector<std::string> &includes)
          : tokens_(tokens), complaints_(complaints), includes_(includes)
      {
        for (std::size_t i = 0; i + 1 < tokens_.size(); ++i)
          if (tokens_[i].kind == Token::Kind::word)
            check_word(i);
      }

    private:
      const Token &token(const std::size_t i) const
      {
        return tokens_[std::min(i, tokens_.size() - 1)];
      }

      bool is_word(const std::size_t i) const
      {
        return token(i).kind == Token::Kind::word;
      }

      /** Behind the bracket that closes the one at @p i. */
      std::size_t behind_bracket(std::size_t i) const
      {
        unsigned int depth = 0;
        for (; i + 1 < tokens_.size(); ++i) {
          const Token &t = tokens_[i];
          if (t.is("(") || t.is("[") || t.is("{"))
            ++depth;
          else if (t.is(")") || t.is("]") || t.is("}"))
            if (depth > 0 && --depth == 0)
              return i + 1;
        }
        return i;
      }

      /** What the member behind the dot at @p dot belongs to. */
      std::size_t owner(const std::size_t dot) const
      {
        std::size_t i = dot;
        if (i > 0 && (tokens_[i - 1].is("]") || tokens_[i - 1].is(")"))) {
          unsigned int depth = 0;
          while (i-- > 0) {
            const Token &t = tokens_[i];
            if (t.is(")") || t.is("]") || t.is("}"))
              ++depth;
            else if ((t.is("(") || t.is("[") || t.is("{")) && --depth == 0)
              break;
          }
        }
        return i > 0 ? i - 1 : tokens_.size() - 1;
      }

      void check_word(const std::size_t i)
      {
        if (i > 0 && tokens_[i - 1].is("."))
          return check_member(i);
        const std::string &word = tokens_[i].text;
        switch (classify_gmsh_word(word)) {
        case GmshWord::refused:
          return refuse(i);
        case GmshWord::free:
          return check_free(i);
        case GmshWord::allowed:
          break;
        }
        if (word == "Include")
          check_include(i);
        else if (word == "Printf")
          check_printf(i);
        else if (word == "Field")
          check_field(i);
      }

      void refuse(const std::size_t i)
      {
        const std::string &word = tokens_[i].text;
        if (word.compare(0, 5, "Merge") == 0)
          complaints_.add(
              tokens_[i].line,
              fmt::format("`{}` reads another file; name a STEP or BREP file "
                          "itself as the `file` of the mesh, or bring the "
                          "geometry into the script",
                          word));
        else
          complaints_.add_word(tokens_[i], deed_of_gmsh_word(word));
      }

      /** A name of the script's own is no command. */
      void check_free(const std::size_t i)
      {
        const std::string &word = tokens_[i].text;
        if (is_gmsh_attribute(word))
          return;
        const Token &next = token(i + 1);
        if (next.kind == Token::Kind::string ||
            next.kind == Token::Kind::number ||
            (next.kind == Token::Kind::word && next.text != "In" &&
             !is_given_name(i)))
          complaints_.add_word(tokens_[i], "is no command that is known here");
      }

      /** `Macro column`: a statement may follow. */
      bool is_given_name(const std::size_t i) const
      {
        return i > 0 && is_word(i - 1) &&
               (tokens_[i - 1].text == "Macro" ||
                tokens_[i - 1].text == "Function" ||
                tokens_[i - 1].text == "Color");
      }

      void check_member(const std::size_t i)
      {
        const Token &of = token(owner(i - 1));
        const std::string &member = tokens_[i].text;
        if (of.text == "Field") {
          if (!is_gmsh_field_option(member))
            complaints_.add(tokens_[i].line,
                            fmt::format("the option `{}` of a field may read a "
                                        "file or run a command, or is not "
                                        "known",
                                        member));
        } else if (of.text == "Color" ? !is_color(i)
                                      : !is_gmsh_option(of.text, member))
          complaints_.add(tokens_[i].line,
                          fmt::format("the option `{}.{}` is not one of "
                                      "geometry or meshing",
                                      of.text, member));
      }

      /** `Mesh.Color.Lines` */
      bool is_color(const std::size_t i) const
      {
        return i >= 3 && tokens_[i - 3].is(".");
      }

      void check_include(const std::size_t i)
      {
        const Token &name = token(i + 1);
        if (name.kind != Token::Kind::string || !token(i + 2).is(";"))
          return complaints_.add(tokens_[i].line,
                                 "`Include` needs the name of a file in quotes "
                                 "and a semicolon");
        const bool plain =
            std::all_of(name.text.begin(), name.text.end(), [](const char c) {
              return is_letter(c) || is_digit(c) || c == '.' || c == '-' ||
                     c == '+' || c == ' ';
            });
        if (!plain || name.text.empty() || name.text[0] == '.')
          return complaints_.add(
              name.line, fmt::format("`Include \"{}\"`: only files in the "
                                     "folder of the script can be included",
                                     name.text));
        includes_.push_back(name.text);
      }

      void check_printf(const std::size_t i)
      {
        if (!token(i + 1).is("(") || !token(behind_bracket(i + 1)).is(";"))
          complaints_.add_word(
              tokens_[i], "with anything behind its bracket writes a file");
      }

      void check_field(const std::size_t i)
      {
        if (!token(i + 1).is("["))
          return;
        const std::size_t next = behind_bracket(i + 1);
        if (!token(next).is("="))
          return;
        const Token &type = token(next + 1);
        if (type.kind != Token::Kind::word || !is_gmsh_field(type.text))
          complaints_.add(type.line,
                          fmt::format("a field of type `{}` may read a file or "
                                      "run a command, or is not known",
                                      type.text));
      }

      const std::vector<Token> &tokens_;
      Complaints &complaints_;
      std::vector<std::string> &includes_;
    };

    /** The script and what it includes, with the way to each file. */
    class Collector
    {
    public:
      Collector(const std::filesystem::path &folder, GmshScript &script,
                std::vector<std::string> &problems)
          : folder_(folder), script_(script), problems_(problems)
      {
      }

      void add(const std::string &file, const std::string &name,
               const std::string &where)
      {
        std::vector<std::string> includes;
        std::ifstream in(folder_ / file, std::ios::binary);
        std::ostringstream text;
        text << in.rdbuf();
        script_.files[name] =
            filter_gmsh_script(text.str(), where, includes, problems_);
        open_.insert(file);
        for (const std::string &other : includes)
          include(other, where);
        open_.erase(file);
      }

    private:
      void include(const std::string &name, const std::string &where)
      {
        if (open_.count(name) > 0)
          problems_.push_back(fmt::format("`{}` includes itself", name));
        else if (!std::filesystem::is_regular_file(folder_ / name))
          problems_.push_back(
              fmt::format("`Include \"{}\"`{}: there is no such "
                          "file in the folder of the script",
                          name, where));
        else if (script_.files.count(name) == 0)
          add(name, name, fmt::format(" of `{}`", name));
      }

      std::filesystem::path folder_;
      GmshScript &script_;
      std::vector<std::string> &problems_;
      std::set<std::string> open_; ///< files that are being read
    };
  } // namespace

  std::string filter_gmsh_script(const std::string &text,
                                 const std::string &where,
                                 std::vector<std::string> &includes,
                                 std::vector<std::string> &problems)
  {
    Complaints complaints(where, problems);
    const Lexer lexer(text, complaints);
    Filter(lexer.tokens(), complaints, includes);
    return lexer.text();
  }

  GmshScript read_gmsh_script(const std::string &file,
                              std::vector<std::string> &problems)
  {
    const std::filesystem::path path(file);
    GmshScript script;
    // Gmsh goes by the extension; nothing that is included can be called so
    script.name = "(" + path.stem().string() + ").geo";
    for (char &c : script.name)
      if (c == '/' || std::iscntrl(static_cast<unsigned char>(c)))
        c = '_';
    Collector(path.parent_path(), script, problems)
        .add(path.filename().string(), script.name, "");
    return script;
  }
} // namespace nsfd
