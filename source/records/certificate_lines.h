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
    line.value = fmt::format(fmt::runtime(format), number);
    line.bound = relation + fmt::format(fmt::runtime(format), limit);
    line.verdict = verdict;
    return line;
  }

  /** One line for each assumption that the run makes. */
  void add_motion_limits(const RunFacts &facts,
                         std::vector<CertificateLine> &lines);
} // namespace nsfd
