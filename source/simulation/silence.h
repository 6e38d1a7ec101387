#pragma once

#include <iostream>
#include <sstream>
#include <string>

namespace nsfd
{
  /** While one lives, nothing is said on standard error; it can be later. */
  class Silence
  {
  public:
    Silence() : before_(std::cerr.rdbuf(unheard_.rdbuf())) {}
    ~Silence() { std::cerr.rdbuf(before_); }
    Silence(const Silence &) = delete;
    Silence &operator=(const Silence &) = delete;

    std::string unheard() const { return unheard_.str(); }

  private:
    std::ostringstream unheard_;
    std::streambuf *before_;
  };
} // namespace nsfd
