#pragma once

#include "certificate.h"

#include <fmt/format.h>

namespace nsfd
{
  inline CertificateLine::Verdict within(const bool holds)
  {
    return holds ? CertificateLine::Verdict::ok : CertificateLine::Verdict::bad;
  }

  inline CertificateLine unmeasured_line(const std::string &name,
                                         const std::string &remark)
  {
    CertificateLine line;
    line.name = name;
    line.remark = remark;
    return line;
  }

  inline CertificateLine no_line(const std::string &name,
                                 const std::string &remark)
  {
    CertificateLine line = unmeasured_line(name, remark);
    line.verdict = CertificateLine::Verdict::none;
    return line;
  }

  /**
   * Number and limit of @p line as @p print gives them, with @p digits or,
   * where it is bad, as many more as tell them apart.
   */
  template <typename Print>
  void print_both(CertificateLine &line, unsigned int digits,
                  const char *relation, const Print &print)
  {
    std::string limit;
    do {
      line.value = print(*line.number, digits);
      limit = print(*line.limit, digits);
    } while (line.verdict == CertificateLine::Verdict::bad &&
             line.value == limit && *line.number != *line.limit &&
             ++digits < 17);
    line.bound = relation + limit;
  }

  /** The same, of @p factor times both; @p format begins with `{:.` and one
      digit. */
  inline void print_both(CertificateLine &line, const std::string &format,
                         const char *relation, const double factor = 1.)
  {
    print_both(
        line, unsigned(format[3] - '0'), relation,
        [&](const double value, const unsigned int digits) {
          return fmt::format(
              fmt::runtime("{:." + std::to_string(digits) + format.substr(4)),
              factor * value);
        });
  }

  /** With @p verdict: NaN is never within a bound. */
  inline CertificateLine line_of(const std::string &name, const double number,
                                 const double limit,
                                 const CertificateLine::Verdict verdict,
                                 const std::string &format = "{:.1e}",
                                 const char *relation = "at most ")
  {
    CertificateLine line;
    line.name = name;
    line.number = number;
    line.limit = limit;
    line.verdict = verdict;
    print_both(line, format, relation);
    return line;
  }

  /** One line for each assumption that the run makes. */
  void add_motion_limits(const RunFacts &facts,
                         std::vector<CertificateLine> &lines);
} // namespace nsfd
