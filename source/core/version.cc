#include "version.h"

#include "nsfd/core/interface.h"
#include "nsfd/core/plug_in.h"

#include <deal.II/base/config.h>

#include <mpi.h>

namespace nsfd
{
  Version version()
  {
    return {NSFD_VERSION, NSFD_GIT_HASH, NSFD_BUILD_TYPE, NSFD_BUILT_FOR};
  }

  std::vector<std::pair<std::string, std::string>> library_versions()
  {
    char mpi[MPI_MAX_LIBRARY_VERSION_STRING];
    int length = 0;
    MPI_Get_library_version(mpi, &length);
    const std::string text(mpi, std::size_t(length));
    return {{"deal.II", DEAL_II_PACKAGE_VERSION},
            {"MPI", text.substr(0, text.find(','))}};
  }
} // namespace nsfd
