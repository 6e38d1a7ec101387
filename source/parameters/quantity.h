#pragma once

#include "nsfd/parameters/section_reader.h"

#include "place_fields.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  bool operator==(const Unit &a, const Unit &b);
  bool operator!=(const Unit &a, const Unit &b);
  Unit operator*(const Unit &a, const Unit &b);
  Unit operator/(const Unit &a, const Unit &b);
  Unit power(const Unit &base, int exponent);

  /**
   * What one of a named unit is in SI: `factor * 10^exponent` of `unit`. The
   * power of ten is kept apart so that `5 um` is exactly the double 5e-6.
   */
  struct UnitScale {
    Unit unit;
    int exponent = 0;
    double factor = 1.;
  };

  UnitScale operator*(const UnitScale &a, const UnitScale &b);
  UnitScale power(const UnitScale &base, int exponent);

  /**
   * A single unit with its prefix: `um`, `GPa`, `kg`, `ms`, `min`, `h`, `Hz`.
   * Both signs for micro are known, the letter mu and `u`. Empty if there is
   * no such unit.
   */
  std::optional<UnitScale> find_unit(const std::string &symbol);

  /** All symbols that find_unit() knows. */
  const std::vector<std::string> &unit_symbols();

  /**
   * The value of a number times a unit: @p digits is a decimal number as
   * written. Empty if it does not fit into a double.
   */
  std::optional<double> scaled_number(const std::string &digits,
                                      const UnitScale &scale);

  /** "a pressure", "a time", "a plain number", or "in kg^2 m". */
  std::string describe(const Unit &unit);

  /** What a value of this kind looks like: "135 GPa". May be empty. */
  std::string example(const Unit &unit);

  /** What a formula calls by a name: a number of the section `Constants`, or
      cell data of the mesh. */
  struct Constant {
    double value = 0.;
    Unit unit;
    /// written without any unit: fits every dimension
    bool bare = true;
    /// a formula of numbers with and without: `unit` is that of the former
    bool mixed = false;
    /// cell data: the place gives the number; `value` means nothing
    std::shared_ptr<const PlaceFields> fields;
    std::size_t field = 0; ///< of `fields`
    std::string refusal;   ///< why it cannot be used here; empty if it can
  };
  using Constants = std::map<std::string, Constant>;
} // namespace nsfd
