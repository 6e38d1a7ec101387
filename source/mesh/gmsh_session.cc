#include "gmsh_session.h"

namespace nsfd
{
  GmshSession::GmshSession()
  {
    // no configuration of the user: a scene is the same everywhere
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    gmsh::logger::start();
  }

  GmshSession::~GmshSession()
  {
    try {
      gmsh::logger::stop();
      gmsh::finalize();
    } catch (...) {
      // nothing is left to be done
    }
  }

  bool GmshSession::failed()
  {
    std::vector<std::string> log;
    gmsh::logger::get(log);
    error_ = thrown_;
    const std::string mark = "Error: ";
    for (const std::string &line : log)
      if (error_.empty() && line.compare(0, mark.size(), mark) == 0)
        error_ = line.substr(mark.size());
    // a new log for the next run
    gmsh::logger::stop();
    gmsh::logger::start();
    return !error_.empty();
  }
} // namespace nsfd
