#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** Parameters that vary together: the i-th case takes the i-th value of all.
   */
  struct Variation {
    struct Parameter {
      std::string path;                ///< "Mesh/cells"
      std::vector<std::string> values; ///< as a parameter file would write them
      std::string file = {}; ///< that gives them; empty: the command line
    };
    std::string
        name; ///< of its block, or the short name of its first parameter
    std::vector<Parameter> parameters;

    /** Number of values. */
    std::size_t size() const;
    /** A single value: the same in every case. */
    bool is_constant() const { return size() < 2; }
    /** The first parameter with several values; the first one if none has. */
    const Parameter &leader() const;
    /** Value @p i of a parameter; a single one serves all. */
    static const std::string &value(const Parameter &parameter, std::size_t i);
  };

  /** "cells" of "Mesh/cells". */
  std::string short_name(const std::string &path);

  /**
   * The values in a text: separated by commas outside of brackets, or by `;` if
   * there is one; brackets around a whole value are taken off. Ranges of
   * integers, in the middle of a value as well:
   *
   *     1..4            1, 2, 3, 4
   *     10..50 by 20    10, 30, 50
   *     10*2^0..3       10, 20, 40, 80
   *     0.4/2^0..2 us   0.4 us, 0.2 us, 0.1 us
   *     [8*2^0..1, 1]   8, 1 and 16, 1
   *
   * Ranges of one value go together. @p problem says what is wrong, else it is
   * empty.
   */
  std::vector<std::string> expand_values(const std::string &text,
                                         std::string &problem);

  /**
   * `Section/name=values`, or several of them joined by `&`, which vary
   * together. Empty, with a @p problem, if that is not what it says.
   */
  std::optional<Variation> parse_variation(const std::string &text,
                                           std::string &problem);

  /** Not empty if the parameters of one variation do not fit together. */
  std::string problem_of(const Variation &variation);

  /** One setting of all parameters. */
  struct Combination {
    std::string name;               ///< of its folder: letters, digits, =_-+.
    std::vector<std::size_t> index; ///< value of each variation
    std::vector<std::pair<std::string, std::string>>
        parameters; ///< path, value
  };

  /** The first variation changes slowest. Names are unique. */
  std::vector<Combination> combine(const std::vector<Variation> &variations);
} // namespace nsfd
