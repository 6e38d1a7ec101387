#pragma once

#include "hdf5_image.h"
#include "rank_order.h"

#include "discretization/discretization.h"
#include "nsfd/core/archive.h"

#include <memory>

namespace nsfd
{
  /**
   * Cells by CellId, face points by the key of their face: the orders of what
   * is stored, and what tells one mesh from another.
   */
  template <int dim>
  class CheckpointOrders
  {
  public:
    /** Collective. */
    CheckpointOrders(const Discretization<dim> &discretization,
                     const Communicator &communicator);

    const Communicator &communicator() const { return communicator_; }
    const RankOrder &unknowns() const { return *unknowns_; }
    const RankOrder &points() const { return *points_; }
    /** Of the numbers that materials keep. */
    const RankOrder &histories() const { return *histories_; }

    /** Of the cells themselves. */
    const RankOrder &single_cells() const { return *single_cells_; }

    /** CellId::to_binary() of all active cells, four numbers each; root. */
    std::vector<std::uint32_t> cells() const;
    /** Keys of all faces and the number of their points; root. */
    std::vector<std::uint64_t> faces() const;

    /**
     * Sums of hashes over cells and points: their keys, places to 2^-26 of
     * the body, materials and blocks.
     */
    const std::vector<std::uint64_t> &fingerprint() const
    {
      return fingerprint_;
    }

  private:
    std::unique_ptr<RankOrder>
    order_of_cells(const std::vector<std::size_t> &first) const;
    void set_fingerprint();

    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    std::unique_ptr<RankOrder> unknowns_, points_, histories_, single_cells_;
    std::vector<std::uint64_t> fingerprint_;
  };

  /** Gathers on the first rank, which holds the whole file. */
  template <int dim>
  class CheckpointWriter final : public Archive
  {
  public:
    CheckpointWriter(const CheckpointOrders<dim> &orders,
                     Hdf5Image *image); ///< null on other ranks

    void bodies(const std::string &name, std::vector<double> &values) override;
    void points(const std::string &name, std::vector<double> &values) override;
    void points(const std::string &name,
                std::vector<std::uint8_t> &values) override;
    void histories(const std::string &name,
                   std::vector<double> &values) override;
    void cells(const std::string &name, std::vector<double> &values) override;
    void common(const std::string &name, std::vector<double> &values) override;
    void on_root(const std::string &name, std::vector<double> &values) override;
    void on_root(const std::string &name, std::string &text) override;

  private:
    template <typename T>
    void write(const RankOrder &order, const std::string &name,
               const std::vector<T> &values);

    const CheckpointOrders<dim> &orders_;
    Hdf5Image *image_;
  };

  template <int dim>
  class CheckpointReader final : public Archive
  {
  public:
    CheckpointReader(const CheckpointOrders<dim> &orders,
                     const Hdf5Image *image); ///< null on other ranks

    void bodies(const std::string &name, std::vector<double> &values) override;
    void points(const std::string &name, std::vector<double> &values) override;
    void points(const std::string &name,
                std::vector<std::uint8_t> &values) override;
    void histories(const std::string &name,
                   std::vector<double> &values) override;
    void cells(const std::string &name, std::vector<double> &values) override;
    void common(const std::string &name, std::vector<double> &values) override;
    void on_root(const std::string &name, std::vector<double> &values) override;
    void on_root(const std::string &name, std::string &text) override;

  private:
    template <typename T>
    void read(const RankOrder &order, const std::string &name,
              std::vector<T> &values);
    void demand(bool good, const std::string &name) const;

    const CheckpointOrders<dim> &orders_;
    const Communicator &communicator_;
    const Hdf5Image *image_;
  };
} // namespace nsfd
