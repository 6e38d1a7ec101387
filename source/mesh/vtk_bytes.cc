#include "vtk_bytes.h"

#include <boost/archive/iterators/binary_from_base64.hpp>
#include <boost/archive/iterators/dataflow_exception.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>

namespace nsfd::vtk
{
  namespace
  {
    /** Of base64 without padding inside; @p text is whole groups of four. */
    std::string from_base64(std::string text)
    {
      using namespace boost::archive::iterators;
      using Bytes =
          transform_width<binary_from_base64<std::string::const_iterator>, 8,
                          6>;
      std::size_t n_padding = 0;
      while (n_padding < 2 && n_padding < text.size() &&
             text[text.size() - 1 - n_padding] == '=')
        ++n_padding;
      std::replace(text.end() - std::ptrdiff_t(n_padding), text.end(), '=',
                   'A');
      std::string bytes;
      bytes.reserve(text.size() / 4 * 3);
      try {
        const std::size_t n = text.size() / 4 * 3;
        Bytes at(text.cbegin());
        for (std::size_t i = 0; i < n; ++i, ++at)
          bytes += char(*at);
      } catch (const dataflow_exception &) {
        throw BadBytes("it is not base64");
      }
      bytes.resize(bytes.size() - n_padding);
      return bytes;
    }

    /** Bytes one after the other, of a text that is raw or base64. */
    class Source
    {
    public:
      Source(const std::string &text, const std::size_t at,
             const bool is_base64)
          : text_(text), at_(at), is_base64_(is_base64)
      {
      }

      /**
       * The next @p n bytes. Of base64, parts that were encoded each by itself
       * end with padding or with a group of four; what is behind @p n in the
       * last group is lost.
       */
      std::string take(const std::size_t n)
      {
        if (at_ > text_.size() || n > text_.size() - at_)
          throw BadBytes("it ends early");
        if (!is_base64_) {
          at_ += n;
          return text_.substr(at_ - n, n);
        }
        std::string bytes;
        while (bytes.size() < n) {
          std::size_t length = (n - bytes.size() + 2) / 3 * 4;
          const std::size_t padding = text_.find('=', at_);
          if (padding < at_ + length)
            length = (padding - at_) / 4 * 4 + 4;
          if (length > text_.size() - at_)
            throw BadBytes("it ends early");
          const std::string part = from_base64(text_.substr(at_, length));
          if (part.empty())
            throw BadBytes("it is not base64");
          bytes += part;
          at_ += length;
        }
        is_aligned_ = bytes.size() == n;
        bytes.resize(n);
        return bytes;
      }

      void rewind(const std::size_t at) { at_ = at; }

      /** The last bytes ended where the next ones begin. */
      bool is_aligned() const { return !is_base64_ || is_aligned_; }

    private:
      const std::string &text_;
      std::size_t at_;
      const bool is_base64_;
      bool is_aligned_ = true;
    };

    std::uint64_t natural(const char *bytes, const std::size_t size,
                          const bool is_big_endian)
    {
      std::uint64_t value = 0;
      for (std::size_t i = 0; i < size; ++i) {
        const std::size_t at = is_big_endian ? i : size - 1 - i;
        value = value << 8 | static_cast<unsigned char>(bytes[at]);
      }
      return value;
    }

    /** Of @p n bytes of numbers, each of which becomes a double. */
    void use(Allowance &allowance, const std::uint64_t n,
             const std::size_t size)
    {
      const std::uint64_t most = allowance / sizeof(double) * size;
      if (n > most)
        throw BadBytes("unpacked, the file is more than 200 times as large; "
                       "save it without compression if it is right");
      allowance -= n / size * sizeof(double);
    }

    std::string unpacked(Source &source, const std::string &text,
                         const std::size_t at, const std::size_t number_size,
                         const Encoding &encoding, Allowance &allowance)
    {
      const std::size_t size = encoding.header_size;
      const auto word = [&](const std::string &bytes, const std::size_t i) {
        return natural(bytes.data() + i * size, size, encoding.is_big_endian);
      };
      const std::string begin = source.take(3 * size);
      const std::uint64_t n_blocks = word(begin, 0), block = word(begin, 1),
                          last = word(begin, 2);
      if (n_blocks == 0)
        return "";
      if (n_blocks > text.size() || block > allowance || last > allowance)
        throw BadBytes("its header cannot be right");
      source.rewind(at);
      const std::string header = source.take((3 + n_blocks) * size);
      std::vector<std::uint64_t> packed(n_blocks);
      std::uint64_t sum = 0;
      for (std::size_t b = 0; b < n_blocks; ++b) {
        packed[b] = word(header, 3 + b);
        if (packed[b] > text.size())
          throw BadBytes("its header cannot be right");
        sum += packed[b];
      }
      const std::string all = source.take(sum);
      std::string result;
      for (std::size_t b = 0, from = 0; b < n_blocks; from += packed[b++]) {
        uLongf n = b + 1 < n_blocks || last == 0 ? block : last;
        use(allowance, n, number_size);
        const std::size_t before = result.size();
        result.resize(before + n);
        const uLongf expected = n;
        if (uncompress(reinterpret_cast<Bytef *>(&result[before]), &n,
                       reinterpret_cast<const Bytef *>(&all[from]),
                       packed[b]) != Z_OK ||
            n != expected)
          throw BadBytes("its block cannot be unpacked by zlib");
      }
      return result;
    }

