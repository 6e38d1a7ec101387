#pragma once

#include <gmsh.h>

#include <string>
#include <vector>

namespace nsfd
{
  /**
   * The Gmsh library, silent and single-threaded, from here to the end of the
   * scope. Its messages are kept. After a script (.geo) that failed, Gmsh 4.8
   * reads what was left of it before the next script of the same process.
   */
  class GmshSession
  {
  public:
    GmshSession();
    ~GmshSession();
    GmshSession(const GmshSession &) = delete;
    GmshSession &operator=(const GmshSession &) = delete;

    /**
     * Run @p action; false if Gmsh threw or logged an error, with what it said
     * in error().
     */
    template <typename Action>
    bool run(const Action &action)
    {
      thrown_.clear();
      try {
        action();
      } catch (const std::string &message) {
        thrown_ = message;
      } catch (const char *message) {
        thrown_ = message;
      } catch (const std::exception &exception) {
        thrown_ = exception.what();
      } catch (int) {
        thrown_ = "unknown error";
      }
      return !failed();
    }

    /** First complaint of the last run. */
    std::string error() const { return error_; }

  private:
    bool failed();
    std::string thrown_, error_;
  };
} // namespace nsfd
