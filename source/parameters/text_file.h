#pragma once

#include <cstddef>
#include <string>

namespace nsfd
{
  /** What a text file of the input may be; beyond it lies no scene. */
  namespace text_limits
  {
    constexpr std::size_t parameter_file = 4u << 20; ///< bytes
    constexpr std::size_t table = 64u << 20;         ///< bytes, of numbers
    constexpr std::size_t line = 20000;              ///< bytes
    constexpr std::size_t statements = 20000;
    constexpr std::size_t constants = 1000;
    constexpr std::size_t name = 80; ///< bytes; names become names of files
  }                                  // namespace text_limits

  /** The content of a text file, or why there is none. */
  struct TextFile {
    std::string content;
    std::string problem; ///< "is a folder", follows the name; empty: none
    std::string advice;
    unsigned int line = 0; ///< of the problem, from 1; 0: the whole file
  };

  /**
   * Read a file of at most @p most_bytes of UTF-8. Only regular files are
   * opened: a pipe or a device may have no end. Never throws.
   */
  TextFile read_text_file(const std::string &path, std::size_t most_bytes);

  /** Offset of the first byte that is no UTF-8; npos if there is none. */
  std::size_t find_non_utf8(const std::string &text);
} // namespace nsfd
