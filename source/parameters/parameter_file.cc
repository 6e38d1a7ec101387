#include "parameter_file.h"

#include "former_words.h"
#include "text_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    constexpr const char *blanks = " \t\r\v\f";
    constexpr const char *command_line = "--set";

    bool is_override(const ParameterEntry &entry)
    {
      return entry.name_location.source == command_line;
    }
  } // namespace

  std::string collapse_blanks(const std::string &text)
  {
    std::string result;
    for (const char c : text) {
      const bool is_blank = std::string(blanks).find(c) != std::string::npos;
      if (!is_blank)
        result += c;
      else if (!result.empty() && result.back() != ' ')
        result += ' ';
    }
    if (!result.empty() && result.back() == ' ')
      result.pop_back();
    return result;
  }

  std::string canonical_section_name(const std::string &name)
  {
    const std::size_t colon = name.find(':');
    if (colon == std::string::npos)
      return collapse_blanks(name);
    return collapse_blanks(name.substr(0, colon)) + ": " +
           collapse_blanks(name.substr(colon + 1));
  }

  SourceText::SourceText(std::string text, SourceLocation start)
      : text_(std::move(text)), pieces_{{0, std::move(start)}}
  {
  }

  SourceLocation SourceText::locate(const std::size_t offset,
                                    const std::size_t length) const
  {
    if (pieces_.empty())
      return {};
    const Piece *piece = &pieces_.front();
    for (const Piece &candidate : pieces_)
      if (candidate.offset <= offset)
        piece = &candidate;
    SourceLocation result = piece->start;
    result.column += offset - piece->offset;
    result.length = length;
    if (result.column + length > result.text.size())
      result.length = result.column < result.text.size()
                          ? result.text.size() - result.column
                          : 1;
    return result;
  }

  SourceText SourceText::part(const std::size_t offset,
                              const std::size_t length) const
  {
    const std::size_t stop =
        length == std::string::npos ? text_.size() : offset + length;
    std::size_t begin = text_.find_first_not_of(blanks, offset);
    begin = std::min(begin, stop);
    std::size_t end = stop;
    while (end > begin &&
           std::string(blanks).find(text_[end - 1]) != std::string::npos)
      --end;

    SourceText result;
    result.text_ = text_.substr(begin, end - begin);
    result.pieces_.push_back({0, locate(begin, end - begin)});
    for (const Piece &piece : pieces_)
      if (piece.offset > begin && piece.offset < end)
        result.pieces_.push_back({piece.offset - begin, piece.start});
    return result;
  }

  std::vector<SourceText> SourceText::split(const char separator) const
  {
    std::vector<SourceText> result;
    std::size_t begin = 0;
    int depth = 0;
    for (std::size_t i = 0; i <= text_.size(); ++i) {
      if (i < text_.size() && (text_[i] == '(' || text_[i] == '['))
        ++depth;
      if (i < text_.size() && (text_[i] == ')' || text_[i] == ']'))
        --depth;
      if (i == text_.size() || (text_[i] == separator && depth <= 0)) {
        result.push_back(part(begin, i - begin));
        begin = i + 1;
      }
    }
    return result;
  }

  void SourceText::append(const SourceText &next)
  {
    if (next.empty())
      return;
    if (!text_.empty())
      text_ += ' ';
    if (text_.empty())
      pieces_.clear();
    for (Piece piece : next.pieces_) {
      piece.offset += text_.size();
      pieces_.push_back(piece);
    }
    text_ += next.text_;
  }

  ParameterEntry in_todays_words(const std::string &section_kind,
                                 ParameterEntry entry, InputErrors &errors)
  {
    std::string value = collapse_blanks(entry.value.text());
    for (const FormerWord *word :
         renew_words(section_kind, entry.name, value)) {
      SourceLocation place = entry.name_location;
      place.text.clear(); // one line says it
      if (!word->stays)
        errors.note(place,
                    fmt::format("`{}` is called `{}` today; both words work",
                                word->former, word->now));
      if (word->place != FormerWord::Place::entry)
        entry.value = SourceText(value, entry.value.location());
    }
    return entry;
  }

  ParameterSection::ParameterSection(std::string name, SourceLocation location,
                                     const Constants &constants)
      : name_(std::move(name)), location_(std::move(location)),
        constants_(constants)
  {
  }

  std::string ParameterSection::kind() const
  {
    return name_.substr(0, name_.find(':'));
  }

  std::string ParameterSection::block_name() const
  {
    const std::size_t colon = name_.find(": ");
    return colon == std::string::npos ? "" : name_.substr(colon + 2);
  }

  std::string ParameterSection::description() const
  {
    return name_.empty() ? "the top level" : "section `" + name_ + "`";
  }

  const ParameterEntry *ParameterSection::find(const std::string &name) const
  {
    const auto found = entry_of_.find(name);
    return found == entry_of_.end() ? nullptr : &entries_[found->second];
  }

  void ParameterSection::assign(ParameterEntry entry)
  {
    const auto [place, is_new] = entry_of_.emplace(entry.name, entries_.size());
    if (is_new)
      entries_.push_back(std::move(entry));
    else
      entries_[place->second] = std::move(entry);
  }

  void ParameterSection::declare(DeclaredParameter parameter)
  {
    for (const DeclaredParameter &old : declared_)
      if (old.name == parameter.name)
        return;
    declared_.push_back(std::move(parameter));
  }

  std::string ParameterSection::missing_message(const std::string &name) const
  {
    return fmt::format("`{}` is missing in {}", name, description());
  }

  void ParameterSection::report_missing(const std::string &name,
                                        const std::string &advice,
                                        InputErrors &errors)
  {
    missing_.insert(name);
    errors.error(location_, missing_message(name), advice);
  }

  void ParameterSection::report_stray(InputErrors &errors) const
  {
    if (accepts_everything_)
      return;

    std::vector<std::string> valid;
    for (const DeclaredParameter &parameter : declared_)
      valid.push_back(parameter.name);
    for (const std::string &name : mentioned_)
      if (std::find(valid.begin(), valid.end(), name) == valid.end())
        valid.push_back(name);
    std::vector<const ParameterEntry *> given;
    for (const std::string &name : valid)
      given.push_back(find(name));
    // what is given already cannot have been meant a second time, but --set
    // may replace what the file gives
    const auto candidates = [&](const ParameterEntry &stray) {
      std::vector<std::string> names;
      for (std::size_t i = 0; i < valid.size(); ++i)
        if (given[i] == nullptr ||
            (is_override(stray) && !is_override(*given[i])))
          names.push_back(valid[i]);
      return names;
    };

    std::size_t n_stray = 0;
    constexpr std::size_t most_told = 100;
    for (const ParameterEntry &entry : entries_) {
      const bool is_declared = std::any_of(
          declared_.begin(), declared_.end(),
          [&](const DeclaredParameter &p) { return p.name == entry.name; });
      if (is_declared || refused_.count(entry.name) != 0)
        continue;
      if (++n_stray > most_told)
        return errors.error(location_,
                            fmt::format("{} has further entries that do not "
                                        "belong there",
                                        description()),
                            "the first of them are named");
      const std::vector<std::string> names = candidates(entry);
      const std::string meant = nearest_name(entry.name, names);
      if (missing_.count(meant) != 0)
        errors.withdraw(location_, missing_message(meant));
      errors.error(entry.name_location,
                   fmt::format("`{}` is not an entry of {} in this scene",
                               entry.name, description()),
                   did_you_mean_today(
                       entry.name, names, FormerWord::Place::entry, kind(), "",
                       valid.empty() ? "it has no entries"
                                     : fmt::format("it knows: {}",
                                                   fmt::join(valid, ", "))));
    }
  }

  std::string ParameterSection::print() const
  {
    // entries that are not set stand there as comments, ready to be used
    const auto left_side = [](const DeclaredParameter &parameter) {
      return (parameter.is_set ? "set " : "# set ") + parameter.name;
    };
    std::size_t left_width = 0, value_width = 0;
    constexpr std::size_t widest_value = 32;
    for (const DeclaredParameter &parameter : declared_) {
      left_width = std::max(left_width, left_side(parameter).size());
      value_width =
          std::max(value_width, std::min(parameter.value.size(), widest_value));
    }

    const std::string indent = name_.empty() ? "" : "  ";
    std::string result;
    if (!name_.empty())
      result += "subsection " + name_ + "\n";
    for (const DeclaredParameter &parameter : declared_) {
      std::string line =
          fmt::format("{}{:<{}} = {:<{}}", indent, left_side(parameter),
                      left_width, parameter.value, value_width);
      if (!parameter.text.empty())
        line += " # " + parameter.text;
      line.erase(line.find_last_not_of(' ') + 1);
      result += line + "\n";
    }
    if (!name_.empty())
      result += "end\n";
    return result;
  }

  ParameterFile::ParameterFile()
  {
    sections_.push_back(
        std::make_unique<ParameterSection>("", SourceLocation(), constants_));
    opened_.push_back(sections_.front().get());
  }

  ParameterSection &ParameterFile::add(const std::string &name,
                                       const SourceLocation &location)
  {
    sections_.push_back(
        std::make_unique<ParameterSection>(name, location, constants_));
    return *sections_.back();
  }

  ParameterSection *ParameterFile::find(const std::string &name) const
  {
    for (const auto &section : sections_)
      if (section->name() == name)
        return section.get();
    return nullptr;
  }

  bool ParameterFile::has_section(const std::string &name) const
  {
    return find(name) != nullptr;
  }

  ParameterSection &ParameterFile::open(const std::string &name)
  {
    ParameterSection *section = find(name);
    if (section == nullptr)
      section = &add(name, {location().source, 0, 0, 0, ""});
    if (std::find(opened_.begin(), opened_.end(), section) == opened_.end())
      opened_.push_back(section);
    return *section;
  }

  std::vector<ParameterSection *>
  ParameterFile::open_blocks(const std::string &kind)
  {
    std::vector<ParameterSection *> result;
    for (ParameterSection *section : sections())
      if (section->kind() == kind && !section->block_name().empty())
        result.push_back(&open(section->name()));
    return result;
  }

  std::vector<ParameterSection *> ParameterFile::sections() const
  {
    std::vector<ParameterSection *> result;
    for (std::size_t i = 1; i < sections_.size(); ++i)
      result.push_back(sections_[i].get());
    return result;
  }

  void ParameterFile::report_stray(InputErrors &errors) const
  {
    for (const ParameterSection *section : opened_)
      section->report_stray(errors);
  }

  std::string ParameterFile::print() const
  {
    std::string result;
    for (const std::string &line : opening_comment_)
      result += line + "\n";
    for (const ParameterSection *section : opened_)
      result += (result.empty() ? "" : "\n") + section->print();
    return result;
  }

  void ParameterFile::set_opening_comment(std::vector<std::string> lines)
  {
    opening_comment_ = std::move(lines);
  }

  void
  ParameterFile::override_entry(const std::string &assignment,
                                const std::vector<std::string> &known_kinds,
                                InputErrors &errors, const std::string &file)
  {
    const auto text_in = [&assignment](const std::string &place) {
      return SourceText(assignment,
                        {place, 0, 0, unsigned(assignment.size()), assignment});
    };
    const SourceText source = text_in(command_line);
    if (assignment.size() > text_limits::line)
      return errors.error({command_line, 0, 0, 0, ""},
                          fmt::format("`{}...` has {} bytes, more than {}",
                                      assignment.substr(0, 40),
                                      assignment.size(), text_limits::line),
                          "tables of numbers belong into files");
    if (find_non_utf8(assignment) != std::string::npos)
      return errors.error({command_line, 0, 0, 0, ""},
                          "a value of --set is not UTF-8",
                          "write ASCII letters, or use a terminal of UTF-8");
    const std::size_t equals = assignment.find('=');
    // names of blocks may hold a slash, names of entries do not
    const std::size_t slash = equals == std::string::npos || equals == 0
                                  ? std::string::npos
                                  : assignment.rfind('/', equals - 1);
    const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
    if (equals == std::string::npos ||
        source.part(begin, equals - begin).empty())
      return errors.error(source.location(),
                          fmt::format("`{}` assigns nothing", assignment),
                          "write for example: --set 'Time/theta=0.5'");
    if (assignment.find_first_of("#\n") != std::string::npos ||
        assignment.back() == '\\')
      return errors.error(source.location(),
                          "a value cannot hold a comment or several lines",
                          "leave out `#`, line ends and a closing backslash");

    const std::string section_name =
        slash == std::string::npos
            ? ""
            : canonical_section_name(assignment.substr(0, slash));
    ParameterSection *section = find(section_name);
    if (section == nullptr) {
      const std::string kind = section_name.substr(0, section_name.find(':'));
      if (std::find(known_kinds.begin(), known_kinds.end(), kind) ==
          known_kinds.end()) {
        std::vector<std::string> names = known_kinds;
        for (const ParameterSection *other : sections())
          names.push_back(other->name());
        return errors.error(
            source.part(0, slash).location(),
            fmt::format("there is no section `{}`", section_name),
            did_you_mean(section_name, names));
      }
      section = &add(section_name, source.location());
    }

    const SourceText name = source.part(begin, equals - begin);
    ParameterEntry entry = in_todays_words(
        section->kind(),
        {collapse_blanks(name.text()),
         text_in(file.empty() ? command_line : file).part(equals + 1),
         name.location()},
        errors);
    if (!overridden_.insert(section_name + "/" + entry.name).second)
      return errors.error(
          name.location(),
          fmt::format("`{}` is set twice on the command line", entry.name),
          "keep one of the two");
    section->assign(std::move(entry));
  }
} // namespace nsfd
