#pragma once

#include "core/communicator.h"
#include "discretization/discretization.h"
#include "mesh/mesh_builder.h"
#include "nsfd/records/observable_record.h"
#include "nsfd/records/run_record.h"
#include "state/state.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  class Archive;
  template <int dim>
  class RunViewOf;
  class TableFile;

  /**
   * The observables of a scene: shows them the states, writes their files and
   * keeps their records.
   */
  template <int dim>
  class Observers
  {
  public:
    Observers(const SceneInput &input,
              const Discretization<dim> &discretization,
              const Communicator &communicator);
    ~Observers();

    /**
     * Finds what the observables look at, on the first mesh and on every
     * other one. @throws std::runtime_error with a sentence for the user.
     * Collective.
     */
    void find(const dealii::Triangulation<dim> &triangulation,
              const MeshGroups<dim> &groups);

    /** Starts the files. */
    void start_files();

    /**
     * After a step from @p previous, or at the start with null. Collective.
     */
    void observe(const State &state, const State *previous,
                 const HistoryRow &row);

    /** Where fields are written: profiles. Collective. */
    void write_profiles(const State &state, double time_step);

    const std::vector<ObservableRecord> &records() const { return records_; }

    /** How far the files have come; cuts them after reading. Collective. */
    void serialize(Archive &archive);

  private:
    struct Files {
      std::unique_ptr<TableFile> rows, profile; ///< of rank 0, or null
    };
    std::string path(std::size_t k, const char *ending) const;
    std::vector<std::string> titles(std::size_t k, bool of_profile) const;
    void serialize_file(Archive &archive, std::size_t k, bool of_profile,
                        std::string &failure);

    const SceneInput &input_;
    const Communicator &communicator_;
    std::unique_ptr<RunViewOf<dim>> view_;
    std::vector<ObservableRecord> records_;
    std::vector<Files> files_;
  };
} // namespace nsfd
