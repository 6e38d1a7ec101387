#include "read_sections.h"

#include "parameters/formula.h"
#include "parameters/text_file.h"

#include <fmt/format.h>

#include <cctype>

namespace nsfd
{
  namespace
  {
    bool is_identifier(const std::string &name)
    {
      if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])))
        return false;
      for (const char c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_')
          return false;
      return true;
    }

    void check_name(const ParameterEntry &entry, InputErrors &errors)
    {
      if (is_formula_word(entry.name))
        errors.error(entry.name_location,
                     fmt::format("`{}` has a meaning in every formula and "
                                 "cannot be a constant",
                                 entry.name),
                     "give it another name");
      else if (!is_identifier(entry.name))
        errors.error(
            entry.name_location,
            fmt::format("`{}` cannot be the name of a constant", entry.name),
            "use letters, digits and _, and no digit in front");
    }
  } // namespace

  void read_constants(ParameterFile &file, InputErrors &errors)
  {
    if (!file.has_section("Constants"))
      return;
    ParameterSection &section = file.open("Constants");
    SectionReader reader(section, errors);
    for (const ParameterEntry &entry : section.entries()) {
      check_name(entry, errors);
      if (section.entries().size() > text_limits::constants)
        return reader.error(
            "",
            fmt::format("section `Constants` has {} entries, more than {}",
                        section.entries().size(), text_limits::constants),
            "keep those that are used");
      const auto value = reader.raw(entry.name, "", "", "3 um");
      // after an error, a number that fits everywhere: no further errors
      Constant constant;
      constant.value = 1.;
      if (value) {
        // any unit will do here, so ask for the one that it has
        Formula formula = compile_formula(value->text(), units::none,
                                          section.constants(), false);
        if (formula.unit)
          formula = compile_formula(value->text(), *formula.unit,
                                    section.constants(), false);
        if (formula.error)
          errors.error(
              value->locate(formula.error->offset, formula.error->length),
              fmt::format("{} = {}: {}", entry.name, value->text(),
                          formula.error->message),
              formula.error->advice);
        else {
          constant.value = *formula.constant;
          constant.unit =
              formula.unit.value_or(formula.likely_unit.value_or(units::none));
          constant.bare = !formula.unit && !formula.likely_unit;
          constant.mixed = formula.likely_unit.has_value();
        }
      }
      file.constants()[entry.name] = constant;
    }
  }
} // namespace nsfd
