#include "markup.h"

namespace nsfd
{
  std::string escape_markup(const std::string &text)
  {
    std::string result;
    result.reserve(text.size());
    for (const char c : text)
      switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        // control characters are not allowed in XML
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t')
          result += c;
      }
    return result;
  }
} // namespace nsfd
