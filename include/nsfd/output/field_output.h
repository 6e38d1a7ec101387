#pragma once

#include "nsfd/mesh/discretization.h"
#include "nsfd/output/run_record.h"
#include "nsfd/output/vtu.h"
#include "nsfd/time/state.h"

#include <array>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Fragments: connected components of bodies over faces that still carry
   * (some point with beta >= 1e-3, or a rigid or elastic joint). Numbered from
   * 0 by their first cell in the order of the cell centres (x, y, z), the same
   * on any number of ranks.
   */
  template <int dim>
  class Fragments
  {
  public:
    explicit Fragments(const Discretization<dim> &discretization,
                       const Communicator &communicator);

    /** Collective. Does nothing if no point has broken since the last call. */
    void update(const State &state);

    unsigned int count() const { return count_; }
    /** Fragment of each body of this rank. */
    const std::vector<unsigned int> &of_body() const { return of_body_; }

  private:
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    double broken_area_ = -1.;
    unsigned int count_ = 0;
    std::vector<unsigned int> of_body_;

    std::vector<unsigned int> faces_; ///< counted here, between two cells
    /// on rank 0, over the cells and faces of all ranks, rank by rank
    std::vector<int> n_cells_;                       ///< per rank
    std::vector<unsigned int> order_;                ///< cells by their centres
    std::vector<std::array<unsigned int, 2>> pairs_; ///< cells of each face
  };

  /**
   * fields.pvd (volume: displacement, velocity, stress, fragment, material) and
   * interfaces.pvd (faces: beta, jump, traction, slip, contact status), one
   * pair of files per output time; pictures for the report on rank 0.
   */
  template <int dim>
  class FieldOutput
  {
  public:
    FieldOutput(const std::string &directory,
                const Discretization<dim> &discretization,
                const Communicator &communicator);

    /** Write both series at the time of @p state. Collective. */
    void write(const State &state, double time_step,
               const Fragments<dim> &fragments);

    /** A picture's worth of data; empty except on rank 0. Collective. */
    Snapshot snapshot(const State &state,
                      const Fragments<dim> &fragments) const;

  private:
    VtuGrid volume(const State &state, const Fragments<dim> &fragments) const;
    VtuGrid faces(const State &state, double time_step) const;
    void write_series(PvdSeries &series, const std::string &base,
                      const VtuGrid &grid);

    std::string directory_;
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    PvdSeries fields_, interfaces_;
    unsigned int number_ = 0;
    /// per face and side: number of the face on the local cell
    std::vector<std::array<unsigned int, 2>> face_no_;
  };
} // namespace nsfd
