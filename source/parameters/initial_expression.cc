#include "nsfd/parameters/initial_expression.h"

#include <fmt/format.h>

namespace nsfd
{
  Expression read_initial_expression(SectionReader &reader,
                                     const std::string &name,
                                     const std::string &default_text,
                                     const Unit unit, const std::string &text)
  {
    const Expression expression =
        reader.expression(name, default_text, unit, text);
    if (expression.depends_on_time())
      reader.error(name,
                   fmt::format("{} = {} depends on t, but is read once, before "
                               "the first step",
                               name, expression.text()),
                   "write an expression of x, y, z");
    return expression;
  }
} // namespace nsfd
