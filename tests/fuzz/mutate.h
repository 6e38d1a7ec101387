#pragma once

#include <random>
#include <string>
#include <vector>

namespace nsfd::fuzz
{
  using Random = std::mt19937_64;

  /** Below @p n, the same on every machine (std distributions are not). */
  std::size_t below(Random &random, std::size_t n);

  struct Mutant {
    std::string content;
    std::string done; ///< the mutations, for the list of failures
  };

  /**
   * One to three changes of a text of entries and values: bytes, lines, empty
   * entries, extreme numbers, formulas, nesting, long words, a cut end, bytes
   * that are no UTF-8, lines of @p others.
   */
  Mutant mutate_text(const std::string &text,
                     const std::vector<std::string> &others, Random &random);

  /** One to three changes of bytes: flips, extreme words, holes, a cut end. */
  Mutant mutate_bytes(const std::string &bytes, Random &random);

  /** A number that no scene should have, or a word in its place. */
  std::string extreme_value(Random &random);
} // namespace nsfd::fuzz
