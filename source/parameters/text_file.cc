#include "text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    /** Bytes of the character at @p at, 0 if they are no UTF-8. */
    std::size_t character_length(const std::string &text, const std::size_t at)
    {
      const auto byte = [&](const std::size_t i) -> unsigned int {
        return at + i < text.size() ? static_cast<unsigned char>(text[at + i])
                                    : 0u;
      };
      const unsigned int first = byte(0);
      const std::size_t length = first < 0x80             ? 1
                                 : (first & 0xe0) == 0xc0 ? 2
                                 : (first & 0xf0) == 0xe0 ? 3
                                 : (first & 0xf8) == 0xf0 ? 4
                                                          : 0;
      if (length < 2)
        return length;
      unsigned int code = first & (0x7fu >> length);
      for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0) != 0x80)
          return 0;
        code = code << 6 | (byte(i) & 0x3f);
      }
      // longer than needed, half of a pair of UTF-16, or beyond Unicode
      const unsigned int least[] = {0, 0, 0x80, 0x800, 0x10000};
      const bool is_half = code >= 0xd800 && code < 0xe000;
      return code < least[length] || is_half || code > 0x10ffff ? 0 : length;
    }

    std::string describe(const fs::file_status &status)
    {
      switch (status.type()) {
      case fs::file_type::not_found:
      case fs::file_type::none:
      case fs::file_type::unknown:
        return "cannot be read";
      case fs::file_type::directory:
        return "is a folder";
      case fs::file_type::fifo:
        return "is a pipe, not a file";
      case fs::file_type::socket:
        return "is a socket, not a file";
      default:
        return "is a device, not a file";
      }
    }

    std::string too_large(const std::size_t most_bytes)
    {
      return fmt::format("is larger than {} MiB, which no such file is",
                         most_bytes >> 20);
    }
  } // namespace

  std::size_t find_non_utf8(const std::string &text)
  {
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t length = character_length(text, at);
      if (length == 0)
        return at;
      at += length;
    }
    return std::string::npos;
  }

  TextFile read_text_file(const std::string &path, const std::size_t most_bytes)
  {
    TextFile file;
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::is_regular_file(status)) {
      file.problem = describe(status);
      file.advice = file.problem == "cannot be read"
                        ? "check the name and the folder you are in"
                        : "name a text file";
      return file;
    }
    const auto size = fs::file_size(path, failure);
    if (!failure && size > most_bytes) {
      file.problem = too_large(most_bytes);
      file.advice = "name a text file";
      return file;
    }

    std::ifstream stream(path, std::ios::binary);
    if (!stream) {
      file.problem = "cannot be read";
      file.advice = "check the name and the folder you are in";
      return file;
    }
    // files of the system have no size, but may have no end
    constexpr std::size_t portion = 1u << 16;
    while (stream && file.content.size() <= most_bytes) {
      const std::size_t old_size = file.content.size();
      file.content.resize(old_size + portion);
      stream.read(&file.content[old_size], portion);
      file.content.resize(old_size + std::size_t(stream.gcount()));
    }
    const std::size_t stray = file.content.find('\0');
    const std::size_t strange = find_non_utf8(file.content);
    if (file.content.size() > most_bytes) {
      file.problem = too_large(most_bytes);
      file.advice = "name a text file";
    } else if (stray != std::string::npos) {
      file.problem = "is not a text file";
      file.advice = "name a text file";
    } else if (strange != std::string::npos) {
      file.problem =
          fmt::format("is not UTF-8: the byte {:#04x} belongs to no character",
                      static_cast<unsigned int>(
                          static_cast<unsigned char>(file.content[strange])));
      file.advice = "save the file as UTF-8, or write ASCII letters";
      file.line =
          1 + unsigned(std::count(
                  file.content.begin(),
                  file.content.begin() + std::ptrdiff_t(strange), '\n'));
    }
    if (!file.problem.empty())
      file.content.clear();
    return file;
  }
} // namespace nsfd
