#pragma once

#include "input_errors.h"
#include "quantity.h"

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Text of the input in which every character knows its line and column,
   * also where continued lines were joined.
   */
  class SourceText
  {
  public:
    SourceText() = default;

    /** All of @p text comes from one line, starting at its column. */
    SourceText(std::string text, SourceLocation start);

    const std::string &text() const { return text_; }
    bool empty() const { return text_.empty(); }

    /** Where @p length bytes from @p offset are; they end with the line. */
    SourceLocation locate(std::size_t offset, std::size_t length) const;

    /** The whole text, or its first line if it was continued. */
    SourceLocation location() const { return locate(0, text_.size()); }

    /** A part of it, without blanks at its ends. */
    SourceText part(std::size_t offset,
                    std::size_t length = std::string::npos) const;

    /** Parts between the separators that stand outside of brackets. */
    std::vector<SourceText> split(char separator) const;

    /** Join the next line with one blank in between. */
    void append(const SourceText &next);

  private:
    struct Piece {
      std::size_t offset;   ///< in the joined text
      SourceLocation start; ///< of its first character
    };
    std::string text_;
    std::vector<Piece> pieces_;
  };

  /** `set NAME = VALUE`. */
  struct ParameterEntry {
    std::string name; ///< runs of blanks are one blank
    SourceText value;
    SourceLocation name_location;
  };

  /** The entry in today's words, with a note where that changed it. */
  ParameterEntry in_todays_words(const std::string &section_kind,
                                 ParameterEntry entry, InputErrors &errors);

  /** What a reader made known about an entry, for the echo. */
  struct DeclaredParameter {
    std::string name, value, text;
    bool is_set = true; ///< false: may be given, but has no default
  };

  /**
   * One section: the entries of the file, and what readers declared. An entry
   * that nobody declared is stray.
   */
  class ParameterSection
  {
  public:
    ParameterSection(std::string name, SourceLocation location,
                     const Constants &constants);

    const std::string &name() const { return name_; }

    /** "Interface" of "Interface: midline". */
    std::string kind() const;

    /** "midline" of "Interface: midline", else "". */
    std::string block_name() const;

    /** "section `Mesh`", or "the top level". */
    std::string description() const;

    const SourceLocation &location() const { return location_; }
    void set_location(const SourceLocation &location) { location_ = location; }
    const Constants &constants() const { return constants_; }
    const std::vector<ParameterEntry> &entries() const { return entries_; }

    /** The entry if the file or --set gives it, else null. */
    const ParameterEntry *find(const std::string &name) const;

    /** Add an entry, or replace the one of this name. */
    void assign(ParameterEntry entry);

    /** Make an entry known; a second declaration changes nothing. */
    void declare(DeclaredParameter parameter);

    /** A name worth suggesting, though nobody declares it. */
    void mention(const std::string &name) { mentioned_.insert(name); }

    /** The entry does not belong here, and this has been reported. */
    void refuse(const std::string &name) { refused_.insert(name); }

    /** Do not look for stray entries: what belongs here is unknown. */
    void accept_everything() { accepts_everything_ = true; }

    /** An entry that must be given is not there. */
    void report_missing(const std::string &name, const std::string &advice,
                        InputErrors &errors);

    /**
     * Report entries that nobody declared. If one is a misspelt name of a
     * missing entry, that is the only error.
     */
    void report_stray(InputErrors &errors) const;

    /** The section as it stands in a file, comments aligned. */
    std::string print() const;

  private:
    std::string name_;
    SourceLocation location_;
    const Constants &constants_;
    std::vector<ParameterEntry> entries_;
    std::map<std::string, std::size_t> entry_of_; ///< by name
    std::vector<DeclaredParameter> declared_;
    std::set<std::string> mentioned_, refused_, missing_;
    bool accepts_everything_ = false;

    std::string missing_message(const std::string &name) const;
  };

  /**
   * A parameter file in the syntax of deal.II: `subsection NAME`, `set NAME =
   * VALUE`, `end`, comments after `#`, continued lines after `\`, `include
   * FILE` (relative to the including file). Sections are not nested; a section
   * "Kind: name" is a named block.
   */
  class ParameterFile
  {
  public:
    ParameterFile();
    ParameterFile(const ParameterFile &) = delete;
    ParameterFile &operator=(const ParameterFile &) = delete;

    /**
     * Never throws: what is wrong goes into @p errors.
     * @return false if there is nothing to read, only an error.
     */
    bool read_file(const std::string &file, InputErrors &errors);

    /** As read_file(), for text that messages call @p source. */
    void read_text(const std::string &text, const std::string &source,
                   InputErrors &errors);

    /**
     * `Section/name=value` of the option --set, `name=value` at the top.
     * Replaces the value of the file, or adds to it; sections whose kind is
     * not in @p known_kinds cannot be created. Paths of files in the value
     * start at the folder of @p file, if that is where the value stands.
     */
    void override_entry(const std::string &assignment,
                        const std::vector<std::string> &known_kinds,
                        InputErrors &errors, const std::string &file = "");

    /** Entries outside all sections. */
    ParameterSection &top() { return *sections_.front(); }

    /**
     * A section, to be read and to appear in the echo from now on; an empty
     * one if the file has none.
     */
    ParameterSection &open(const std::string &name);

    /** True if the file or --set has this section. */
    bool has_section(const std::string &name) const;

    /** Named blocks of one kind, in the order of the file, all opened. */
    std::vector<ParameterSection *> open_blocks(const std::string &kind);

    /** All sections but the top. */
    std::vector<ParameterSection *> sections() const;

    /** A section of the file or --set, not opened; null if there is none. */
    ParameterSection *find(const std::string &name) const;

    /** Add a section; the caller has checked that there is none. */
    ParameterSection &add(const std::string &name,
                          const SourceLocation &location);

    /** Stray entries of all sections that were opened. */
    void report_stray(InputErrors &errors) const;

    /** All opened sections with everything that was declared. */
    std::string print() const;

    /** Named numbers, which every value may use. */
    Constants &constants() { return constants_; }

    /** The comment lines that open the file, with their `#`. */
    const std::vector<std::string> &opening_comment() const
    {
      return opening_comment_;
    }
    void set_opening_comment(std::vector<std::string> lines);

    /** The place to blame for what is missing altogether. */
    const SourceLocation &location() const { return top().location(); }

  private:
    const ParameterSection &top() const { return *sections_.front(); }

    Constants constants_;
    std::vector<std::unique_ptr<ParameterSection>> sections_;
    std::vector<ParameterSection *> opened_;
    std::set<std::string> overridden_;
    std::vector<std::string> opening_comment_;
  };

  /** Blanks at the ends removed, runs of them made one. */
  std::string collapse_blanks(const std::string &text);

  /** "Interface :  midline" -> "Interface: midline". */
  std::string canonical_section_name(const std::string &name);
} // namespace nsfd
