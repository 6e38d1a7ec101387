#include "parameter_file.h"

#include "text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <sstream>

namespace nsfd
{
  namespace
  {
    bool is_blank(const char c)
    {
      return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
    }

    std::vector<std::string> split_lines(const std::string &text)
    {
      std::vector<std::string> lines;
      std::istringstream stream(text);
      for (std::string line; std::getline(stream, line);) {
        if (!line.empty() && line.back() == '\r')
          line.pop_back();
        lines.push_back(line);
      }
      return lines;
    }

    /** The `#` lines before anything else. */
    std::vector<std::string>
    leading_comment(const std::vector<std::string> &lines)
    {
      std::vector<std::string> comment;
      for (const std::string &line : lines) {
        const std::size_t first = line.find_first_not_of(" \t");
        if (first == std::string::npos && comment.empty())
          continue;
        if (first == std::string::npos || line[first] != '#')
          break;
        comment.push_back(line.substr(first));
      }
      return comment;
    }

    /** Names of blocks become columns of tables and members of lists. */
    bool is_block_name(const std::string &name)
    {
      return std::all_of(name.begin(), name.end(), [](const char c) {
        return (c & 0x80) != 0 || std::isalnum(static_cast<unsigned char>(c)) ||
               std::string(" _-+./").find(c) != std::string::npos;
      });
    }

    /** Puts the statements of one file into the sections. */
    class Parser
    {
    public:
      Parser(ParameterFile &file, InputErrors &errors)
          : file_(file), errors_(errors), section_(&file.top())
      {
      }

      void parse(const std::string &text, const std::string &source);
      /** @return false if there is no such text file */
      bool include(const std::string &path, const SourceLocation &from,
                   bool is_outermost);

    private:
      ParameterFile &file_;
      InputErrors &errors_;
      ParameterSection *section_;
      /// entries of a doubled section are read, but go nowhere
      std::unique_ptr<ParameterSection> discarded_;
      std::vector<std::string> open_files_;
      std::size_t n_statements_ = 0;

      /// false, and reported, if nothing more is to be read
      bool statement(const SourceText &line, const std::string &source);
      void set(const SourceText &rest, const SourceText &line);
      void begin_section(const SourceText &name, const SourceText &line);
      void end_section(const SourceText &rest, const SourceText &line);
    };

    void Parser::parse(const std::string &text, const std::string &source)
    {
      const std::vector<std::string> lines = split_lines(text);
      ParameterSection *const outer = section_;
      // every place in a line has a copy of the line
      const auto is_short = [&](const std::size_t size,
                                const std::size_t number,
                                const std::string &what) {
        if (size <= text_limits::line)
          return true;
        errors_.error({source, unsigned(number), 0, 0, ""},
                      fmt::format("this {} has {} bytes, more than {}", what,
                                  size, text_limits::line),
                      "break it up; tables of numbers belong into files of "
                      "their own");
        return false;
      };

      SourceText statement_text;
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string &line = lines[i];
        if (!is_short(line.size(), i + 1, "line"))
          continue;
        const SourceLocation start{source, static_cast<unsigned int>(i + 1), 0,
                                   0, line};
        const std::size_t comment = line.find('#');
        SourceText code =
            SourceText(line, start)
                .part(0, comment == std::string::npos ? line.size() : comment);

        // a comment of its own does not end a continued statement
        if (code.empty() && comment != std::string::npos &&
            !statement_text.empty())
          continue;
        const bool continues = !code.empty() && code.text().back() == '\\';
        if (continues)
          code = code.part(0, code.text().size() - 1);
        // of a statement that is too long, the first lines have been blamed
        if (statement_text.text().size() <= text_limits::line)
          statement_text.append(code);
        if (continues)
          continue;
        if (!statement_text.empty() &&
            is_short(statement_text.text().size(), i + 1,
                     "statement of several lines") &&
            !statement(statement_text, source))
          return;
        statement_text = SourceText();
      }
      if (!statement_text.empty() && !statement(statement_text, source))
        return;

      if (section_ == &file_.top() && outer != section_)
        errors_.error({source, 0, 0, 0, ""},
                      "it ends a section that it does not begin",
                      "remove the last `end`");
      else if (section_ != outer) {
        errors_.error(
            section_->location(),
            fmt::format("section `{}` is not closed", section_->name()),
            "add a line `end`");
        section_ = outer;
      }
    }

    bool Parser::statement(const SourceText &line, const std::string &source)
    {
      if (++n_statements_ > text_limits::statements) {
        if (n_statements_ == text_limits::statements + 1)
          errors_.error(line.location(),
                        fmt::format("these are more than {} statements",
                                    text_limits::statements),
                        "the rest was not read; no scene needs so many");
        return false;
      }
      const std::string &text = line.text();
      std::size_t end = 0;
      while (end < text.size() && !is_blank(text[end]))
        ++end;
      const std::string keyword = text.substr(0, end);
      const SourceText rest = line.part(end);

      if (keyword == "set" || keyword == "SET")
        set(rest, line);
      else if (keyword == "subsection" || keyword == "SUBSECTION")
        begin_section(rest, line);
      else if (keyword == "end" || keyword == "END")
        end_section(rest, line);
      else if (keyword == "include" || keyword == "INCLUDE") {
        if (rest.empty()) {
          errors_.error(line.location(), "`include` names no file",
                        "write for example: include common.prm");
          return true;
        }
        // an absolute path replaces the folder
        const auto folder = std::filesystem::path(source).parent_path();
        include((folder / rest.text()).lexically_normal().string(),
                rest.location(), false);
      } else {
        const bool assigns = text.find('=') != std::string::npos;
        std::string advice = did_you_mean(
            keyword, {"set", "subsection", "end", "include"},
            assigns ? "write for example: set " + collapse_blanks(text)
                    : "a line begins with set, subsection, end or include");
        errors_.error(line.locate(0, end),
                      fmt::format("`{}` does not begin a statement", keyword),
                      advice);
      }
      return true;
    }

