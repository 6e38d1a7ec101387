#pragma once

#include "fragment_motion.h"
#include "row_file.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  class Archive;
  class GatheredSeries;
  struct SceneInput;

  /**
   * A scene has pieces, or may get some: there is more than one fragment, or a
   * face with a cohesive law. Collective.
   */
  template <int dim>
  bool has_fragments(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     const Fragments<dim> &fragments,
                     const Communicator &communicator);

  /**
   * fragments.csv: at each output time one row per fragment, its whole motion.
   * The same for any number of ranks; of scenes with has_fragments() only.
   */
  template <int dim>
  class FragmentOutput
  {
  public:
    /**
     * If the run @p resumes, the file is left to serialize(). With @p vtkhdf
     * there is also fragments.vtkhdf, a point for each fragment.
     */
    FragmentOutput(const std::string &directory, FragmentMotion<dim> motion,
                   const Communicator &communicator, bool resumes,
                   bool vtkhdf = false);
    ~FragmentOutput();

    /** The rows of this time. Collective. */
    void write(const State &state, const Fragments<dim> &fragments);

    /** The records of this time, without rows. Collective. */
    void measure(const State &state, const Fragments<dim> &fragments);

    /** Bodies and points are others now; @p start is their state at t = 0. */
    void mesh_changed(const State &start);

    /** After reading, the file ends where it did at the checkpoint. */
    void serialize(Archive &archive);

    /** The last ones; on the first rank. */
    const std::vector<FragmentRecord> &records() const { return records_; }

    static std::string header();
    static std::string line(unsigned int step, double time,
                            const FragmentRecord &record);

  private:
    const std::string path_;
    FragmentMotion<dim> motion_;
    const Communicator &communicator_;
    std::unique_ptr<RowFile> file_;          ///< on the first rank
    std::unique_ptr<GatheredSeries> series_; ///< or null
    std::vector<FragmentRecord> records_;
    std::optional<unsigned int> measured_at_; ///< step
  };
} // namespace nsfd
