#pragma once

#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/parameters/section_reader.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"

#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  namespace test
  {
    /** Names and values as written in a parameter file. */
    using LawEntries = std::vector<std::pair<std::string, std::string>>;

    /** The entries of an example, "strength = 3 MPa; toughness = 4 J/m^2". */
    inline LawEntries entries_of(const std::string &example)
    {
      LawEntries entries;
      std::istringstream parts(example);
      for (std::string part; std::getline(parts, part, ';');) {
        const std::size_t equals = part.find('=');
        if (equals == std::string::npos)
          throw std::invalid_argument("no `=` in the example `" + part + "`");
        entries.emplace_back(part.substr(0, equals), part.substr(equals + 1));
      }
      return entries;
    }

    /** Build a law as a scene does; what is wrong goes into @p errors. */
    inline std::unique_ptr<CohesiveLaw> read_law(const std::string &name,
                                                 const LawEntries &entries,
                                                 InputErrors &errors)
    {
      std::string text = "subsection Interface: test\n";
      for (const auto &[entry, value] : entries)
        text += "  set " + entry + " = " + value + "\n";
      text += "end\n";

      ParameterFile file;
      file.read_text(text, "test.prm", errors);
      SectionReader reader(file.open("Interface: test"), errors);
      auto law = CohesiveLawRegistry::instance().create(name, reader);
      file.report_stray(errors);
      return law;
    }

    /** The law of this name with these entries, which must be right. */
    inline std::unique_ptr<CohesiveLaw> make_law(const std::string &name,
                                                 const LawEntries &entries)
    {
      InputErrors errors;
      auto law = read_law(name, entries, errors);
      if (errors.has_errors())
        throw std::invalid_argument(errors.report());
      return law;
    }

    /** What is reported about wrong entries; empty if they are right. */
    inline std::string law_errors(const std::string &name,
                                  const LawEntries &entries)
    {
      InputErrors errors;
      read_law(name, entries, errors);
      return errors.report();
    }
  } // namespace test
} // namespace nsfd