    void Parser::set(const SourceText &rest, const SourceText &line)
    {
      const std::size_t equals = rest.text().find('=');
      if (equals == std::string::npos)
        return errors_.error(line.location(), "there is no `=` in this line",
                             "write: set NAME = VALUE");
      const SourceText name = rest.part(0, equals);
      if (name.empty())
        return errors_.error(line.location(), "there is no name before `=`",
                             "write: set NAME = VALUE");

      ParameterEntry entry =
          in_todays_words(section_->kind(),
                          {collapse_blanks(name.text()), rest.part(equals + 1),
                           name.location()},
                          errors_);
      if (const ParameterEntry *first = section_->find(entry.name))
        return errors_.error(
            entry.name_location,
            fmt::format("`{}` is given twice in {}", entry.name,
                        section_->description()),
            fmt::format("it stands in {}:{} already; keep one of the two",
                        first->name_location.source,
                        first->name_location.line));
      section_->assign(std::move(entry));
    }

    void Parser::begin_section(const SourceText &name, const SourceText &line)
    {
      if (section_ != &file_.top()) {
        errors_.error(
            line.location(),
            fmt::format("section `{}` is not closed before this line",
                        section_->name()),
            fmt::format("it begins in line {}: add a line `end`; sections are "
                        "not nested",
                        section_->location().line));
        section_ = &file_.top();
      }

      std::string full_name = canonical_section_name(name.text());
      const std::size_t colon = full_name.find(": ");
      if (full_name.size() > text_limits::name) {
        errors_.error(name.location(),
                      fmt::format("this name has {} bytes, more than {}",
                                  full_name.size(), text_limits::name),
                      "give the section a shorter name");
        full_name.clear(); // what follows goes nowhere
      } else if (full_name.empty())
        errors_.error(line.location(), "the section has no name",
                      "write for example: subsection Time");
      else if (colon != std::string::npos &&
               !is_block_name(full_name.substr(colon + 2)))
        errors_.error(name.location(),
                      fmt::format("`{}` cannot be the name of a block",
                                  full_name.substr(colon + 2)),
                      "use letters, digits, blanks and _ - + . /");

      const ParameterSection *first = file_.find(full_name);
      if (!full_name.empty() && first == nullptr) {
        section_ = &file_.add(full_name, name.location());
        return;
      }
      if (first != nullptr && first != &file_.top())
        errors_.error(
            name.location(),
            fmt::format("there are two sections `{}`", full_name),
            fmt::format("the first begins in {}:{}; join them, or give the "
                        "second another name",
                        first->location().source, first->location().line));
      discarded_ = std::make_unique<ParameterSection>(
          full_name, line.location(), file_.constants());
      section_ = discarded_.get();
    }

    void Parser::end_section(const SourceText &rest, const SourceText &line)
    {
      if (!rest.empty())
        errors_.error(rest.location(),
                      fmt::format("`{}` after `end`", rest.text()),
                      "`end` stands alone; write a comment after #");
      if (section_ == &file_.top())
        return errors_.error(line.location(), "there is no section to end here",
                             "remove this line, or look for an `end` too many "
                             "above it");
      section_ = &file_.top();
    }

    bool Parser::include(const std::string &path, const SourceLocation &from,
                         const bool is_outermost)
    {
      if (std::find(open_files_.begin(), open_files_.end(), path) !=
          open_files_.end()) {
        errors_.error(from, fmt::format("`{}` includes itself", path),
                      "remove this line");
        return false;
      }
      constexpr std::size_t deepest = 20;
      if (open_files_.size() == deepest) {
        errors_.error(from,
                      fmt::format("`{}` is included by a file that is "
                                  "included, and so on, {} times",
                                  path, deepest),
                      "write what it says into one of them");
        return false;
      }
      const TextFile file = read_text_file(path, text_limits::parameter_file);
      if (!file.problem.empty()) {
        SourceLocation place = from;
        if (file.line > 0)
          place = {path, file.line, 0, 0, ""};
        errors_.error(place, fmt::format("`{}` {}", path, file.problem),
                      file.advice);
        return false;
      }
      if (is_outermost)
        file_.set_opening_comment(leading_comment(split_lines(file.content)));

      open_files_.push_back(path);
      parse(file.content, path);
      open_files_.pop_back();
      return true;
    }
  } // namespace

  bool ParameterFile::read_file(const std::string &file, InputErrors &errors)
  {
    const SourceLocation whole{file, 0, 0, 0, ""};
    top().set_location(whole);
    return Parser(*this, errors).include(file, whole, true);
  }

  void ParameterFile::read_text(const std::string &text,
                                const std::string &source, InputErrors &errors)
  {
    top().set_location({source, 0, 0, 0, ""});
    set_opening_comment(leading_comment(split_lines(text)));
    Parser(*this, errors).parse(text, source);
  }
} // namespace nsfd
