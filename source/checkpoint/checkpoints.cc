#include "checkpoints.h"

#include "checkpoint_file.h"

#include "core/load_plug_in.h"
#include "core/stopwatch.h"
#include "nsfd/scene/scene_input.h"
#include "records/run_options.h"

#include <fstream>
#include <sstream>

namespace nsfd
{
  std::vector<std::uint32_t> stored_cells(const FoundCheckpoint &found,
                                          const Communicator &communicator)
  {
    std::vector<std::uint32_t> cells;
    unsigned int components = 4;
    if (found.image) {
      std::vector<double> bisected;
      if (found.image->read("bisected_mesh/cells", bisected, components))
        cells.assign(bisected.begin(), bisected.end());
      else
        found.image->read("mesh/cells", cells, components);
    }
    unsigned long long n = cells.size();
    MPI_Bcast(&n, 1, MPI_UNSIGNED_LONG_LONG, 0, communicator.mpi());
    cells.resize(n);
    MPI_Bcast(cells.data(), int(n), MPI_UINT32_T, 0, communicator.mpi());
    return cells;
  }

  template <int dim>
  Checkpoints<dim>::Checkpoints(const SceneInput &input,
                                const RunOptions &options,
                                const Discretization<dim> &discretization,
                                const Communicator &communicator)
      : input_(input), options_(options), discretization_(discretization),
        communicator_(communicator), last_(wall_seconds())
  {
  }

  template <int dim>
  const CheckpointOrders<dim> &Checkpoints<dim>::orders() const
  {
    if (!orders_)
      orders_ = std::make_unique<CheckpointOrders<dim>>(discretization_,
                                                        communicator_);
    return *orders_;
  }

  template <int dim>
  bool Checkpoints<dim>::wanted() const
  {
    return input_.output.checkpoint_steps > 0 ||
           input_.output.checkpoint_seconds > 0.;
  }

  template <int dim>
  bool Checkpoints<dim>::is_due(const unsigned int step) const
  {
    const auto &output = input_.output;
    if (output.checkpoint_steps > 0 && step % output.checkpoint_steps == 0)
      return true;
    return output.checkpoint_seconds > 0. &&
           communicator_.any(wall_seconds() - last_ >=
                             output.checkpoint_seconds);
  }

  /** What a reader needs before anything else. */
  template <int dim>
  void Checkpoints<dim>::write_head(Hdf5Image *image) const
  {
    const auto cells = orders().cells();
    const auto faces = orders().faces();
    const auto fingerprint = orders().fingerprint();
    if (!image)
      return;
    std::ostringstream file;
    file << std::ifstream(input_.file, std::ios::binary).rdbuf();
    image->write("program", checkpoint_file::program());
    if (const std::string used = used_plug_ins(); !used.empty())
      image->write("plug_ins", used);
    image->write("command_line", options_.command_line);
    image->write("parameters", input_.echo);
    image->write("parameter_file", file.str());
    image->write("steps_in_time",
                 std::vector<std::uint8_t>{std::uint8_t(input_.may_move())});
    image->write("mesh/cells", cells, 4);
    image->write("mesh/faces", faces, 2);
    image->write("mesh/fingerprint", fingerprint);
  }

  template <int dim>
  std::string Checkpoints<dim>::write(const SerializeAll &serialize)
  {
    std::unique_ptr<Hdf5Image> image;
    if (communicator_.is_root())
      image = std::make_unique<Hdf5Image>(checkpoint_file::head_size);
    write_head(image.get());
    CheckpointWriter<dim> writer(orders(), image.get());
    serialize(writer);
    std::string failure;
    if (image)
      try {
        auto bytes = image->bytes();
        image.reset();
        checkpoint_file::seal(bytes);
        checkpoint_file::put(input_.output.directory, bytes);
      } catch (const std::exception &error) {
        failure = error.what();
      }
    last_ = wall_seconds();
    const bool failed = communicator_.any(!failure.empty());
    n_failed_ += failed;
    return failed && failure.empty() ? "see the first rank" : failure;
  }

  template <int dim>
  bool Checkpoints<dim>::has_earlier() const
  {
    for (const auto &file :
         checkpoint_file::candidates(input_.output.directory))
      if (std::filesystem::is_regular_file(file))
        return true;
    return false;
  }

  template <int dim>
  void Checkpoints<dim>::read(const FoundCheckpoint &found,
                              const SerializeAll &serialize) const
  {
    const auto &order = orders();
    std::vector<std::uint64_t> fingerprint;
    unsigned int components = 1;
    const Hdf5Image *image = found.image.get();
    const bool same =
        !image || (image->read("mesh/fingerprint", fingerprint, components) &&
                   fingerprint == order.fingerprint());
    if (communicator_.any(!same))
      throw BadCheckpoint("the mesh is not that of the checkpoint: its cells, "
                          "their places or their faces differ");
    CheckpointReader<dim> reader(order, image);
    serialize(reader);
  }

  template class Checkpoints<2>;
  template class Checkpoints<3>;
} // namespace nsfd
