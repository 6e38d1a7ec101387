#include "quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace nsfd
{
  namespace
  {
    struct KnownUnit {
      const char *symbol;
      UnitScale scale;
      bool takes_prefix;
    };

    // the gram carries the prefixes, the kilogram is the base
    const KnownUnit known_units[] = {
        {"m", {units::length, 0, 1.}, true},
        {"s", {units::time, 0, 1.}, true},
        {"g", {units::mass, -3, 1.}, true},
        {"Pa", {units::pressure, 0, 1.}, true},
        {"N", {{1, 1, -2}, 0, 1.}, true},
        {"J", {{1, 2, -2}, 0, 1.}, true},
        {"Hz", {{0, 0, -1}, 0, 1.}, true},
        {"W", {{1, 2, -3}, 0, 1.}, true},
        {"K", {units::temperature, 0, 1.}, true},
        {"min", {units::time, 0, 60.}, false},
        {"h", {units::time, 0, 3600.}, false},
    };

    struct Prefix {
      const char *symbol;
      int exponent;
    };

    // those that reports print, and centi
    const Prefix prefixes[] = {{"f", -15}, {"p", -12},     {"n", -9},
                               {"u", -6},  {"\u00b5", -6}, {"\u03bc", -6},
                               {"m", -3},  {"c", -2},      {"k", 3},
                               {"M", 6},   {"G", 9},       {"T", 12}};

    const std::map<std::string, UnitScale> &unit_table()
    {
      static const std::map<std::string, UnitScale> table = [] {
        std::map<std::string, UnitScale> result;
        for (const KnownUnit &known : known_units) {
          result.emplace(known.symbol, known.scale);
          if (!known.takes_prefix)
            continue;
          for (const Prefix &prefix : prefixes) {
            UnitScale scale = known.scale;
            scale.exponent += prefix.exponent;
            result.emplace(std::string(prefix.symbol) + known.symbol, scale);
          }
        }
        return result;
      }();
      return table;
    }

    struct UnitName {
      Unit unit;
      const char *name, *example;
    };

    // J/m^2 = N/m and Pa/m = N/m^3 cannot be told apart
    const UnitName unit_names[] = {
        {units::none, "a plain number", "0.5"},
        {units::length, "a length", "10 um"},
        {units::time, "a time", "10 ns"},
        {units::mass, "a mass", "2 kg"},
        {units::velocity, "a velocity", "2 m/s"},
        {units::acceleration, "an acceleration", "-9.81 m/s^2"},
        {units::density, "a density", "7800 kg/m^3"},
        {units::pressure, "a pressure", "135 GPa"},
        {units::energy_per_area, "an energy per area", "0.5 J/m^2"},
        {units::stiffness_per_area, "a pressure per length", "10 GPa/um"},
        {units::viscosity, "a viscosity", "10 kPa*s"},
        {units::viscosity_per_length, "a pressure per velocity", "1 MPa*s/m"},
        {units::damage_viscosity, "an energy per area times a time",
         "1 uJ/m^2*s"},
        {units::wear_coefficient, "one over a pressure", "1e-6 1/MPa"},
        {units::mass_per_area, "a mass per area", "1.25 kg/m^2"},
        {units::mass_per_length, "a mass per length", "2 kg/m"},
        {units::inertia, "a moment of inertia", "0.1 kg*m^2"},
        {units::inertia_per_length, "a moment of inertia per length",
         "0.1 kg*m^2/m"},
        {units::temperature, "a temperature", "293 K"},
        {units::heat_capacity, "an energy per mass and kelvin", "500 J/kg/K"},
        {units::conductivity, "a thermal conductivity", "50 W/m/K"},
        {units::conductance, "a power per area and kelvin", "10 kW/m^2/K"},
        {units::heat_flux, "a power per area", "10 kW/m^2"},
        {{1, 1, -2}, "a force", ""},
        {{1, 2, -2}, "an energy", ""},
        {{0, 0, -1}, "a frequency", "1 1/s"},
        {{0, 2, 0}, "an area", ""},
        {{0, 3, 0}, "a volume", ""},
    };
  } // namespace

  bool operator==(const Unit &a, const Unit &b)
  {
    return a.kilogram == b.kilogram && a.metre == b.metre &&
           a.second == b.second && a.kelvin == b.kelvin;
  }

  bool operator!=(const Unit &a, const Unit &b) { return !(a == b); }

  Unit operator*(const Unit &a, const Unit &b)
  {
    return {a.kilogram + b.kilogram, a.metre + b.metre, a.second + b.second,
            a.kelvin + b.kelvin};
  }

  Unit operator/(const Unit &a, const Unit &b) { return a * power(b, -1); }

  Unit power(const Unit &base, const int exponent)
  {
    return {base.kilogram * exponent, base.metre * exponent,
            base.second * exponent, base.kelvin * exponent};
  }

  UnitScale operator*(const UnitScale &a, const UnitScale &b)
  {
    return {a.unit * b.unit, a.exponent + b.exponent, a.factor * b.factor};
  }

  UnitScale power(const UnitScale &base, const int exponent)
  {
    return {power(base.unit, exponent), base.exponent * exponent,
            std::pow(base.factor, exponent)};
  }

  std::optional<UnitScale> find_unit(const std::string &symbol)
  {
    const auto found = unit_table().find(symbol);
    if (found == unit_table().end())
      return {};
    return found->second;
  }

  const std::vector<std::string> &unit_symbols()
  {
    static const std::vector<std::string> symbols = [] {
      std::vector<std::string> result;
      for (const auto &entry : unit_table())
        result.push_back(entry.first);
      return result;
    }();
    return symbols;
  }

  std::optional<double> scaled_number(const std::string &digits,
                                      const UnitScale &scale)
  {
    // shift the decimal exponent in the text: one rounding only
    const std::size_t mark = digits.find_first_of("eE");
    int exponent = scale.exponent;
    if (mark != std::string::npos)
      exponent += std::clamp(std::atoi(digits.c_str() + mark + 1), -9999, 9999);
    const std::string shifted =
        digits.substr(0, mark) + "e" + std::to_string(exponent);

    double value = 0.;
    const char *const end = shifted.data() + shifted.size();
    const auto result = std::from_chars(shifted.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end)
      return {};
    value *= scale.factor;
    if (!std::isfinite(value))
      return {};
    return value;
  }

  std::string describe(const Unit &unit)
  {
    for (const UnitName &name : unit_names)
      if (name.unit == unit)
        return name.name;

    std::string result = "in";
    const auto append = [&result](const char *symbol, const int exponent) {
      if (exponent == 1)
        result += fmt::format(" {}", symbol);
      else if (exponent != 0)
        result += fmt::format(" {}^{}", symbol, exponent);
    };
    append("kg", unit.kilogram);
    append("m", unit.metre);
    append("s", unit.second);
    append("K", unit.kelvin);
    return result;
  }

  std::string example(const Unit &unit)
  {
    for (const UnitName &name : unit_names)
      if (name.unit == unit)
        return name.example;
    return "";
  }
} // namespace nsfd
