#pragma once

#include "bodies/fragments.h"
#include "nsfd/records/run_record.h"
#include "nsfd/scene/field_format.h"
#include "vtu.h"

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  class Archive;
  class GatheredSeries;

  /**
   * fields.pvd (volume: displacement, velocity, stress, fragment, material) and
   * interfaces.pvd (faces: beta, jump, traction, slip, contact status), one
   * pair of files per output time, or fields.xdmf and interfaces.xdmf with one
   * HDF5 file each, or fields.vtkhdf and interfaces.vtkhdf; pictures for the
   * report on rank 0.
   */
  template <int dim>
  class FieldOutput
  {
  public:
    FieldOutput(const std::string &directory,
                const Discretization<dim> &discretization,
                const Communicator &communicator,
                FieldFormat format = FieldFormat::vtu);
    ~FieldOutput();

    /** Write both series at the time of @p state. Collective. */
    void write(const State &state, double time_step,
               const Fragments<dim> &fragments);

    /** Bodies and points are others now. */
    void mesh_changed();

    /** The series so far. Later files of an earlier run are removed. */
    void serialize(Archive &archive);

    /** A picture's worth of data; empty except on rank 0. Collective. */
    Snapshot snapshot(const State &state,
                      const Fragments<dim> &fragments) const;

  private:
    void together(const std::function<void()> &action) const;
    void add_together(GatheredSeries &series, const VtuGrid &piece) const;
    void write_series(PvdSeries &series, const std::string &base,
                      const VtuGrid &grid);

    std::string directory_;
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    PvdSeries fields_, interfaces_;
    /// instead of them, or null
    std::unique_ptr<GatheredSeries> gathered_fields_, gathered_interfaces_;
    unsigned int number_ = 0;
    /// per face and side: number of the face on the local cell
    std::vector<std::array<unsigned int, 2>> face_numbers_;
  };
} // namespace nsfd
