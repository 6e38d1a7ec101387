#pragma once

#include <deal.II/base/exceptions.h>

#include <exception>
#include <sstream>
#include <string>

namespace nsfd
{
  /** What deal.II says of an error, as one line. */
  inline std::string deal_ii_message(const std::exception &exception)
  {
    std::ostringstream out;
    if (const auto *error =
            dynamic_cast<const dealii::ExceptionBase *>(&exception))
      error->print_info(out);
    else
      out << exception.what();
    std::istringstream words(out.str());
    std::string result, word;
    while (words >> word)
      result += (result.empty() ? "" : " ") + word;
    return result;
  }
} // namespace nsfd
