#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace nsfd::vtk
{
  /** What is wrong with the values of an array. */
  struct BadBytes : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  /** How a file of the XML format writes its numbers. */
  struct Encoding {
    std::size_t header_size = 4; ///< bytes of the numbers before each array
    bool is_big_endian = false;
    bool is_compressed = false; ///< by zlib
  };

  /** Memory that values may still take, of what there is for a file. */
  using Allowance = std::size_t;

  /**
   * The bytes of an array that begins at @p at of @p text, which is raw or
   * base64: header, then bytes or blocks of zlib. Throws BadBytes if they are
   * damaged, or if their values, of this type, take more than @p allowance,
   * which is reduced.
   */
  std::string bytes_of(const std::string &text, std::size_t at, bool is_base64,
                       const std::string &type, const Encoding &encoding,
                       Allowance &allowance);

  /** Numbers of a type such as `Float64` or `UInt8`. */
  std::vector<double> numbers_of(const std::string &bytes,
                                 const std::string &type, bool is_big_endian);

  /**
   * The number in the next word of @p text from @p at on, which goes behind
   * it; none if the word is no number. @p word has its first 40 characters,
   * none at the end of the text.
   */
  std::optional<double> next_number(const std::string &text, std::size_t &at,
                                    std::string &word);

  /** The same of numbers with blanks between them. */
  std::vector<double> numbers_of_text(const std::string &text,
                                      const std::string &type);
} // namespace nsfd::vtk
