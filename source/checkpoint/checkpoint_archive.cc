#include "checkpoint_archive.h"

#include <mpi.h>

namespace nsfd
{
  template <int dim>
  CheckpointWriter<dim>::CheckpointWriter(const CheckpointOrders<dim> &orders,
                                          Hdf5Image *image)
      : Archive(false), orders_(orders), image_(image)
  {
  }

  template <int dim>
  template <typename T>
  void CheckpointWriter<dim>::write(const RankOrder &order,
                                    const std::string &name,
                                    const std::vector<T> &values)
  {
    const std::size_t n = order.n_items();
    const unsigned int components = unsigned(
        orders_.communicator().max(n > 0 ? double(values.size() / n) : 0.));
    if (orders_.communicator().any(values.size() != n * components))
      throw std::logic_error(path(name) + ": values are missing");
    std::vector<T> all;
    if (components > 0)
      all = order.gather(values, components);
    if (image_)
      image_->write(path(name), all, components);
  }

  template <int dim>
  void CheckpointWriter<dim>::bodies(const std::string &name,
                                     std::vector<double> &values)
  {
    write(orders_.unknowns(), name, values);
  }

  template <int dim>
  void CheckpointWriter<dim>::points(const std::string &name,
                                     std::vector<double> &values)
  {
    write(orders_.points(), name, values);
  }

  template <int dim>
  void CheckpointWriter<dim>::points(const std::string &name,
                                     std::vector<std::uint8_t> &values)
  {
    write(orders_.points(), name, values);
  }

  template <int dim>
  void CheckpointWriter<dim>::histories(const std::string &name,
                                        std::vector<double> &values)
  {
    write(orders_.histories(), name, values);
  }

  template <int dim>
  void CheckpointWriter<dim>::cells(const std::string &name,
                                    std::vector<double> &values)
  {
    write(orders_.single_cells(), name, values);
  }

  template <int dim>
  void CheckpointWriter<dim>::common(const std::string &name,
                                     std::vector<double> &values)
  {
    on_root(name, values);
  }

  template <int dim>
  void CheckpointWriter<dim>::on_root(const std::string &name,
                                      std::vector<double> &values)
  {
    if (image_)
      image_->write(path(name), values);
  }

  template <int dim>
  void CheckpointWriter<dim>::on_root(const std::string &name,
                                      std::string &text)
  {
    if (image_)
      image_->write(path(name), text);
  }

  template <int dim>
  CheckpointReader<dim>::CheckpointReader(const CheckpointOrders<dim> &orders,
                                          const Hdf5Image *image)
      : Archive(true), orders_(orders), communicator_(orders.communicator()),
        image_(image)
  {
  }

  template <int dim>
  void CheckpointReader<dim>::demand(const bool good,
                                     const std::string &name) const
  {
    if (communicator_.any(!good))
      throw BadCheckpoint("`" + path(name) +
                          "` is missing in the checkpoint, or of another size");
  }

  template <int dim>
  template <typename T>
  void CheckpointReader<dim>::read(const RankOrder &order,
                                   const std::string &name,
                                   std::vector<T> &values)
  {
    std::vector<T> all;
    unsigned int components = 0;
    bool good = true;
    if (image_) {
      good = image_->read(path(name), all, components) &&
             (all.empty() || all.size() == order.n_global() * components);
      if (all.empty())
        components = 0;
    }
    demand(good, name);
    MPI_Bcast(&components, 1, MPI_UNSIGNED, 0, communicator_.mpi());
    if (components == 0)
      values.clear();
    else
      values = order.scatter(all, components);
  }

  template <int dim>
  void CheckpointReader<dim>::bodies(const std::string &name,
                                     std::vector<double> &values)
  {
    read(orders_.unknowns(), name, values);
  }

  template <int dim>
  void CheckpointReader<dim>::points(const std::string &name,
                                     std::vector<double> &values)
  {
    read(orders_.points(), name, values);
  }

  template <int dim>
  void CheckpointReader<dim>::points(const std::string &name,
                                     std::vector<std::uint8_t> &values)
  {
    read(orders_.points(), name, values);
  }

  template <int dim>
  void CheckpointReader<dim>::histories(const std::string &name,
                                        std::vector<double> &values)
  {
    read(orders_.histories(), name, values);
  }

  template <int dim>
  void CheckpointReader<dim>::cells(const std::string &name,
                                    std::vector<double> &values)
  {
    read(orders_.single_cells(), name, values);
  }

  template <int dim>
  void CheckpointReader<dim>::common(const std::string &name,
                                     std::vector<double> &values)
  {
    on_root(name, values);
    auto n = static_cast<unsigned long long>(values.size());
    MPI_Bcast(&n, 1, MPI_UNSIGNED_LONG_LONG, 0, communicator_.mpi());
    values.resize(n);
    MPI_Bcast(values.data(), int(n), MPI_DOUBLE, 0, communicator_.mpi());
  }

  template <int dim>
  void CheckpointReader<dim>::on_root(const std::string &name,
                                      std::vector<double> &values)
  {
    unsigned int components = 0;
    demand(!image_ || image_->read(path(name), values, components), name);
  }

  template <int dim>
  void CheckpointReader<dim>::on_root(const std::string &name,
                                      std::string &text)
  {
    demand(!image_ || image_->read(path(name), text), name);
  }

  template class CheckpointWriter<2>;
  template class CheckpointWriter<3>;
  template class CheckpointReader<2>;
  template class CheckpointReader<3>;
} // namespace nsfd
