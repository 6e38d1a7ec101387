#pragma once

#include <string>

namespace nsfd
{
  /** 12 480 with a narrow space. */
  std::string count(double value);

  /** "1 step", "2 steps" */
  std::string count(double n, const std::string &noun);

  /** A key of summary.json as words. */
  std::string readable(std::string key);

  /** A relative quantity. */
  std::string relative(double value);

  std::string percent(double share);

  enum class CardVerdict { none, good, bad };

  /** A table of one line per quantity: name, value, remark. */
  class Table
  {
  public:
    void add(const std::string &name, const std::string &value,
             const std::string &remark = "",
             CardVerdict verdict = CardVerdict::none);
    /** A row of five: name, value, bound, verdict in words, remark. */
    void add_judged(const std::string &name, const std::string &value,
                    const std::string &bound, const std::string &verdict,
                    CardVerdict kind, const std::string &remark);
    void add_sum(const std::string &name, const std::string &value);
    void add_group(const std::string &name);
    /** A bar of @p share of the width next to the value. */
    void add_share(const std::string &name, const std::string &value,
                   double share);
    /** Nothing if there is no text. */
    void add_text(const std::string &name, const std::string &text);

    /** Nothing if there is no line. */
    std::string card(const std::string &title) const;

  private:
    std::string rows_;
  };

  std::string section(const std::string &title, const std::string &content);
  std::string columns_of(const std::string &cards);
  std::string row_of(const std::string &cards);

  /** Paragraphs are separated by empty lines. */
  std::string paragraphs(const std::string &text);

  /** The whole page around its content. */
  std::string page(const std::string &title, const std::string &content);
} // namespace nsfd
