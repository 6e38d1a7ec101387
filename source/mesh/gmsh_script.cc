#include "gmsh_script.h"

#include "gmsh_lexer.h"
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
    /** Which words may stand where. */
    class Filter
    {
    public:
      Filter(const std::vector<GmshToken> &tokens, GmshComplaints &complaints,
             std::vector<std::string> &includes)
          : tokens_(tokens), complaints_(complaints), includes_(includes)
      {
        for (std::size_t i = 0; i + 1 < tokens_.size(); ++i)
          if (tokens_[i].kind == GmshToken::Kind::word)
            check_word(i);
      }

    private:
      const GmshToken &token(const std::size_t i) const
      {
        return tokens_[std::min(i, tokens_.size() - 1)];
      }

      bool is_word(const std::size_t i) const
      {
        return token(i).kind == GmshToken::Kind::word;
      }

      /** Behind the bracket that closes the one at @p i. */
      std::size_t behind_bracket(std::size_t i) const
      {
        unsigned int depth = 0;
        for (; i + 1 < tokens_.size(); ++i) {
          const GmshToken &t = tokens_[i];
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
            const GmshToken &t = tokens_[i];
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
        const GmshToken &next = token(i + 1);
        if (next.kind == GmshToken::Kind::string ||
            next.kind == GmshToken::Kind::number ||
            (next.kind == GmshToken::Kind::word && next.text != "In" &&
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
        const GmshToken &of = token(owner(i - 1));
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
        const GmshToken &name = token(i + 1);
        if (name.kind != GmshToken::Kind::string || !token(i + 2).is(";"))
          return complaints_.add(tokens_[i].line,
                                 "`Include` needs the name of a file in quotes "
                                 "and a semicolon");
        const bool plain =
            std::all_of(name.text.begin(), name.text.end(), [](const char c) {
              return is_gmsh_letter(c) || is_gmsh_digit(c) || c == '.' ||
                     c == '-' || c == '+' || c == ' ';
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
        const GmshToken &type = token(next + 1);
        if (type.kind != GmshToken::Kind::word || !is_gmsh_field(type.text))
          complaints_.add(type.line,
                          fmt::format("a field of type `{}` may read a file or "
                                      "run a command, or is not known",
                                      type.text));
      }

      const std::vector<GmshToken> &tokens_;
      GmshComplaints &complaints_;
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
    GmshComplaints complaints(where, problems);
    const GmshLexer lexer(text, complaints);
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
