#include "checkpoint_file.h"
#include "checkpoints.h"

#include "core/load_plug_in.h"
#include "nsfd/core/plug_in.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <iostream>
#include <sstream>
#include <system_error>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    /** Into @p found; what is wrong with files that are not whole is noted. */
    void find_whole(const fs::path &folder, FoundCheckpoint &found)
    {
      for (const fs::path &file : checkpoint_file::candidates(folder)) {
        std::error_code error;
        if (!fs::exists(file, error))
          continue;
        std::string problem;
        try {
          auto bytes = checkpoint_file::read(file);
          problem = checkpoint_file::problem_of(bytes);
          if (problem.empty()) {
            found.image = std::make_unique<Hdf5Image>(bytes);
            found.file = file;
            return;
          }
        } catch (const std::exception &failure) {
          problem = failure.what();
        }
        found.notes += fmt::format("  {}: {}\n", file.string(), problem);
      }
    }

    /** False, and noted, if a law may have another formula now. */
    bool compare_plug_ins(FoundCheckpoint &found)
    {
      std::string then;
      if (!found.image->read("plug_ins", then))
        return true; // of a program that had none
      std::string refused;
      std::istringstream lines(then);
      for (std::string name, checksum; lines >> name >> checksum;) {
        const PlugIn *now = nullptr;
        for (const PlugIn &one : loaded_plug_ins())
          if (one.name == name)
            now = &one;
        if (!now)
          refused += fmt::format(
              "  `{0}` is not loaded: --plug-in PATH/{0}.so\n", name);
        else if (now->checksum != checksum)
          refused += fmt::format("  {} is another file now: checksum {}, was "
                                 "{}\n",
                                 now->file, now->checksum, checksum);
      }
      if (!refused.empty())
        found.notes +=
            "these plug-ins give what was computed another meaning:\n" +
            refused +
            "  load those that the run began with, or start a new run: "
            "--output DIR\n";
      return refused.empty();
    }

    /** Older checkpoints do not say. */
    void compare_integrators(const SceneInput &input, FoundCheckpoint &found)
    {
      std::vector<std::uint8_t> then;
      unsigned int components = 1;
      if (found.image->read("steps_in_time", then, components) &&
          then.size() == 1)
        found.same_integrators = (then[0] != 0) == input.may_move();
    }

    /** False if one is not allowed. Both kinds are noted. */
    bool compare_parameters(const SceneInput &input, FoundCheckpoint &found)
    {
      std::string then;
      if (!found.image->read("parameters", then)) {
        found.notes +=
            fmt::format("  {}: it has no parameters\n", found.file.string());
        return false;
      }
      std::string program;
      if (found.image->read("program", program) &&
          program != checkpoint_file::program())
        found.notes +=
            fmt::format("nsfd {} has written the checkpoint, this is "
                        "{}: the last bits may differ\n",
                        program, checkpoint_file::program());
      std::string refused, accepted;
      for (const auto &change : parameter_changes(then, input.echo)) {
        if (change.name == "Output/directory")
          continue;
        const bool allowed = change.allowed() && (!input.time.scheme.at_nodes ||
                                                  change.name != "Time/step");
        (allowed ? accepted : refused) += "  " + change.text() + "\n";
        found.same_solver = found.same_solver && !change.is_in("Solver");
        found.same_steps = found.same_steps && !change.is_in("Time");
      }
      if (!refused.empty())
        found.notes +=
            "these parameters give what was computed another meaning:\n" +
            refused +
            "  write them as they were, or start a new run: --output DIR\n";
      else if (!accepted.empty())
        found.notes += "changed since the checkpoint:\n" + accepted;
      return refused.empty();
    }
  } // namespace

  std::optional<FoundCheckpoint>
  find_checkpoint(const SceneInput &input, const Communicator &communicator)
  {
    FoundCheckpoint found;
    bool good = true;
    if (communicator.is_root()) {
      const std::string &folder = input.output.directory;
      find_whole(folder, found);
      if (!found.image)
        found.notes =
            fmt::format("there is no whole checkpoint in `{}`: nothing was "
                        "run.\n",
                        folder) +
            found.notes +
            "  checkpoints come with `set checkpoint every steps = 100` in "
            "section Output, and when a run is stopped\n";
      good = found.image && compare_plug_ins(found) &&
             compare_parameters(input, found);
      if (good)
        compare_integrators(input, found);
      if (!found.notes.empty())
        std::cerr << input.file << ": " << (good ? "note: " : "error: ")
                  << found.notes;
    }
    if (communicator.any(!good))
      return {};
    int flags[3] = {found.same_solver, found.same_steps,
                    found.same_integrators};
    MPI_Bcast(flags, 3, MPI_INT, 0, communicator.mpi());
    found.same_solver = flags[0] != 0;
    found.same_steps = flags[1] != 0;
    found.same_integrators = flags[2] != 0;
    return found;
  }
} // namespace nsfd
