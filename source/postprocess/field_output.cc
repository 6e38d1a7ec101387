#include "field_output.h"

#include "field_grids.h"
#include "snapshot.h"
#include "vtkhdf_series.h"
#include "xdmf_series.h"

#include "core/output_folder.h"
#include "nsfd/core/archive.h"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /** Null of VTU. */
    std::unique_ptr<GatheredSeries> gathered_series(const FieldFormat format,
                                                    const std::string &folder,
                                                    const std::string &name)
    {
      const std::string path = (std::filesystem::path(folder) / name).string();
      if (format == FieldFormat::hdf5)
        return std::make_unique<XdmfSeries>(path);
      if (format == FieldFormat::vtkhdf)
        return std::make_unique<VtkhdfSeries>(path);
      return nullptr;
    }
  } // namespace

  template <int dim>
  FieldOutput<dim>::FieldOutput(const std::string &directory,
                                const Discretization<dim> &discretization,
                                const Communicator &communicator,
                                const FieldFormat format)
      : directory_(directory), discretization_(discretization),
        communicator_(communicator),
        fields_((std::filesystem::path(directory) / "fields.pvd").string()),
        interfaces_(
            (std::filesystem::path(directory) / "interfaces.pvd").string()),
        face_numbers_(face_numbers(discretization))
  {
    gathered_fields_ = gathered_series(format, directory, "fields");
    gathered_interfaces_ = gathered_series(format, directory, "interfaces");
  }

  template <int dim>
  FieldOutput<dim>::~FieldOutput() = default;

  template <int dim>
  void FieldOutput<dim>::mesh_changed()
  {
    face_numbers_ = face_numbers(discretization_);
  }

  template <int dim>
  void FieldOutput<dim>::write(const State &state, const double time_step,
                               const Fragments<dim> &fragments)
  {
    // one after the other: there is never more than one of them in memory
    const auto add = [this](PvdSeries &series, const auto &gathered,
                            const std::string &base, const VtuGrid &grid) {
      if (gathered)
        add_together(*gathered, grid);
      else
        write_series(series, base, grid);
    };
    add(fields_, gathered_fields_, "fields",
        volume_grid(discretization_, state, fragments));
    add(interfaces_, gathered_interfaces_, "interfaces",
        interface_grid(discretization_, face_numbers_, state, time_step));
    ++number_;
  }

  namespace
  {
    /** fields_00012.vtu and so on, from @p number on. */
    void remove_from(const unsigned int number, const std::string &directory)
    {
      namespace fs = std::filesystem;
      std::error_code error;
      std::vector<fs::path> late;
      for (const auto &entry : fs::directory_iterator(directory, error)) {
        const std::string name = entry.path().filename().string();
        for (const std::string base : {"fields_", "interfaces_"})
          if (name.compare(0, base.size(), base) == 0 &&
              std::strtoul(name.c_str() + base.size(), nullptr, 10) >= number)
            late.push_back(entry.path());
      }
      for (const fs::path &file : late)
        fs::remove(file, error);
    }
  } // namespace

  template <int dim>
  void FieldOutput<dim>::serialize(Archive &archive)
  {
    archive.numbers("fields_written", number_);
    if (archive.reads() && communicator_.is_root())
      remove_from(number_, directory_);
    for (auto *series : {&gathered_fields_, &gathered_interfaces_})
      if (*series) {
        const Archive::Part part(
            archive, series == &gathered_fields_ ? "fields" : "interfaces");
        (*series)->serialize(archive);
      }
    if (gathered_fields_)
      return;
    for (auto *series : {&fields_, &interfaces_}) {
      const Archive::Part part(archive,
                               series == &fields_ ? "fields" : "interfaces");
      series->serialize(archive);
    }
  }

  template <int dim>
  Snapshot FieldOutput<dim>::snapshot(const State &state,
                                      const Fragments<dim> &fragments) const
  {
    return take_snapshot(discretization_, communicator_, face_numbers_, state,
                         fragments);
  }

  /** What fails on one rank fails on all of them. */
  template <int dim>
  void FieldOutput<dim>::together(const std::function<void()> &action) const
  {
    std::string error;
    try {
      action();
    } catch (const std::exception &exception) {
      error = exception.what();
    }
    if (!communicator_.any(!error.empty()))
      return;
    // the words of the first of them, on all
    const int none = communicator_.size(),
              who = int(communicator_.min(
                  error.empty() ? none : communicator_.rank()));
    int length = int(error.size());
    MPI_Bcast(&length, 1, MPI_INT, who, communicator_.mpi());
    error.resize(std::size_t(length));
    MPI_Bcast(error.data(), length, MPI_CHAR, who, communicator_.mpi());
    throw OutputError(error, true);
  }

  template <int dim>
  void FieldOutput<dim>::add_together(GatheredSeries &series,
                                      const VtuGrid &piece) const
  {
    const VtuGrid whole = gather_grid(communicator_, piece);
    together([&]() {
      if (communicator_.is_root())
        series.add(whole);
    });
  }

  template <int dim>
  void FieldOutput<dim>::write_series(PvdSeries &series,
                                      const std::string &base,
                                      const VtuGrid &grid)
  {
    const std::filesystem::path directory(directory_);
    const auto name = [&](const int rank) {
      return vtu_name(base, number_, unsigned(rank),
                      unsigned(communicator_.size()));
    };
    together([&]() {
      if (communicator_.is_root())
        for (int rank = 1; rank < communicator_.size(); ++rank)
          OutputFolder::instance().note((directory / name(rank)).string());
      write_vtu((directory / name(communicator_.rank())).string(), grid);
    });
    together([&]() {
      if (!communicator_.is_root())
        return;
      std::string entry = name(0);
      if (communicator_.size() > 1) {
        std::vector<std::string> pieces;
        for (int rank = 0; rank < communicator_.size(); ++rank)
          pieces.push_back(name(rank));
        entry = std::filesystem::path(vtu_name(base, number_, 0, 1))
                    .replace_extension(".pvtu")
                    .string();
        write_pvtu((directory / entry).string(), grid, pieces);
      }
      series.add(grid.time, entry);
    });
  }

  template class FieldOutput<2>;
  template class FieldOutput<3>;
} // namespace nsfd
