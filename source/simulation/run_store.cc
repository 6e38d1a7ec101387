#include "run_store.h"

#include "print_problems.h"

#include "core/cost.h"
#include "nsfd/core/archive.h"
#include "time_integration/serialize_state.h"

#include <fmt/format.h>

#include <iostream>

namespace nsfd
{
  template <int dim>
  RunStore<dim>::RunStore(RunParts<dim> &parts)
      : parts_(parts),
        checkpoints_(parts.input, parts.options, *parts.model.discretization,
                     parts.communicator)
  {
  }

  template <int dim>
  bool RunStore<dim>::resume(const FoundCheckpoint &found)
  {
    try {
      checkpoints_.read(found, [&](Archive &archive) { read(archive, found); });
    } catch (const BadCheckpoint &error) {
      if (parts_.communicator.is_root())
        std::cerr << parts_.input.file << ": error: " << found.file.string()
                  << ": " << error.what() << "\n";
      return false;
    }
    stored_ = true;
    stored_at_ = parts_.state.step;
    return true;
  }

  template <int dim>
  void RunStore<dim>::read(Archive &archive, const FoundCheckpoint &found)
  {
    serialize_state(archive);
    serialize_parts(archive, found.same_solver && has_solvers_,
                    found.same_integrators);
    if (!found.same_steps)
      parts_.steps.renew_steps(parts_.state);
    parts_.recorder.serialize_files(archive); // the first to touch a file
  }

  template <int dim>
  void RunStore<dim>::serialize_state(Archive &archive)
  {
    serialize(parts_.state, archive);
    bool is_static = parts_.steps.is_static();
    archive.numbers("is_static", is_static, has_solvers_);
    if (archive.reads())
      parts_.steps.resume(parts_.state, is_static);
  }

  /** Everything else that later steps or the end of the run depend on. */
  template <int dim>
  void RunStore<dim>::serialize_parts(Archive &archive, const bool with_solvers,
                                      const bool all_integrators)
  {
    parts_.steps.serialize(archive, all_integrators);
    parts_.events.serialize(archive);
    if (with_solvers && all_integrators)
      parts_.steps.serialize_solvers(archive);
    if (parts_.adaptive)
      parts_.adaptive->serialize(archive);
    parts_.recorder.serialize(archive, parts_.state, n_failed());
  }

  template <int dim>
  bool RunStore<dim>::store(const bool with_solvers)
  {
    const Charge charge(Cost::output);
    stored_at_ = parts_.state.step;
    has_solvers_ = with_solvers;
    parts_.steps.integrator().show(parts_.state);
    const std::string failure = checkpoints_.write([&](Archive &archive) {
      serialize_state(archive);
      serialize_parts(archive, with_solvers, true);
      parts_.recorder.serialize_files(archive);
    });
    stored_ = !parts_.communicator.any(!failure.empty());
    if (!failure.empty())
      print_problems(parts_.communicator, parts_.input, "warning",
                     {fmt::format("no checkpoint after step {}: {}; {}",
                                  parts_.state.step, failure,
                                  checkpoints_.has_earlier()
                                      ? "the one before is kept"
                                      : "there is none before it")});
    return stored_;
  }

  template <int dim>
  void RunStore<dim>::store_if_due()
  {
    if (checkpoints_.is_due(parts_.state.step))
      store();
  }

  template <int dim>
  void RunStore<dim>::store_last()
  {
    if (checkpoints_.wanted() && stored_at_ != parts_.state.step)
      store();
  }

  template <int dim>
  bool RunStore<dim>::keep(const bool with_solvers)
  {
    return (stored_ && stored_at_ == parts_.state.step) || store(with_solvers);
  }

  template class RunStore<2>;
  template class RunStore<3>;
} // namespace nsfd