    template <typename Number>
    double number_at(const char *bytes, const bool is_big_endian)
    {
      // through the bits, so that both orders are the same code
      const std::uint64_t bits = natural(bytes, sizeof(Number), is_big_endian);
      Number value;
      if constexpr (sizeof(Number) == 8)
        std::memcpy(&value, &bits, 8);
      else if constexpr (sizeof(Number) == 4) {
        const auto part = std::uint32_t(bits);
        std::memcpy(&value, &part, 4);
      } else if constexpr (sizeof(Number) == 2) {
        const auto part = std::uint16_t(bits);
        std::memcpy(&value, &part, 2);
      } else {
        const auto part = std::uint8_t(bits);
        std::memcpy(&value, &part, 1);
      }
      return double(value);
    }

    struct Type {
      std::size_t size;
      double (*read)(const char *, bool);
    };

    const std::map<std::string, Type> &types()
    {
      static const std::map<std::string, Type> all = {
          {"Int8", {1, number_at<std::int8_t>}},
          {"UInt8", {1, number_at<std::uint8_t>}},
          {"Int16", {2, number_at<std::int16_t>}},
          {"UInt16", {2, number_at<std::uint16_t>}},
          {"Int32", {4, number_at<std::int32_t>}},
          {"UInt32", {4, number_at<std::uint32_t>}},
          {"Int64", {8, number_at<std::int64_t>}},
          {"UInt64", {8, number_at<std::uint64_t>}},
          {"Float32", {4, number_at<float>}},
          {"Float64", {8, number_at<double>}}};
      return all;
    }
  } // namespace

  std::string bytes_of(const std::string &text, const std::size_t at,
                       const bool is_base64, const std::string &type,
                       const Encoding &encoding, Allowance &allowance)
  {
    const auto found = types().find(type);
    if (found == types().end())
      throw BadBytes(fmt::format("the type `{}` is not read", type));
    const std::size_t number_size = found->second.size;
    Source source(text, at, is_base64);
    if (encoding.is_compressed)
      return unpacked(source, text, at, number_size, encoding, allowance);
    const std::size_t size = encoding.header_size;
    const std::uint64_t n =
        natural(source.take(size).data(), size, encoding.is_big_endian);
    use(allowance, n, number_size);
    if (source.is_aligned())
      return source.take(n);
    // header and values were encoded together
    source.rewind(at);
    return source.take(size + n).substr(size);
  }

  std::vector<double> numbers_of(const std::string &bytes,
                                 const std::string &type,
                                 const bool is_big_endian)
  {
    const auto found = types().find(type);
    if (found == types().end())
      throw BadBytes(fmt::format("the type `{}` is not read", type));
    const auto &[size, read] = found->second;
    std::vector<double> result;
    result.reserve(bytes.size() / size);
    for (std::size_t i = 0; i + size <= bytes.size(); i += size)
      result.push_back(read(bytes.data() + i, is_big_endian));
    return result;
  }

  std::optional<double> next_number(const std::string &text, std::size_t &at,
                                    std::string &word)
  {
    const auto is_space = [](const char c) {
      return std::isspace(static_cast<unsigned char>(c));
    };
    while (at < text.size() && is_space(text[at]))
      ++at;
    const std::size_t begin = at;
    while (at < text.size() && !is_space(text[at]))
      ++at;
    word = text.substr(begin, std::min<std::size_t>(at - begin, 40));
    double value = 0.;
    const auto [stop, error] =
        std::from_chars(text.data() + begin, text.data() + at, value);
    if (error != std::errc() || stop != text.data() + at)
      return std::nullopt;
    return value;
  }

  std::vector<double> numbers_of_text(const std::string &text,
                                      const std::string &type)
  {
    if (types().count(type) == 0)
      throw BadBytes(fmt::format("the type `{}` is not read", type));
    std::vector<double> result;
    std::string word;
    for (std::size_t at = 0;;) {
      const auto value = next_number(text, at, word);
      if (word.empty())
        return result;
      if (!value)
        throw BadBytes(fmt::format("`{}` is not a number", word));
      result.push_back(*value);
    }
  }
} // namespace nsfd::vtk
