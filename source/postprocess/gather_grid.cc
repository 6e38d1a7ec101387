#include "core/gather.h"
#include "gathered_series.h"

namespace nsfd
{
  VtuGrid gather_grid(const Communicator &communicator, const VtuGrid &piece)
  {
    VtuGrid all;
    all.time = piece.time;
    all.names = piece.names;
    std::vector<int> n_points, n_entries, n_cells;
    all.points = gather(communicator, piece.points, n_points);
    all.cells = gather(communicator, piece.cells, n_cells);
    all.connectivity = gather(communicator, piece.connectivity, n_entries);
    all.offsets = gather(communicator, piece.offsets);
    // numbers of points and ends of cells go on from rank to rank
    std::size_t entry = 0, cell = 0;
    std::int64_t first_point = 0, first_entry = 0;
    for (std::size_t r = 0; communicator.is_root() && r < n_points.size();
         ++r) {
      for (int k = 0; k < n_entries[r]; ++k)
        all.connectivity[entry++] += first_point;
      for (int k = 0; k < n_cells[r]; ++k)
        all.offsets[cell++] += first_entry;
      first_point += n_points[r];
      first_entry += n_entries[r];
    }
    for (const auto &[own, data] :
         {std::pair{&piece.point_data, &all.point_data},
          std::pair{&piece.cell_data, &all.cell_data}})
      for (const VtuGrid::Array &array : *own)
        data->push_back({array.name, array.components,
                         gather(communicator, array.values), array.unit,
                         array.number});
    return all;
  }
} // namespace nsfd
