#pragma once

#include <iostream>
#include <sstream>

namespace nsfd
{
  /** While one lives, nothing is said on standard error. */
  class Silence
  {
  public:
    Silence() : before_(std::cerr.rdbuf(unheard_.rdbuf())) {}
    ~Silence() { std::cerr.rdbuf(before_); }
    Silence(const Silence &) = delete;
    Silence &operator=(const Silence &) = delete;

  private:
    std::ostringstream unheard_;
    std::streambuf *before_;
  };
} // namespace nsfd
